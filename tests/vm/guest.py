"""Runs a guest in qemu, by translation alone, and fetches what it leaves on its results disk.

Never KVM: where /dev/kvm exists but belongs to a virtual machine of its own, a guest may hang for ever.
"""

import pathlib
import resource
import shutil
import subprocess
import tarfile

# qemu-system-x86_64 of Debian's qemu-system-x86.
QEMU = "qemu-system-x86_64"
RESULTS_SIZE = 256 * 1024 * 1024
# Of the wall: the longest takes 150 s of a processor, which it may have to share.
LIMIT_S = 1200
# One instruction is 4 ns of the guest's time, and idle time is skipped: minutes at the bench take seconds, and
# nothing depends on how busy this machine is.
VIRTUAL_TIME = ["-icount", "shift=2,sleep=off", "-smp", "1"]


class GuestFailed(Exception):
    """The guest did not end with success; says where its messages are and shows the last ones."""


def drive(name, path, more=""):
    return ["-drive", f"file={path},if=none,id={name},format=raw{more}", "-device", f"nvme,serial={name},drive={name}"]


def run_guest(folder, kernel, memory_MB, disks, append, more=(), limit_s=LIMIT_S):
    """Boots, waits for the power-off, unpacks the results to FOLDER/results. Raises GuestFailed."""
    results = folder / "results.raw"
    results.unlink(missing_ok=True)
    with open(results, "wb") as disk:
        disk.truncate(RESULTS_SIZE)
    command = [QEMU, "-accel", "tcg", "-cpu", "max", *VIRTUAL_TIME, "-m", str(memory_MB), "-nodefaults", "-no-reboot",
               "-display", "none", "-serial", "stdio", *disks, *drive("results", results), *more,
               "-kernel", str(kernel.image), "-append", f"console=ttyS0 quiet panic=-1 {append}"]
    serial = folder / "serial.log"
    why = None
    with open(serial, "wb") as log:
        try:
            subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, timeout=limit_s,
                           check=True)
        except subprocess.TimeoutExpired:
            why = f"did not power off within {limit_s} s"
        except subprocess.CalledProcessError as error:
            why = f"qemu ended with {error.returncode}"
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{folder.name}: {used.ru_utime + used.ru_stime:.0f} s of processor time so far", flush=True)
    text = serial.read_text(errors="replace")
    unpacked = folder / "results"
    shutil.rmtree(unpacked, ignore_errors=True)
    unpacked.mkdir()
    try:
        with tarfile.open(results) as archive:
            archive.extractall(unpacked)
    except tarfile.TarError as error:
        why = why or f"left no results: {error}"
    results.unlink()
    if why is None and "GUEST-RC=0" not in text:
        why = "its script failed"
    if why:
        last = "\n".join(text.splitlines()[-25:])
        raise GuestFailed(f"the guest {why}; its messages: {serial}; the last ones:\n{last}")
    return unpacked


def run_small_guest(folder, kernel, image, limit_s=LIMIT_S):
    return run_guest(folder, kernel, 1024, [], "", ["-initrd", str(image)], limit_s)


def folder_for(build, name):
    folder = pathlib.Path(build) / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder

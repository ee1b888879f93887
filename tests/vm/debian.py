"""The full guest: Debian 12 with systemd and udev on a disk image that is made once and never written again.

Our programs come on a second disk, a tar archive; what the guest writes to its root is forgotten at its end.
"""

import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile

import guest
import image
import kernel

HERE = pathlib.Path(__file__).resolve().parent
SUITE = "bookworm"
PACKAGES = ("systemd-sysv", "udev", "dbus", "kmod", "procps", "libcomedi0")
IMAGE_SIZE = "900M"
DEBOOTSTRAP_TIMEOUT_S = 1200
# What the cloud kernel has as modules and the guest needs; NVMe and ext4 are built in.
MODULE_FOLDERS = ("kernel/drivers/comedi", "kernel/fs/autofs")


def packages_of(programs):
    """Debian packages of the libraries that the programs load."""
    paths = {str(library.resolve()) for program in programs for library in image.libraries_of(program)}
    # Packages say /lib where the file is in /usr/lib; of the two names only one is known, and the status tells so.
    paths |= {path.removeprefix("/usr") for path in paths}
    shown = subprocess.run(["dpkg-query", "--search", *sorted(paths)], capture_output=True, text=True, check=False)
    return set(re.findall(r"^([^:,\s]+)[^/]*: /", shown.stdout, re.MULTILINE))


def make_root(folder, found, packages):
    """A root file system of the packages with the kernel's modules and a service that runs the payload."""
    archive = folder / "root.tar"
    slim = [option for path in ("doc", "man", "locale")
            for option in ("--dpkgopt", f"path-exclude=/usr/share/{path}/*")]
    done = subprocess.run(["mmdebstrap", "-q", "--variant=minbase", f"--include={','.join(sorted(packages))}",
                           "--aptopt", 'Acquire::Languages "none"', *slim, SUITE, archive],
                          capture_output=True, text=True, timeout=DEBOOTSTRAP_TIMEOUT_S, check=False)
    if done.returncode != 0:
        raise kernel.Unavailable(f"mmdebstrap: {done.stderr.strip()[-500:]}")
    root = folder / "root"
    root.mkdir()
    subprocess.run(["tar", "-C", root, "-xpf", archive, "--exclude=./dev/*"], check=True)
    archive.unlink()
    modules = root / "lib" / "modules" / found.release
    for name in MODULE_FOLDERS:
        shutil.copytree(found.modules / name, modules / name)
    for name in ("modules.builtin", "modules.builtin.modinfo", "modules.order"):
        shutil.copy(found.modules / name, modules)
    subprocess.run(["depmod", "-b", root, found.release], check=True)
    (root / "etc" / "hostname").write_text("guest\n")
    (root / "etc" / "fstab").write_text("/dev/nvme0n1 / ext4 defaults 0 0\n")
    units = root / "etc" / "systemd" / "system"
    # The serial port belongs to the test.
    (units / "serial-getty@ttyS0.service").symlink_to("/dev/null")
    shutil.copy(HERE / "guest" / "payload.service", units)
    wants = units / "multi-user.target.wants"
    wants.mkdir(exist_ok=True)
    (wants / "payload.service").symlink_to("../payload.service")
    return root


def make_disk(found, disk, packages):
    """As root: owners and modes of files are what they are."""
    folder = disk.with_suffix(".unfinished")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        root = make_root(folder, found, packages)
        made = folder / "root.ext4"
        subprocess.run(["mke2fs", "-q", "-t", "ext4", "-d", root, "-O", "^has_journal", made, IMAGE_SIZE], check=True,
                       stdout=subprocess.DEVNULL)
        made.rename(disk)
    finally:
        shutil.rmtree(folder)


def make_disk_by_sudo(found, disk, packages):
    if shutil.which("sudo") is None:
        raise kernel.Unavailable("the image of the full guest is made as root, and there is no sudo here")
    done = subprocess.run(["sudo", "-n", sys.executable, __file__, found.release, found.root, disk, *packages],
                          capture_output=True, text=True, timeout=DEBOOTSTRAP_TIMEOUT_S, check=False)
    if done.returncode != 0:
        raise kernel.Unavailable(f"the image of the full guest is made as root: {done.stderr.strip()[-500:]}")


def disk_image(found, programs):
    """The image, from the cache or made anew (a minute). Raises kernel.Unavailable."""
    packages = set(PACKAGES) | packages_of(programs)
    recipe = "\n".join([found.release, *sorted(packages), pathlib.Path(__file__).read_text(),
                        (HERE / "guest" / "payload.service").read_text()])
    disk = kernel.cache_folder() / f"debian-{hashlib.sha256(recipe.encode()).hexdigest()[:16]}.ext4"
    if disk.exists():
        return disk
    for old in kernel.cache_folder().glob("debian-*.ext4"):
        old.unlink()
    (make_disk if os.geteuid() == 0 else make_disk_by_sudo)(found, disk, sorted(packages))
    return disk


def run_full_guest(folder, found, disk, files, limit_s=guest.LIMIT_S):
    """Boots it, unpacks `files` (name → path here) to /run/payload, runs run.sh there as root; its results."""
    payload = folder / "payload.tar"
    with tarfile.open(payload, "w") as archive:
        for name, path in files.items():
            archive.add(path, name)
    disks = [*guest.drive("root", disk, ",snapshot=on"), *guest.drive("payload", payload, ",readonly=on")]
    try:
        return guest.run_guest(folder, found, 1024, disks, "root=/dev/nvme0n1 rw systemd.show_status=0",
                               ["-device", "virtio-rng-pci"], limit_s)
    finally:
        payload.unlink()


if __name__ == "__main__":
    make_disk(kernel.Kernel(sys.argv[1], pathlib.Path(sys.argv[2])), pathlib.Path(sys.argv[3]), sys.argv[4:])

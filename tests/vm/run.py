#!/usr/bin/env python3
"""The proof on a kernel: run.py BUILD_DIR FOLDER [TEST...]

Fetches kernel and headers, builds the virtual tester, runs the test programs (all of tests/vm/*_vm_test.py, or
those named), as many at a time as there are processors, and ends with one screen. What cannot be had is said: the
tests are then skipped, or failed where CI=true.
"""

import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import time

import debian
import kernel

HERE = pathlib.Path(__file__).resolve().parent
# Longest first: what is begun last should be short. The image of the full guest is made meanwhile.
ORDER = ("stream", "cycles", "service", "faults", "upgrade", "tester", "filesystems")
FULL = {"service", "upgrade"}
PROGRAMS = ("qemu-system-x86_64", "busybox", "cpio", "depmod", "mke2fs", "mmdebstrap", "make", "gcc", "strip")
# Of one program, its Debian image included where it is made anew.
LIMIT_S = 1800


def say(text):
    print(f"test-vm: {text}", flush=True)


def find_all():
    for program in PROGRAMS:
        if shutil.which(program) is None:
            raise kernel.Unavailable(f"no {program} here; ./dev deps vm installs it")
    return kernel.find_kernel()


def run_one(name, build, folder, disk):
    if name in FULL:
        # Why there is none is the program's to say.
        concurrent.futures.wait([disk])
    environment = dict(os.environ, STICKSLIP_VM_BUILD=str(build), STICKSLIP_VM_FOLDER=str(folder))
    began = time.monotonic()
    with open(folder / f"{name}.log", "w+", encoding="utf-8") as log:
        try:
            status = subprocess.run([sys.executable, "-m", "unittest", "-v", f"{name}_vm_test"], cwd=HERE, stdout=log,
                                    stderr=subprocess.STDOUT, env=environment, timeout=LIMIT_S, check=False).returncode
        except subprocess.TimeoutExpired:
            status = f"longer than {LIMIT_S} s"
        log.seek(0)
        return name, status, time.monotonic() - began, log.read()


def main():
    build, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        found = find_all()
    except kernel.Unavailable as why:
        must = os.environ.get("CI") == "true"
        say(f"{'FAILED' if must else 'SKIPPED'}: {why}")
        return 1 if must else 0
    present = [name for name in ORDER if (HERE / f"{name}_vm_test.py").exists()]
    assert len(present) == len(list(HERE.glob("*_vm_test.py"))), "a test program is missing in ORDER"
    names = sys.argv[3:] or present
    say(f"kernel {found.release}, translated; {', '.join(names)}")
    outcomes = []
    with (concurrent.futures.ThreadPoolExecutor(max_workers=1) as aside,
          concurrent.futures.ThreadPoolExecutor(max_workers=max(1, os.cpu_count() or 1)) as pool):
        # Mostly the network's and the disk's work, so that it takes no guest's place.
        programs = [build / "bin" / name for name in ("stickslipd", "stickslip")]
        disk = aside.submit(debian.disk_image, found, programs) if FULL & set(names) else None
        kernel.build_module(found, folder / "module" / found.release)
        for done in concurrent.futures.as_completed([pool.submit(run_one, name, build, folder, disk)
                                                     for name in names]):
            outcomes.append(done.result())
            print(outcomes[-1][3], flush=True)
    for name, status, seconds, _ in outcomes:
        say(f"{name:10} {'passed' if status == 0 else f'FAILED ({status})':12} {seconds:5.0f} s")
    return 0 if all(status == 0 for _, status, _, _ in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())

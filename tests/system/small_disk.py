"""A disk that is full for real: a small file system in memory, in a mount namespace of this process alone."""

import os
import subprocess
import sys

SKIPPED = 77


def own_mounts():
    """Runs the program again in a mount namespace of its own; returns there. Without the permission the program ends as
    skipped, and says so."""
    if "STICKSLIP_OWN_MOUNTS" in os.environ:
        return
    environment = dict(os.environ, STICKSLIP_OWN_MOUNTS="1")
    own = subprocess.run(["unshare", "--mount", "--map-root-user" if os.geteuid() else "--mount", "true"],
                         capture_output=True, text=True, check=False)
    if own.returncode != 0:
        print(f"skipped: no mount namespace here: {own.stderr.strip()}")
        sys.exit(SKIPPED)
    options = ["--mount"] + (["--map-root-user"] if os.geteuid() else [])
    sys.exit(subprocess.run(["unshare", *options, sys.executable, *sys.argv], env=environment, check=False).returncode)


def mount(folder, size_MiB):
    """Ends the program as skipped where nothing may be mounted."""
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size_MiB}m", "tmpfs", str(folder)],
                             capture_output=True, text=True, check=False)
    if mounted.returncode != 0:
        print(f"skipped: no file system may be mounted here: {mounted.stderr.strip()}")
        sys.exit(SKIPPED)


def leave(folder, size):
    """Room for so many bytes."""
    with (folder / "filler").open("wb") as filler:
        room = os.statvfs(folder)
        os.posix_fallocate(filler.fileno(), 0, room.f_bavail * room.f_frsize - size)


def fill(folder):
    """Leaves not a byte."""
    with (folder / "filler").open("ab", buffering=0) as filler:
        for size in (1 << 20, 1 << 12, 1):
            try:
                while True:
                    filler.write(bytes(size))
            except OSError:
                continue

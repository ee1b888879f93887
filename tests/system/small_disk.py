"""A disk that is full for real: a small file system in memory, in a mount namespace of this process alone."""

import os
import subprocess
import sys
import tempfile

SKIPPED = 77


def namespace():
    """The command that begins a mount namespace."""
    return ["unshare", "--mount"] + (["--map-root-user"] if os.geteuid() else [])


def why_none():
    """Why no small file system can be had here; None: it can."""
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        tried = subprocess.run([*namespace(), "mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", folder], capture_output=True, text=True, check=False)
    return tried.stderr.strip() if tried.returncode != 0 else None


def own_mounts(needed=True):
    """Runs the program again in a mount namespace of its own; returns there. Without the permission: where all of it needs
    one, the program ends as skipped, and says so; else returns why there is none, for skipTest()."""
    if "STICKSLIP_OWN_MOUNTS" in os.environ:
        return None
    environment = dict(os.environ, STICKSLIP_OWN_MOUNTS="1")
    if (why := why_none()) is not None:
        told = f"no file system may be mounted here: {why}"
        if not needed:
            return told
        print(f"skipped: {told}")
        sys.exit(SKIPPED)
    sys.exit(subprocess.run([*namespace(), sys.executable, *sys.argv], env=environment, check=False).returncode)


def mount(folder, size_MiB):
    """In the namespace of own_mounts()."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size_MiB}m", "tmpfs", str(folder)], check=True)


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

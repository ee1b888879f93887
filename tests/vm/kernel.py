"""Debian's cloud kernel with its headers: downloaded and unpacked, never installed; and our module built for it.

The cache is ${XDG_CACHE_HOME:-~/.cache}/stickslip-vm/RELEASE. Which release is current is asked of apt each
time; where apt does not know one (no network yet), the newest cached one serves.
"""

import dataclasses
import os
import pathlib
import re
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
IMAGE_PACKAGE = "linux-image-cloud-amd64"
DOWNLOAD_TIMEOUT_S = 300


class Unavailable(Exception):
    """What the tests need is not there and cannot be had: they skip, or fail where CI=true."""


@dataclasses.dataclass(frozen=True)
class Kernel:
    release: str        # as uname -r says it
    root: pathlib.Path  # of the unpacked packages

    @property
    def image(self):
        return self.root / "boot" / f"vmlinuz-{self.release}"

    @property
    def modules(self):
        return self.root / "lib" / "modules" / self.release

    @property
    def headers(self):
        return self.root / "usr" / "src" / f"linux-headers-{self.release}"


def cache_folder():
    base = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(base) / "stickslip-vm"


def output_of(*command, cwd=None):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=DOWNLOAD_TIMEOUT_S, check=False)
    if done.returncode != 0:
        raise Unavailable(f"{' '.join(map(str, command))}: {done.stderr.strip()[-500:]}")
    return done.stdout


def dependencies_of(package):
    return re.findall(r"Depends: ([\w.+-]+)", output_of("apt-cache", "depends", package))


def current_release():
    for name in dependencies_of(IMAGE_PACKAGE):
        if found := re.fullmatch(r"linux-image-(.+-cloud-amd64)", name):
            return found[1]
    raise Unavailable(f"apt knows no {IMAGE_PACKAGE}; run: apt-get update")


def unpack(release, target):
    headers = f"linux-headers-{release}"
    packages = [f"linux-image-{release}", headers]
    packages += [name for name in dependencies_of(headers)
                 if re.fullmatch(r"linux-headers-.+-common|linux-kbuild-.+", name)]
    output_of("apt-get", "-qq", "download", *packages, cwd=target)
    for package in target.glob("*.deb"):
        output_of("dpkg-deb", "--extract", package, target)
        package.unlink()
    # The only absolute path among the headers.
    makefile = target / "usr" / "src" / headers / "Makefile"
    makefile.write_text(makefile.read_text().replace(" /usr/src/", f" {final_root(release)}/usr/src/"))


def final_root(release):
    return cache_folder() / release


def find_kernel():
    """The current kernel, downloaded if it is not cached. Raises Unavailable."""
    for program in ("apt-cache", "apt-get", "dpkg-deb"):
        if shutil.which(program) is None:
            raise Unavailable(f"no {program} here: a Debian 12 system is needed")
    try:
        release = current_release()
    except Unavailable:
        cached = sorted(cache_folder().glob("*-cloud-amd64"), key=lambda folder: folder.stat().st_mtime)
        if not cached:
            raise
        release = cached[-1].name
    root = final_root(release)
    if not root.exists():
        unfinished = cache_folder() / f"{release}.unfinished"
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        unpack(release, unfinished)
        unfinished.rename(root)
    return Kernel(release, root)


def build_module(kernel, folder):
    """Builds tests/vm/tester for the kernel. Returns the module; a compiler error is an error of ours."""
    folder.mkdir(parents=True, exist_ok=True)
    for source in (HERE / "tester").iterdir():
        target = folder / source.name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            shutil.copyfile(source, target)
    subprocess.run(["make", "-C", kernel.headers, f"M={folder}", "modules"], check=True,
                   stdout=subprocess.DEVNULL, timeout=DOWNLOAD_TIMEOUT_S)
    return folder / "stickslip_tester.ko"

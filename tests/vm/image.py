"""The small guest: one cpio archive of busybox, two or three kernel modules, our programs and their libraries."""

import pathlib
import re
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
BUSYBOX = pathlib.Path("/bin/busybox")
COMEDI_MODULES = ("comedi", "comedi_test")
# ext4 is built in.
FILE_SYSTEM_MODULES = ("loop", "fat", "vfat", "nls_cp437", "nls_ascii", "nls_utf8")
FOLDERS = ("bin", "sbin", "proc", "sys", "dev", "tmp", "run", "etc", "results", "lib64", "lib/firmware",
           "var/lib/comedi/calibrations")


def libraries_of(program):
    shown = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    return [pathlib.Path(path) for path in re.findall(r"(/\S+) \(0x", shown)]


def install(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, target)


def add_modules(root, kernel, more):
    folder = root / "lib" / "modules" / kernel.release
    for name in COMEDI_MODULES + FILE_SYSTEM_MODULES:
        [module] = kernel.modules.rglob(f"{name}.ko")
        install(module, folder / module.relative_to(kernel.modules))
    for module in more:
        install(module, folder / "extra" / module.name)
    for index in ("modules.order", "modules.builtin", "modules.builtin.modinfo"):
        (folder / index).touch()
    subprocess.run(["depmod", "-b", root, kernel.release], check=True)


def add_programs(root, programs):
    for program in programs:
        target = root / "bin" / program.name
        install(program, target)
        # Lines of source are 9/10 of it, and memory is what the guest boots from.
        subprocess.run(["strip", "--strip-debug", target], check=True)
        for library in libraries_of(program):
            install(library.resolve(), root / str(library).lstrip("/"))


def build_image(folder, kernel, programs, modules, files):
    """Writes FOLDER/guest.cpio: runs /run.sh and powers off. `files` maps paths in the guest to paths here."""
    root = folder / "root"
    shutil.rmtree(root, ignore_errors=True)
    for name in FOLDERS:
        (root / name).mkdir(parents=True)
    install(BUSYBOX, root / "bin" / "busybox")
    applets = subprocess.run([BUSYBOX, "--list"], capture_output=True, text=True, check=True).stdout.split()
    for applet in applets:
        if applet != "busybox":
            (root / "bin" / applet).symlink_to("busybox")
    add_modules(root, kernel, modules)
    add_programs(root, programs)
    install(HERE / "guest" / "init", root / "init")
    install(HERE / "guest" / "lib.sh", root / "lib.sh")
    for path, source in files.items():
        install(source, root / path.lstrip("/"))
    (root / "init").chmod(0o755)
    image = folder / "guest.cpio"
    # Not compressed: unpacking costs a translated processor more than reading.
    with open(image, "wb") as archive:
        names = "\0".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
        subprocess.run(["cpio", "--null", "-o", "-H", "newc", "--quiet"], cwd=root, input=names.encode(),
                       stdout=archive, check=True)
    shutil.rmtree(root)
    return image

"""What the test programs share: where things are, and a small guest from script to results."""

import json
import os
import pathlib
import subprocess
import unittest

import guest
import image
import kernel

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
# Set by run.py.
BUILD = pathlib.Path(os.environ.get("STICKSLIP_VM_BUILD", SOURCE / "build" / "release")).resolve()
FOLDER = pathlib.Path(os.environ.get("STICKSLIP_VM_FOLDER", SOURCE / "build" / "vm")).resolve()
DAEMON = BUILD / "bin" / "stickslipd"
CLI = BUILD / "bin" / "stickslip"
PACKAGE = FOLDER / "package"  # Of the same build, made by ./dev.
FREEZE_THREAD = BUILD / "tests" / "system" / "freeze_thread"
CONFORMANCE = BUILD / "tests" / "conformance" / "conformance_board"
SCENES = SOURCE / "config" / "scenes"

FINALISER_TIMEOUT_S = 120


def or_skip(make, *arguments):
    """make(*arguments); what cannot be had skips the tests, but fails them where CI=true."""
    try:
        return make(*arguments)
    except kernel.Unavailable as why:
        if os.environ.get("CI") == "true":
            raise
        raise unittest.SkipTest(str(why)) from why


def tester_module(found):
    return FOLDER / "module" / found.release / "stickslip_tester.ko"


def small_guest(name, files=None):
    """Runs tests/vm/guest/NAME.sh; returns the folder of what it left in /results."""
    found = kernel.find_kernel()
    folder = guest.folder_for(FOLDER, name)
    contents = {"/run.sh": HERE / "guest" / f"{name}.sh", **(files or {})}
    archive = image.build_image(folder, found, [DAEMON, CLI, CONFORMANCE], [tester_module(found)], contents)
    try:
        return guest.run_small_guest(folder, found, archive)
    finally:
        archive.unlink()


def finalise(journal):
    """Builds the record of a journal that a killed daemon left."""
    subprocess.run([DAEMON, "--finalise", journal], check=True, timeout=FINALISER_TIMEOUT_S)
    return journal.with_suffix(".h5")


def status(results, daemon, when):
    return json.loads((results / daemon / f"{when}.json").read_text())


def records(results, daemon):
    return sorted((results / daemon / "records").glob("*.h5"))

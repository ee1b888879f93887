#!/usr/bin/env python3
"""What the documents tell people to type works: every line of a ```sh block that begins with stickslip or
stickslipd is run and must end with 0. The lines of one document run in order in one folder, which holds what
a clone holds (config/) and a measured trace.

A block that cannot be run here has the reason above it: <!-- not run: needs a board -->

documents_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600

BLOCK = re.compile(r"(?:<!-- not run: (?P<reason>[^>]*?) -->\n+)?```sh\n(?P<lines>.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(document):
    """(reason not to run or None, commands) of each block."""
    for block in BLOCK.finditer(document.read_text(encoding="utf-8")):
        lines = block["lines"].replace("\\\n", " ").splitlines()
        yield block["reason"], [line for line in lines if re.match(r"stickslipd?\s", line)]


def documents():
    return [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


def write_trace(file, rate_hz=2000, duration_s=2):
    """A sawtooth like that of sticking paper, for the lines about measured traces."""
    with file.open("w", encoding="ascii") as out:
        out.write("t_s,mu\n")
        for scan in range(rate_hz * duration_s):
            phase = scan * 20 / rate_hz
            out.write(f"{scan / rate_hz:.4f},{0.25 + 0.1 * (phase - math.floor(phase)):.5f}\n")


class Documents(unittest.TestCase):
    def run_document(self, document):
        environment = dict(os.environ, PATH=f"{BUILD / 'daemon'}:{os.environ['PATH']}")
        with tempfile.TemporaryDirectory(prefix="stickslip-") as name:
            folder = pathlib.Path(name)
            shutil.copytree(SOURCE / "config", folder / "config")
            write_trace(folder / "trace.csv")
            ran = 0
            for reason, commands in blocks(document):
                if reason is not None:
                    self.assertNotEqual(reason.strip(), "", document)
                    continue
                for command in commands:
                    with self.subTest(document=document.name, command=command):
                        done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment,
                                              capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
                        self.assertEqual(done.returncode, 0, done.stderr)
                    ran += 1
            return ran

    def test_every_command_in_the_documents_works(self):
        ran = {document.name: self.run_document(document) for document in documents()}
        # So that a change of the style of blocks does not make the test empty.
        self.assertGreater(ran["README.md"], 4)
        self.assertGreater(ran["simulate.md"], 4)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

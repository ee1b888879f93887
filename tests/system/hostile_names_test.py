#!/usr/bin/env python3
"""Files whose names would forge a line, clear the terminal or turn the direction of text, given to the commands.

hostile_names_test.py BUILD_DIR SOURCE_DIR
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
del sys.argv[1:3]

FORGED = "complete    forged.h5: record version 1, 1 scans"
NAME = f"x\n{FORGED}\x1b[2J\x9b\u202egnp"


class HostileNames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.run_plainly("simulate", "stick-slip-at-12-in-per-min", "-o", "a.h5", "--duration", "5 s")
        shutil.copy(cls.folder / "a.h5", cls.folder / f"{NAME}.h5")
        (cls.folder / f"{NAME}.journal").write_bytes(b"SSJ1")

    @classmethod
    def run_plainly(cls, *arguments):
        return subprocess.run([str(BUILD / "bin" / "stickslip"), *arguments], cwd=cls.folder, capture_output=True, check=False,
                              env=dict(os.environ, STICKSLIP_SCENES=str(SOURCE / "config" / "scenes")))

    def judge(self, output, command):
        text = output.decode("utf-8")  # Or it is no UTF-8.
        for line in text.split("\n"):
            self.assertFalse(line.lstrip().startswith(FORGED), (command, text))
        for character in ("\x1b", "\x9b", "\u202e"):
            self.assertNotIn(character, text, command)

    def test_no_command_shows_them_as_they_are(self):
        record = f"{NAME}.h5"
        commands = [
            ["verify", record], ["verify", "--json", record], ["analyze", record], ["analyze", record, "--json"], ["report", record],
            ["report", record, "--json", "-"], ["report", record, "--csv", "-"], ["report", record, "-o", "-"], ["compare", record, "a.h5", "--", "a.h5"],
            ["export", record, "--csv"], ["export", record, "--cycles", "--csv"], ["plot", record, "-o", f"{NAME}.svg"], ["recover", "."],
            ["characterise", record], ["import", record, "--column", "a", "--rate", "1 Hz", "--unit", "N", "-o", "q.h5"],
            ["simulate", record, "-o", "z.h5"], ["simulate", "stick-slip-at-12-in-per-min", "--duration", "5 s", "-o", f"{NAME}.simulated.h5"],
            ["sweep", record, "-o", "s.h5"], ["calibrate", "--points", record, "--folder", NAME], ["doctor", "--config", record],
            ["status", "--socket", NAME], ["list", "--socket", NAME], ["mark", NAME, "--socket", NAME], ["methods", NAME], ["scenes", NAME],
            ["void", record, "--reason", NAME, "--socket", NAME],
            ["bundle", "--config", record, "-o", f"{NAME}.txt"],
        ]
        succeeded = 0
        for command in commands:
            with self.subTest(command=command):
                done = self.run_plainly(*command)
                self.judge(done.stdout, command)
                self.judge(done.stderr, command)
                self.assertGreater(len(done.stdout + done.stderr), 0, command)
                succeeded += done.returncode == 0
        self.assertGreaterEqual(succeeded, 10)

    def test_pictures_and_pages_hold_no_such_character(self):
        record = f"{NAME}.h5"
        for command, file in ((["plot", record, "-o", "p.svg"], "p.svg"), (["report", record, "-o", "r.html"], "r.html")):
            self.assertEqual(self.run_plainly(*command).returncode, 0, command)
            text = (self.folder / file).read_text(encoding="utf-8")
            for character in ("\x1b", "\x9b", "\u202e"):
                self.assertNotIn(character, text, file)

    def test_the_daemon_logs_them_in_one_line(self):
        config = self.folder / "d.toml"
        config.write_text('[board]\ndriver = "replay"\nclock_speed = 400\n[board.replay]\nfile = "a.h5"\n[record]\nfolder = "n"\n', encoding="utf-8")
        (self.folder / "n").mkdir()
        (self.folder / "n" / f"{NAME}.journal").write_bytes(b"JUNK")
        done = subprocess.run([str(BUILD / "bin" / "stickslipd"), "--config", str(config)], cwd=self.folder, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.judge(done.stdout, "stickslipd")
        self.judge(done.stderr, "stickslipd")
        self.assertIn(b"forged", done.stderr)


if __name__ == "__main__":
    unittest.main()

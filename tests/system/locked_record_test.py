#!/usr/bin/env python3
"""A whole record that another program has open for writing is not damaged: every reader says what it is and what to do,
and after that was done reads it.

locked_record_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
DAEMON = BUILD / "bin" / "stickslipd"
TIMEOUT_S = 120
OPEN_ELSEWHERE = "is open for writing in another program: close it there (h5py has it open in mode r+), then try again"
NOT_JUDGED = 4

READERS = {
    "verify": ([CLI, "verify", "r.h5"], NOT_JUDGED),
    "analyze": ([CLI, "analyze", "r.h5"], 1),
    "export": ([CLI, "export", "--csv", "r.h5", "-o", "r.csv"], 1),
    "report": ([CLI, "report", "r.h5"], 1),
    "plot": ([CLI, "plot", "r.h5", "-o", "r.svg"], 1),
    "result": ([DAEMON, "--result", "r.h5"], 1),
}


class LockedRecord(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        subprocess.run([CLI, "simulate", "stick-slip-at-12-in-per-min", "-o", "r.h5", "--duration", "5 s", "--folder",
                        SOURCE / "config" / "scenes"], cwd=self.folder, check=True, capture_output=True, timeout=TIMEOUT_S)

    def run_reader(self, name):
        """(exit status, what it said)"""
        done = subprocess.run(READERS[name][0], cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        return done.returncode, done.stdout + done.stderr

    def test_every_reader_says_that_it_is_open_elsewhere(self):
        with h5py.File(self.folder / "r.h5", "r+"):
            for name, (_, expected) in READERS.items():
                with self.subTest(name):
                    status, said = self.run_reader(name)
                    self.assertEqual(status, expected, said)
                    self.assertIn(OPEN_ELSEWHERE, said)
                    self.assertNotIn("damage", said)
                    self.assertNotIn("backup", said)
        # The remedy works.
        for name in READERS:
            with self.subTest(name):
                status, said = self.run_reader(name)
                self.assertEqual(status, 0, said)

    def test_a_replay_waits_until_it_is_closed(self):
        (self.folder / "replay.toml").write_text('[board]\ndriver = "replay"\nclock_speed = 50\nreplay.file = "r.h5"\n', encoding="utf-8")
        with h5py.File(self.folder / "r.h5", "r+"):
            daemon = subprocess.Popen([DAEMON, "--config", "replay.toml"], cwd=self.folder, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
            self.addCleanup(daemon.kill)
            said = daemon.stderr.readline()
            while "board busy" not in said:
                self.assertNotEqual(said, "", "the daemon ended")
                said = daemon.stderr.readline()
            self.assertIn(OPEN_ELSEWHERE, said)
        _, said = daemon.communicate(timeout=TIMEOUT_S)
        self.assertEqual(daemon.returncode, 0, said)
        self.assertEqual(len(list((self.folder / "records").glob("*.h5"))), 1, said)

    def test_readers_share_a_record_with_readers(self):
        with h5py.File(self.folder / "r.h5", "r"):
            status, said = self.run_reader("verify")
            self.assertEqual(status, 0, said)

    @unittest.skipUnless(os.geteuid() == 0, "only root can become somebody who may not read it")
    def test_a_record_that_one_may_not_read_is_not_judged(self):
        self.folder.chmod(0o755)
        (self.folder / "r.h5").chmod(0o600)
        done = subprocess.run([CLI, "verify", "r.h5"], cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S,
                              check=False, user=65534, group=65534, extra_groups=[])
        self.assertEqual(done.returncode, NOT_JUDGED, done.stdout)
        self.assertIn("Permission denied", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

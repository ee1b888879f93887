#!/usr/bin/env python3
"""A record whose reader does not come back, and inputs that are no files: each command ends in time with one line.

damaged_files_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
DAEMON = BUILD / "bin" / "stickslipd"
SANITIZED = any(flag in str(BUILD) for flag in ("asan", "tsan"))
SCENE = "stick-slip-at-12-in-per-min"
# The limit is 10 s of processor time; under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 300


def run(program, *arguments):
    return subprocess.run([str(a) for a in (program, *arguments)], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)


def claim_scans(path, count):
    """Lets each column of scans have `count` rows that take no room in the file: HDF5 gives zeros for them."""
    with h5py.File(path, "r+") as record:
        raw = record["entry/raw"]
        for name, column in list(raw.items()):
            attributes = {key: value for key, value in column.attrs.items() if key not in ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME")}
            kind = column.dtype
            del raw[name]
            raw.create_dataset(name, (count,), kind, maxshape=(None,), chunks=(1 << 16,)).attrs.update(attributes)


class DamagedFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.sound, cls.zeroed, cls.fifo = (cls.folder / name for name in ("sound.h5", "zeroed.h5", "fifo"))
        made = run(CLI, "simulate", SCENE, "-o", cls.sound, "--duration", "5 s")
        assert made.returncode == 0, made.stderr
        content = bytearray(cls.sound.read_bytes())
        heap = content.index(b"GCOL")
        content[heap + 512 : heap + 1024] = bytes(512)
        cls.zeroed.write_bytes(content)
        # 200 kB that stand for 2 GB in each column, as many rows as are read.
        cls.large = cls.folder / "large.h5"
        cls.large.write_bytes(cls.sound.read_bytes())
        claim_scans(cls.large, 250_000_000)
        os.mkfifo(cls.fifo)
        cls.config = cls.folder / "replay.toml"
        cls.config.write_text(f'[board]\ndriver = "replay"\nreplay = {{ file = "{cls.zeroed}" }}\n[record]\nfolder = "{cls.folder}/records"\n', encoding="utf-8")

    def refused_in_one_line(self, done, *says):
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for text in says:
            self.assertIn(text, done.stderr)

    def test_a_reader_that_spins_is_ended(self):
        # Waits for the 10 s of processor time, and so does verify below; others are tried with what ends at once.
        done = run(CLI, "analyze", self.zeroed)
        self.refused_in_one_line(done, f"{self.zeroed}: cannot be read in 10.", " s of processor time, which is the limit for its size")

    def test_verify_says_damaged_and_goes_on(self):
        done = run(CLI, "verify", self.zeroed, self.sound)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn(f"damaged     {self.zeroed}", done.stdout)
        self.assertIn(f"complete    {self.sound}", done.stdout)

    @unittest.skipIf(SANITIZED, "a sanitizer maps terabytes: there is no limit of memory")
    def test_every_reader_has_a_limit_of_memory(self):
        config = self.folder / "large.toml"
        config.write_text(self.config.read_text(encoding="utf-8").replace(str(self.zeroed), str(self.large)), encoding="utf-8")
        for command in ([CLI, "analyze"], [CLI, "report"], [CLI, "characterise"], [CLI, "export", "--csv"],
                        [CLI, "plot", "-o", self.folder / "x.svg"], [DAEMON, "--config"]):
            with self.subTest(command):
                done = run(*command, config if command[0] == DAEMON else self.large)
                self.refused_in_one_line(done, f"{self.large}: cannot be read in 51", " MB of memory, which is the limit for its size")
        # The children's largest; the shell of this test is smaller.
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024, 1e9)

    def test_a_signal_ends_the_reading_of_a_replay(self):
        for stop in (signal.SIGTERM, signal.SIGINT):
            with subprocess.Popen([DAEMON, "--config", self.config], stderr=subprocess.PIPE, text=True) as daemon:
                children = pathlib.Path(f"/proc/{daemon.pid}/task/{daemon.pid}/children")
                while not (child := children.read_text(encoding="utf-8").split()) and daemon.poll() is None:
                    time.sleep(0.01)
                begun = time.monotonic()
                daemon.send_signal(stop)
                status = daemon.wait(TIMEOUT_S)
                self.assertEqual(status, 0, daemon.stderr.read())
                self.assertLess(time.monotonic() - begun, 8)
                self.assertFalse(any(pathlib.Path(f"/proc/{pid}").exists() for pid in child))

    def test_a_fifo_is_no_input(self):
        says = f"{self.fifo}: is a FIFO, not a regular file"
        new = self.folder / "new.h5"
        for arguments in (
            ["analyze", self.fifo],
            ["report", self.fifo],
            ["characterise", self.fifo],
            ["export", "--csv", self.fifo],
            ["plot", self.fifo, "-o", self.folder / "x.svg"],
            ["import", self.fifo, "--column", "a", "--rate", "350 Hz", "--unit", "coefficient", "-o", new],
            ["simulate", self.fifo, "-o", new],
            ["analyze", self.sound, "--tester", self.fifo],
            ["analyze", self.sound, "--method", self.fifo],
            ["calibrate", "--points", self.fifo, "--folder", self.folder],
        ):
            with self.subTest(arguments):
                self.refused_in_one_line(run(CLI, *arguments), says)
        self.assertIn(says, run(CLI, "recover", self.fifo).stdout)
        done = run(CLI, "verify", self.fifo)
        self.assertEqual((done.returncode, done.stderr), (4, ""))
        self.assertIn("is a FIFO", done.stdout)
        self.refused_in_one_line(run(DAEMON, "--config", self.fifo), says)
        self.refused_in_one_line(run(DAEMON, "--check-config", self.fifo), says)
        method = self.folder / "method.toml"
        method.write_text(self.config.read_text(encoding="utf-8") + f'[method]\nfile = "{self.fifo}"\n', encoding="utf-8")
        self.refused_in_one_line(run(DAEMON, "--check-config", method), says)

    def test_a_fifo_as_a_journal_does_not_hold_the_start_up(self):
        records = self.folder / "with-fifo"
        records.mkdir()
        journal = records / "20260101T000000Z-0001.journal"
        os.mkfifo(journal)
        config = self.folder / "with-fifo.toml"
        config.write_text(f'[board]\ndriver = "replay"\nclock_speed = 50\nreplay = {{ file = "{self.sound}" }}\n[record]\nfolder = "{records}"\n',
                          encoding="utf-8")
        done = run(DAEMON, "--config", config)
        self.assertIn(f"{journal}: is a FIFO, not a regular file", done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(journal.is_fifo())
        self.assertEqual(len(list(records.glob("*.h5"))), 1)

    def test_standard_input_stays_an_input(self):
        new = self.folder / "piped.h5"
        done = subprocess.run([CLI, "import", "/dev/stdin", "--column", "a", "--rate", "350 Hz", "--unit", "coefficient", "-o", new],
                              input="a\n0.1\n0.2\n", capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

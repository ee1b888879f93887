#!/usr/bin/env python3
"""`stickslip find`: records by date, sample, regime and results; the index follows the folder.

find_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import csv
import io
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
STICKSLIP = BUILD / "bin" / "stickslip"
TIMEOUT_S = 300
NOTHING_FOUND = 3


class Find(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.cache = self.folder / "cache"
        self.records = self.folder / "records" / "2026" / "11"
        self.records.mkdir(parents=True)
        for name, scene in (("sticks.h5", "stick-slip-at-12-in-per-min"), ("rings.h5", "ring-down-at-12-in-per-min")):
            self.run_stickslip("simulate", scene, "-o", str(self.records / name), "--folder", str(SOURCE / "config" / "scenes"),
                               "--duration", "5 s", "--seed", "7")

    def run_stickslip(self, *arguments, status=0):
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.cache), "TZ": "UTC"}
        done = subprocess.run([STICKSLIP, *arguments], cwd=self.folder, capture_output=True, check=False, timeout=TIMEOUT_S,
                              env=environment)
        self.assertEqual(done.returncode, status, done.stderr.decode())
        return done

    def found(self, *conditions, status=0):
        """Names of the files, in the order of the output."""
        lines = self.run_stickslip("find", "records", *conditions, "--paths", status=status).stdout.decode().splitlines()
        return [pathlib.Path(line).name for line in lines]

    def test_conditions(self):
        self.assertEqual(sorted(self.found()), ["rings.h5", "sticks.h5"])
        self.assertEqual(self.found("--regime", "stick-slip"), ["sticks.h5"])
        self.assertEqual(sorted(self.found("--regime", "stick-slip", "--regime", "ring-down")), ["rings.h5", "sticks.h5"])
        self.assertEqual(self.found("--where", "S=9:", status=NOTHING_FOUND), [])
        self.assertEqual(sorted(self.found("--method", "penner-1995")), ["rings.h5", "sticks.h5"])
        self.assertEqual(self.found("--sort", "regime"), ["rings.h5", "sticks.h5"])
        self.assertEqual(self.found("--sort", "regime", "--reverse", "--most", "1"), ["sticks.h5"])
        self.assertIn("1 more of 2 records are not shown: --most", self.run_stickslip("find", "records", "--most", "1").stdout.decode())
        self.assertEqual(self.found("--from", "2000-01-01", status=NOTHING_FOUND), [])  # A simulation has no date.

    def test_outputs_say_the_same(self):
        table = self.run_stickslip("find", "records").stdout.decode()
        self.assertLessEqual(max(map(len, table.splitlines())), 80)
        records = json.loads(self.run_stickslip("find", "records", "--json").stdout)["records"]
        rows = list(csv.DictReader(io.StringIO(self.run_stickslip("find", "records", "--csv").stdout.decode())))
        self.assertEqual([record["file"] for record in records], [row["file"] for row in rows])
        for record, row in zip(records, rows):
            shown = json.loads(self.run_stickslip("show", record["file"], "--json").stdout)["results"]
            for name in ("regime", "mu_s", "mu_k", "delta_mu"):
                self.assertEqual(record["results"][name], shown[name])
            self.assertEqual(float(row["delta_mu"]), shown["delta_mu"])
            self.assertEqual(float(row["delta_mu_standard_error"]), shown["details"]["delta_mu"]["standard_error"])
        zero = self.run_stickslip("find", "records", "-0").stdout
        self.assertEqual([name.decode() for name in zero.split(b"\0")], [record["file"] for record in records] + [""])

    def test_json_counts_all_and_says_what_is_void(self):
        self.run_stickslip("void", str(self.records / "rings.h5"), "--reason", "torn")
        for folder, prefix in (("records/2026/11", ""), ("records/2026", "11/")):
            told = json.loads(self.run_stickslip("find", folder, "--sort", "regime", "--json").stdout)
            self.assertEqual((told["count"], [record["record"] for record in told["records"]]), (2, [f"{prefix}rings.h5", f"{prefix}sticks.h5"]))
            self.assertEqual([(record["voided"] or {}).get("reason") for record in told["records"]], ["torn", None])
        told = json.loads(self.run_stickslip("find", "records/2026/11", "--most", "1", "--json").stdout)
        self.assertEqual((len(told["records"]), told["count"]), (1, 2))

    def test_paths_are_those_of_report(self):
        files = self.run_stickslip("find", "records", "--paths").stdout.decode().split()
        self.assertIn("n                2", self.run_stickslip("report", *files).stdout.decode())

    def test_names_that_a_line_or_a_command_would_mistake(self):
        for name in ("-o.h5", "two\nlines.h5"):
            shutil.copy(self.records / "sticks.h5", self.records / name)

        def files_in_it(option):
            environment = {**os.environ, "XDG_CACHE_HOME": str(self.cache)}
            return subprocess.run([STICKSLIP, "find", option], cwd=self.records, capture_output=True, check=True,
                                  timeout=TIMEOUT_S, env=environment)
        done = files_in_it("--paths")
        self.assertEqual(sorted(done.stdout.decode().splitlines()), ["./-o.h5", "rings.h5", "sticks.h5"])
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertIn(b"1 of 4 files have names that cannot be printed on a line, and are left out: use -0", done.stderr)
        done = files_in_it("-0")
        self.assertEqual(sorted(done.stdout.split(b"\0")), [b"", b"./-o.h5", b"rings.h5", b"sticks.h5", b"two\nlines.h5"])
        self.assertEqual(done.stderr, b"")

    def test_follows_the_folder(self):
        self.found()
        (self.records / "rings.h5").unlink()
        shutil.copy(self.records / "sticks.h5", self.records.parent / "copy.h5")
        (self.records / "torn.h5").write_bytes((self.records / "sticks.h5").read_bytes()[:5000])
        self.assertEqual(sorted(self.found()), ["copy.h5", "sticks.h5"])
        text = self.run_stickslip("find", "records").stdout.decode()
        self.assertIn("1 of 3 files could not be read and are missing here: --unread says why", text)
        text = self.run_stickslip("find", "records", "--unread").stdout.decode()
        self.assertIn("torn.h5: unreadable: is an HDF5 file but cut short or damaged", text)
        for option in ("--csv", "--json", "--paths", "-0"):
            told = self.run_stickslip("find", "records", option).stderr
            self.assertEqual(told.count(b"1 of 3 files could not be read"), 1)
            self.assertEqual(len(told.splitlines()), 1)
            self.run_stickslip("find", "records", option, "--unread", status=2)

    def test_a_file_whose_reader_is_killed_is_not_called_unreadable(self):
        self.found()
        content = bytearray((self.records / "sticks.h5").read_bytes())
        heap = content.index(b"GCOL")
        content[heap + 512 : heap + 1024] = bytes(512)  # HDF5 goes round in it: there is time to kill.
        (self.records / "spins.h5").write_bytes(content)
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.cache)}
        with subprocess.Popen([STICKSLIP, "find", "records", "--unread"], cwd=self.folder, stdout=subprocess.PIPE,
                              env=environment) as finding:
            children = pathlib.Path(f"/proc/{finding.pid}/task/{finding.pid}/children")
            while not (child := children.read_text(encoding="utf-8").split()) and finding.poll() is None:
                time.sleep(0.01)
            time.sleep(0.2)
            os.kill(int(child[0]), signal.SIGKILL)
            text = finding.communicate(timeout=TIMEOUT_S)[0].decode()
        self.assertIn("spins.h5: cannot look: cannot be read: its reader was ended by signal 9", text)

    def test_a_damaged_index_is_made_anew(self):
        self.found()
        index, = (self.cache / "stickslip").glob("catalogue-*.sqlite")
        self.assertEqual((self.cache / "stickslip").stat().st_mode & 0o777, 0o700)
        index.write_text("no database")
        done = self.run_stickslip("find", "records")
        self.assertIn(b"was damaged; it is made anew from the records", done.stderr)
        self.assertEqual(self.run_stickslip("find", "records").stderr, b"")

    def test_without_a_place_for_the_index_it_finds_all_the_same(self):
        self.cache.write_text("no folder")
        done = self.run_stickslip("find", "records", "--paths")
        self.assertIn(b"no index is kept", done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 2)

    def test_refusals(self):
        for arguments, message in ((("nowhere",), b"nowhere: No such file or directory: name a folder of records"),
                                   (("records", "--where", "S"), b"must be RESULT=LOWEST:HIGHEST"),
                                   (("records", "--regime", "sticks"), b"there is no such regime"),
                                   (("records", "--to", "soon"), b"--to soon: is no day or time")):
            self.assertIn(message, self.run_stickslip("find", *arguments, status=2).stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""Foreign traces: one simulated pull as other programs export it, each with the outcome that is right.

import_cases_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import csv
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

import h5py

CLI = pathlib.Path(sys.argv[1]).resolve() / "bin" / "stickslip"
CASES = pathlib.Path(sys.argv[2]).resolve() / ".." / "shared" / "cases" / "import"

# Of the whole pull, as the README of the cases says; the tolerances are three standard errors of the trace, rounded up.
STATIC, KINETIC, MU_S, MU_K, DELTA_MU, FREQUENCY_Hz = 0.3812, 0.3020, 0.3498, 0.3000, 0.0498, 19.484
TOLERANCES = {"static_coefficient": (STATIC, 0.002), "kinetic_coefficient": (KINETIC, 0.001), "mu_s": (MU_S, 0.002), "mu_k": (MU_K, 0.001),
              "delta_mu": (DELTA_MU, 0.002), "oscillation_frequency": (FREQUENCY_Hz, 0.03)}
SCANS = 2800
# What else is known of single files.
SCAN_COUNTS = {"Time_(s)_missing_rows.csv": 2700, "column_named_scan.csv": 2700, "truncated_last_value_9.csv": 2799, "starts_mid_slide.csv": 2300}
FREQUENCIES_Hz = {"time_named_Time_(s)_100Hz.csv": 5.567}
REMEDY = re.compile(r"give (--[a-z-]+(?: [a-z0-9]+)?)")


def options_of(row):
    # The separator of the list is a comma, and so is that of the column's name in one file.
    return shlex.split(row["options"])


class Cases(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-import-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def run_import(self, row, *more):
        for old in self.folder.glob("*.h5"):
            old.unlink()
        done = subprocess.run([CLI, "import", CASES / row["file"], "--column", row["column"], "--unit", row["unit"], "--sled-mass", "2331 g",
                               *options_of(row), *more, "-o", self.folder / "x.h5"], capture_output=True, text=True, check=False)
        return done, sorted(self.folder.glob("*.h5"))

    def right(self, row, record):
        expected = dict(TOLERANCES)
        if row["file"] in FREQUENCIES_Hz:
            expected["oscillation_frequency"] = (FREQUENCIES_Hz[row["file"]], 0.01)
        if "without static" in row["outcome"]:
            del expected["static_coefficient"]
        if row["file"] == "export_with_gaps.csv":  # Another pull, which says its results itself.
            said = dict(re.findall(r"^# (\w+): ([-0-9.e]+)", (CASES / row["file"]).read_text(encoding="utf-8"), re.MULTILINE))
            expected = {name: (float(said[name]), tolerance) for name, (_, tolerance) in expected.items() if name in said}
            # The program that wrote it counted a cycle of twice the length, in which a gap hides a slip. The truth is that of the other pulls.
            expected["oscillation_frequency"] = (TOLERANCES["oscillation_frequency"][0], 0.05)
        with h5py.File(record) as file:
            results = file["entry/results"]
            for name, (value, tolerance) in expected.items():
                self.assertAlmostEqual(results[name][()], value, delta=tolerance, msg=f"{row['file']}: {name}")
            if "without static" in row["outcome"]:
                self.assertTrue(math.isnan(results["static_coefficient"][()]), row["file"])
            if "start time" in row["outcome"]:
                self.assertTrue(file["entry/start_time"].asstr()[()].startswith(("2026-11-25T12:00:00.0", "2025-11-25T12:00:00.0")), file["entry/start_time"][()])
            count = len(file["entry/raw/scan"])
            gaps = len(file["entry/gaps/first_scan"]) if "entry/gaps" in file else 0
            self.assertEqual(gaps > 0, "gap" in row["outcome"] or row["file"].startswith("missing"), row["file"])
            self.assertEqual(file["entry/process/source_file"].asstr()[()], row["file"])
        return count

    def test_each_case_has_the_outcome_that_is_right(self):
        with open(CASES / "expected.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 50)
        for row in rows:
            with self.subTest(row["file"]):
                self.judge(row)

    def judge(self, row):
        done, records = self.run_import(row)
        outcome = row["outcome"]
        if done.returncode != 0:
            self.assertIn("refused", outcome, done.stderr)
            self.assertEqual((done.returncode, done.stderr.count("\n"), records), (2, 1, []), done.stderr)
            self.assertTrue(done.stderr.isprintable() or done.stderr[:-1].isprintable(), done.stderr)
            for option in REMEDY.findall(done.stderr):
                more, _ = self.run_import(row, *option.split())
                self.assertTrue(more.returncode == 0 or more.stderr != done.stderr, f"{option}: {more.stderr}")
            return
        self.assertNotEqual(outcome, "refused", done.stdout)
        self.assertEqual(done.stdout.count("recognised: "), 1, done.stdout)
        if outcome == "finding":
            self.assertIn("  finding: ", done.stdout)
            return
        if outcome == "three records each right":
            self.assertEqual([record.name for record in records], ["x-1.h5", "x-2.h5", "x-3.h5"])
        else:
            self.assertEqual([record.name for record in records], ["x.h5"], done.stdout)
        count = sum(self.right(row, record) for record in records)
        if row["file"] in SCAN_COUNTS:
            self.assertEqual(count, SCAN_COUNTS[row["file"]])


if __name__ == "__main__":
    if not CASES.is_dir() and not os.environ.get("CI"):
        print(f"{CASES}: not there; skipped")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

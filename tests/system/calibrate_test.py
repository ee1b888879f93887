#!/usr/bin/env python3
"""stickslip calibrate as a technician uses it, and what becomes of its files: the daemon takes the latest, each
record carries it, an expired one is told.

The board is a replayed trace of a load cell on which weights are hung: a step of one second for each, with noise.

calibrate_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

from stored import stored as stored_in

try:
    import h5py
except ImportError:
    h5py = None

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
STICKSLIP = BUILD / "bin" / "stickslip"
STICKSLIPD = BUILD / "bin" / "stickslipd"
TIMEOUT_S = 300

RATE_HZ = 350
GRAVITY = 9.80665
GAIN_N_PER_V = 2.0
ZERO_V = 0.0123
NOISE_V = 0.0005
SEED = 20261122

READINGS = """[[point]]
mass = "0 g"
voltage = "0.0123 V"
[[point]]
mass = "500 g"
voltage = "2.4639625 V"
[[point]]
mass = "1 kg"
voltage = "4.915625 V"
[[point]]
mass = "2 kg"
voltage = "9.81895 V"
[[point]]
mass = "1 kg"
voltage = "4.915625 V"
[[point]]
mass = "500 g"
voltage = "2.4639625 V"
[[point]]
mass = "0 g"
voltage = "0.0123 V"
"""

DAEMON = """[board]
driver = "simulated"
clock_speed = 50
[board.simulated]
scenes = ["{scene}"]
[tester]
calibration = "calibrations"
[sample]
name = "linerboard 42"
replicate = 3
[record]
folder = "records"
[log]
level = "warning"
"""


def write_stairs(file, masses):
    """One second of volts for each mass."""
    randoms = random.Random(SEED)
    with file.open("w", encoding="ascii") as out:
        out.write("t_s,v\n")
        for scan in range(RATE_HZ * len(masses)):
            volts = ZERO_V + masses[scan // RATE_HZ] * GRAVITY / GAIN_N_PER_V
            out.write(f"{scan / RATE_HZ:.6f},{volts + randoms.gauss(0, NOISE_V):.6f}\n")


needs_h5py = unittest.skipIf(h5py is None and os.environ.get("CI") != "true", "python3-h5py is not installed")


class Calibrate(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def run_program(self, program, *arguments, answers=""):
        return subprocess.run([program, *arguments], cwd=self.folder, input=answers, capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False)

    def calibrate(self, *arguments, answers=""):
        return self.run_program(STICKSLIP, "calibrate", *arguments, answers=answers)

    def weigh(self, masses, answers, *arguments, gain=None):
        write_stairs(self.folder / "stairs.csv", masses)
        made = self.run_program(STICKSLIP, "import", "stairs.csv", "--column", "v", "--rate", f"{RATE_HZ} Hz", "--unit",
                                "V", "--sled-mass", "1 kg", "--load-cell-gain", "1 N/V", "-o", "stairs.h5")
        self.assertEqual(made.returncode, 0, made.stderr)
        (self.folder / "bench.toml").write_text(
            '[board]\ndriver = "replay"\nclock_speed = 1000\n[board.replay]\nfile = "stairs.h5"\n'
            '[tester]\ncalibration = "calibrations"\n' + (f'load_cell_gain = "{gain}"\n' if gain else ""), encoding="utf-8")
        return self.calibrate("--config", "bench.toml", "--settle", "0.5 s", "--reading", "0.5 s", *arguments,
                              answers=answers)

    def test_a_technician_hangs_weights(self):
        masses = [0, 0.5, 1, 2, 3, 2, 1, 0.5, 0]
        answers = "\n" + "\n".join(["500 g", "1 kg", "2 kg", "3kg", "2 kg", "1 kg", "0.5 kg", "0"]) + "\ndone\n"
        done = self.weigh(masses, answers, "--certificate", "DKD-1", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        # Means of 175 scans: the standard errors are those of least squares; four of them.
        self.assertAlmostEqual(result["gain"], GAIN_N_PER_V, delta=4 * result["gain_standard_error"])
        self.assertAlmostEqual(result["zero"], ZERO_V, delta=4 * result["zero_standard_error"])
        self.assertLess(result["gain_standard_error"], 1e-4)
        self.assertEqual(result["certificate"], "DKD-1")
        self.assertEqual([point["mass"] for point in result["points"]], masses)
        self.assertEqual([point["refused"] for point in result["points"]], [""] * len(masses))
        self.assertTrue((self.folder / "calibrations").is_dir())
        self.assertIn("Hang the next weight", done.stderr)

    def test_a_weight_typed_but_not_hung_is_told_at_once(self):
        masses = [0, 0, 0.5, 1, 2, 1, 0.5, 0]
        answers = "\n1 kg\nten\n500\n500 g\n1 kg\n2 kg\n1 kg\ndone\n0.5 kg\n0\ndone\n"
        done = self.weigh(masses, answers)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("reads like no load", done.stderr)
        self.assertIn('that is no mass: "ten" does not begin with a decimal number', done.stderr)
        self.assertIn('that is no mass: "500": a mass needs its unit, such as "500 g" or "500 kg"', done.stderr)
        self.assertIn("not yet: 1 readings count on the way down", done.stderr)
        self.assertIn("kept in", done.stdout)

    def test_too_few_weights_or_no_answers_leave_nothing_behind(self):
        done = self.weigh([0, 1, 2, 1, 0], "\n1 kg\n2 kg\n1 kg\n0 g\ndone\n")
        self.assertEqual(done.returncode, 1)
        self.assertIn("2 different weights count on the way up; at least 3 are needed", done.stderr)
        (self.folder / "stairs.h5").unlink()
        self.assertEqual(self.weigh([0], "q\n").returncode, 1)
        self.assertFalse((self.folder / "calibrations").exists())

    @needs_h5py
    def test_history_is_kept_and_the_latest_is_in_each_record(self):
        (self.folder / "readings.toml").write_text(READINGS, encoding="utf-8")
        first = self.calibrate("--points", "readings.toml", "--folder", "calibrations", "--json")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("No gain in use is known: the new one is not compared.", first.stderr)
        [file] = (self.folder / "calibrations").iterdir()
        old = file.read_text(encoding="utf-8")
        # The same second: no file is ever written over.
        file.rename(file.with_name("20200101T000000Z.toml"))
        file = file.with_name("20200101T000000Z.toml")
        file.write_text(old.replace("date = \"20", "date = \"19", 1), encoding="utf-8")
        kept = file.read_text(encoding="utf-8")
        (self.folder / "readings.toml").write_text(READINGS.replace("9.81895", "9.82895"), encoding="utf-8")
        second = self.calibrate("--points", "readings.toml", "--folder", "calibrations", "--certificate", "DKD-2")
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertNotIn("No gain in use", second.stderr)
        self.assertIn("% against that of 19", second.stdout)
        self.assertEqual(file.read_text(encoding="utf-8"), kept)
        self.assertEqual(len(list((self.folder / "calibrations").iterdir())), 2)

        scene = SOURCE / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
        (self.folder / "daemon.toml").write_text(DAEMON.format(scene=scene), encoding="utf-8")
        done = self.run_program(STICKSLIPD, "--config", "daemon.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("expired", done.stderr)
        [path] = (self.folder / "records").glob("*.h5")
        with h5py.File(path) as record:
            calibration = record["entry/instrument/calibration"]
            self.assertEqual(calibration["certificate"][()].decode(), "DKD-2")
            self.assertEqual(list(calibration["weight_mass"]), [0, 0.5, 1, 2, 1, 0.5, 0])
            self.assertEqual(calibration["weight_residual"].shape, (7,))
            gain = calibration["gain"][()]
            relative = calibration["gain_standard_error"][()] / gain
            self.assertGreater(relative, 0)
            mu_s = record["entry/results/mu_s"]
            self.assertGreaterEqual(mu_s.attrs["systematic_uncertainty"], relative * mu_s[()] * (1 - 1e-12))
            self.assertEqual(record["entry/sample/name"][()].decode(), "linerboard 42")
            self.assertEqual(record["entry/sample/replicate"][()], 3)
            check = record["entry/self_check"]
            self.assertGreater(check["noise"][()], 0)
            self.assertGreaterEqual(len(check["counts"]), 60)
            texts = [text.decode() for text in record["entry/events/text"]]
            self.assertIn("test began: the force crossed the trigger", texts)

        # Analysed again, the file alone gives the same, systematic uncertainty and all.
        again = self.run_program(STICKSLIP, "analyze", str(path), "--json")
        [test] = json.loads(again.stdout)["tests"]
        with h5py.File(path) as record:
            for name, detail in (test["details"] | test["diagnostics"]).items():
                if name in ("regime", "rung"):
                    continue
                stored = stored_in(record)[name]
                if detail["value"] is not None:
                    self.assertEqual(detail["value"], stored[()], name)
                for key in ("standard_error", "systematic_uncertainty"):
                    self.assertEqual(detail.get(key), stored.attrs.get(key), name)

    @needs_h5py
    def test_an_expired_calibration_is_told_and_noted(self):
        (self.folder / "readings.toml").write_text(READINGS, encoding="utf-8")
        made = self.calibrate("--points", "readings.toml", "--folder", "calibrations")
        self.assertEqual(made.returncode, 0, made.stderr)
        [file] = (self.folder / "calibrations").iterdir()
        text = file.read_text(encoding="utf-8")
        line = next(line for line in text.splitlines() if line.startswith("expires"))
        file.write_text(text.replace(line, 'expires = "2025-01-01T00:00:00.000000000+00:00"'), encoding="utf-8")

        scene = SOURCE / "config" / "scenes" / "ring-down-at-12-in-per-min.toml"
        (self.folder / "daemon.toml").write_text(DAEMON.format(scene=scene), encoding="utf-8")
        done = self.run_program(STICKSLIPD, "--config", "daemon.toml")
        self.assertIn("expired on 2025-01-01", done.stderr)
        [path] = (self.folder / "records").glob("*.h5")
        with h5py.File(path) as record:
            texts = [text.decode() for text in record["entry/events/text"]]
            self.assertTrue(any("expired on 2025-01-01" in text for text in texts), texts)

    def wrong_readings(self):
        """Masses in grams that are called kilograms."""
        (self.folder / "wrong.toml").write_text(READINGS.replace('500 g"', '500 kg"').replace('"1 kg"', '"1000 kg"').replace('"2 kg"', '"2000 kg"'), encoding="utf-8")
        return "--points", "wrong.toml"

    def test_a_gain_far_from_the_one_in_use_needs_a_confirmation(self):
        (self.folder / "readings.toml").write_text(READINGS, encoding="utf-8")
        made = self.calibrate("--points", "readings.toml", "--folder", "calibrations", "--json")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIsNone(json.loads(made.stdout)["gain_change"])
        [file] = (self.folder / "calibrations").iterdir()
        old = file.with_name("20200101T000000Z.toml")
        text = file.read_text(encoding="utf-8")
        old.write_text(text.replace('date = "20', 'date = "19', 1), encoding="utf-8")
        file.unlink()
        refused = self.calibrate(*self.wrong_readings(), "--folder", "calibrations")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("gain-change: the load cell gain 2000 N/V is 1000 times the 2 N/V in use before, a change of more than 20 %: check the unit of each mass", refused.stderr)
        self.assertIn("nothing was kept; if the change is meant, repeat with --confirm", refused.stderr)
        self.assertEqual(list((self.folder / "calibrations").iterdir()), [old])
        done = self.calibrate(*self.wrong_readings(), "--folder", "calibrations", "--confirm", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertAlmostEqual(result["gain_change"]["ratio"], 1000, delta=0.01)
        self.assertEqual(result["findings"][-1], result["gain_change"]["text"])
        self.assertIn('replaced_gain = "2', pathlib.Path(self.folder / result["file"]).read_text(encoding="utf-8"))

    def test_a_technician_confirms_a_gain_far_from_the_nominal_one(self):
        masses = [0, 0.5, 1, 2, 1, 0.5, 0]
        answers = "\n500 kg\n1000 kg\n2000 kg\n1000 kg\n500 kg\n0\ndone\n"
        for answer, code in (("no\n", 1), ("", 1), ("yes\n", 0)):
            (self.folder / "stairs.h5").unlink(missing_ok=True)
            done = self.weigh(masses, answers + answer, gain="2 N/V")
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn("Type yes to keep it", done.stderr)
            self.assertEqual((self.folder / "calibrations").exists(), code == 0)

    def test_contradictions_are_refused(self):
        for arguments in ([], ["--points", "a.toml", "--config", "b.toml"], ["--points", "missing.toml"]):
            self.assertEqual(self.calibrate(*arguments).returncode, 2)
        (self.folder / "readings.toml").write_text(READINGS, encoding="utf-8")
        self.assertIn("--folder is needed", self.calibrate("--points", "readings.toml").stderr)
        (self.folder / "daemon.toml").write_text(
            DAEMON.format(scene="x.toml").replace("calibration =", 'load_cell_gain = "2 N/V"\ncalibration =').replace(
                '"calibrations"', '"one.toml"'),
            encoding="utf-8")
        done = self.run_program(STICKSLIPD, "--check-config", "daemon.toml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("stands in the calibration", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""`stickslip sweep` from outside.

sweep_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy

from stored import stored as stored_in
from terminal import run_at_a_terminal

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SCENE = "stick-slip-at-12-in-per-min"
SPEED = "effects.constant_speed.pull_speed"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600

# Half a second of pulling, so that a run is quick.
QUICK = ("--duration", "3.5 s")
GRID = ("--vary", f"{SPEED}=6 in/min:24 in/min:3", "--vary", "paper.mu_s=0.32,0.36")


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)


class Folder(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def sweep(self, name, *options, scene=SCENE):
        file = self.folder / name
        done = run(CLI, "sweep", scene, "-o", file, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")  # No progress where there is no terminal.
        self.assertEqual(sorted(self.folder.glob(f"{name}.*")), [])
        return file, done.stdout

    def open(self, file):
        opened = h5py.File(file)
        self.addCleanup(opened.close)
        return opened


class Sweep(Folder):
    def test_arrays_stand_over_the_grid_with_their_axes(self):
        file, _ = self.sweep("a.h5", *GRID, "--repeat", 2, *QUICK)
        sweep = self.open(file)
        self.assertEqual(sweep.attrs["default"], "entry")
        self.assertEqual(sweep["entry"].attrs["default"], "delta_mu")
        groups = [group for group in sweep["entry"].values() if group.attrs.get("NX_class") == "NXdata"]
        self.assertGreater(len(groups), 20)
        for group in groups:
            self.assertEqual(list(group.attrs["axes"]), [SPEED, "paper.mu_s", "repeat"])
            self.assertEqual(group["value"].shape, (3, 2, 2))
            for axis, values, units in [(SPEED, [6, 15, 24], "in/min"), ("paper.mu_s", [0.32, 0.36], "1"),
                                        ("repeat", [0, 1], "1")]:
                numpy.testing.assert_array_equal(group[axis], values)
                self.assertEqual(group[axis].attrs["units"], units)
            if "standard_error" not in group:
                continue
            self.assertEqual(group["standard_error"].shape, (3, 2, 2))
            self.assertEqual(group["value_errors"], group["standard_error"])
            reasons = group["reason"].asstr()[()]
            # A reason exactly where there is no value.
            numpy.testing.assert_array_equal(numpy.isnan(group["value"]), reasons != "", group.name)
        self.assertIn("no clock readings", sweep["entry/scan_rate_measured/reason"].asstr()[0, 0, 0])
        words = list(sweep["entry/regime/value"].attrs["words"])
        numpy.testing.assert_array_equal(sweep["entry/regime/truth"][0], words.index("stick-slip"))
        numpy.testing.assert_array_equal(sweep["entry/regime/truth"][2, 0], words.index("ring-down"))
        self.assertEqual(len(numpy.unique(sweep["entry/truth/seed"])), 12)
        # S − K to 10 %: half a second holds ten cycles, each of which tells it to a few per cent.
        error = sweep["entry/delta_mu/value"][0] / sweep["entry/delta_mu/truth"][0] - 1
        self.assertLess(abs(error).max(), 0.1)

    def test_a_run_is_what_simulate_gives_with_its_seed_and_the_scene_it_tells(self):
        file, _ = self.sweep("a.h5", "--vary", f"{SPEED}=12 in/min,24 in/min", "--repeat", 2, *QUICK)
        sweep = self.open(file)
        scene = self.folder / "scene.toml"
        scene.write_bytes(sweep["entry/process/scene_text"][()])
        for point, speed in enumerate(["12 in/min", "24 in/min"]):
            record = self.folder / f"{point}.h5"
            done = run(CLI, "simulate", scene, "--set", f"{SPEED}={speed}", "-o", record, "--seed",
                       sweep["entry/truth/seed"][point, 1])
            self.assertEqual(done.returncode, 0, done.stderr)
            with h5py.File(record) as simulated:
                for name, stored in stored_in(simulated).items():
                    if name == "rung":
                        rung = sweep["entry/rung/value"]
                        self.assertEqual(rung.attrs["words"][rung[point, 1]], stored.asstr()[()])
                    elif name not in ("regime", "findings"):
                        numpy.testing.assert_array_equal(stored[()], sweep[f"entry/{name}/value"][point, 1], name)

    def test_any_number_of_threads_gives_the_same_file(self):
        files = [self.sweep(f"{threads}.h5", *GRID, *QUICK, "--threads", threads)[0] for threads in (1, 2, 4)]
        self.assertEqual(files[0].read_bytes(), files[1].read_bytes())
        self.assertEqual(files[0].read_bytes(), files[2].read_bytes())
        other, _ = self.sweep("other.h5", *GRID, *QUICK, "--seed", 99)
        self.assertNotEqual(files[0].read_bytes(), other.read_bytes())

    def test_json_sums_up_what_the_file_holds(self):
        file, printed = self.sweep("a.h5", *GRID, "--repeat", 3, *QUICK, "--json")
        printed = json.loads(printed)
        sweep = self.open(file)
        self.assertEqual([axis["key"] for axis in printed["axes"]], [SPEED, "paper.mu_s"])
        self.assertEqual(printed["sweep"]["run_count"], 18)
        self.assertEqual(len(printed["points"]), 6)
        point = printed["points"][3]
        self.assertEqual(point["values"], {SPEED: 15.0, "paper.mu_s": 0.36})
        error = sweep["entry/delta_mu/value"][1, 1] - sweep["entry/delta_mu/truth"][1, 1]
        # Sums of three numbers below 1, in another order: some roundings.
        self.assertAlmostEqual(point["errors"]["delta_mu"]["mean"], error.mean(), delta=1e-15)
        self.assertAlmostEqual(point["errors"]["delta_mu"]["standard_deviation"], error.std(ddof=1), delta=1e-15)
        words = list(sweep["entry/regime/value"].attrs["words"])
        share = (sweep["entry/regime/value"][1, 1] == words.index("stick-slip")).mean()
        self.assertAlmostEqual(point["regimes"]["stick-slip"], share, delta=1e-15)
        self.assertAlmostEqual(sum(point["regimes"].values()), 1, delta=1e-15)

    def test_words_and_no_axis_at_all(self):
        _, printed = self.sweep("a.h5", "--vary", "effects.onset_convention.force=spring,spring-and-damper",
                                *QUICK)
        self.assertIn("spring-and-damper", printed)
        with h5py.File(self.folder / "a.h5") as sweep:
            axis = sweep["entry/axes/effects.onset_convention.force"]
            self.assertEqual(list(axis.attrs["words"]), ["spring", "spring-and-damper"])
        self.sweep("b.h5", "--repeat", 4, *QUICK)
        with h5py.File(self.folder / "b.h5") as sweep:
            self.assertEqual(sweep["entry/delta_mu/value"].shape, (4,))

    def test_many_points_are_a_map_and_not_a_roll(self):
        _, printed = self.sweep("a.h5", "--vary", f"{SPEED}=3 in/min:30 in/min:6", "--vary", "paper.mu_s=0.31:0.37:7",
                                "--duration", "3.2 s")
        self.assertLess(len(printed.splitlines()), 15)
        self.assertRegex(printed, r"(?m)^ +3 ( [SRMGU]){7}$")

    def test_progress_is_shown_on_a_terminal(self):
        shown, code, output = run_at_a_terminal([CLI, "sweep", SCENE, *QUICK, "--repeat", "3", "-o", self.folder / "a.h5"],
                                                timeout_s=TIMEOUT_S, stdout=subprocess.PIPE)
        self.assertEqual(code, 0)
        self.assertIn(b"3/3 runs, 0 s left", shown)
        self.assertTrue(shown.endswith(b"\r\x1b[K"), shown)
        self.assertNotIn(b"\x1b", output)


class Interrupted(Folder):
    def interrupted(self, name, options, which):
        """Starts a sweep and stops it when it has done a run. True unless it was over by then."""
        part = self.folder / f"{name}.part"
        with subprocess.Popen([str(o) for o in (CLI, "sweep", SCENE, "-o", self.folder / name, *options)],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            # Ends: either there are two lines soon, or the sweep is over.
            while process.poll() is None and not (part.exists() and part.read_bytes().count(b"\n") >= 2):
                time.sleep(0.001)
            process.send_signal(which)
            printed, message = process.communicate(timeout=TIMEOUT_S)
        if process.returncode == 0:
            (self.folder / name).unlink()
            return False
        self.assertEqual(process.returncode, 130, message)
        self.assertEqual(printed, "")
        self.assertFalse((self.folder / name).exists())
        self.assertIn("the same command goes on from there", message)
        self.assertIn(f"stopped after {len(part.read_bytes().splitlines()) - 1} of", message)
        return True

    def interrupted_sweep(self, name, which):
        """Options of a sweep that was stopped; longer ones where the machine was too fast to be caught."""
        for repeat in (20, 200, 2000):
            options = ("--vary", "paper.mu_s=0.32,0.36", "--repeat", repeat, "--threads", 2)
            if self.interrupted(name, options, which):
                return options
        self.fail("could not be stopped")

    def test_resumed_is_the_same_file_as_never_interrupted(self):
        options = self.interrupted_sweep("a.h5", signal.SIGINT)
        part = self.folder / "a.h5.part"
        kept = len(part.read_bytes().splitlines()) - 1
        self.assertGreaterEqual(kept, 1)
        with part.open("ab") as out:  # As if the power had failed.
            out.write(b'{"run": 7, "resu')
        file, printed = self.sweep("a.h5", *options)
        self.assertIn(f"({kept} of them done before)", printed)
        whole, _ = self.sweep("whole.h5", *options)
        with h5py.File(file) as one, h5py.File(whole) as other:
            compared = []

            def same(name, item):
                if isinstance(item, h5py.Dataset):
                    numpy.testing.assert_array_equal(item[()], other[name][()], name)
                    compared.append(name)

            one.visititems(same)
            self.assertGreater(len(compared), 100)
        self.assertEqual(file.read_bytes(), whole.read_bytes())

    def test_another_sweep_does_not_go_on_with_it(self):
        options = self.interrupted_sweep("a.h5", signal.SIGTERM)
        before = (self.folder / "a.h5.part").read_bytes()
        for more, expected in [(("--seed", 99), "seed is 3 there and 99 here"),
                               (("--set", "paper.mu_k=0.29"), "the scene's text, with its changes, is another"),
                               (("--vary", "tester.load_cell_gain=2 N/V,3 N/V"), "vary is ")]:
            done = run(CLI, "sweep", SCENE, "-o", self.folder / "a.h5", *options, *more)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"a.h5.part: stands there, but {expected}", done.stderr)
            self.assertIn("remove it, or choose another -o", done.stderr)
            self.assertEqual((self.folder / "a.h5.part").read_bytes(), before)


class Refusals(Folder):
    def test_wrong_options_are_named_and_leave_nothing(self):
        for expected, *options in [
            ("--vary paper.mu_s: needs a key and values", "--vary", "paper.mu_s"),
            ("--vary paper.mu=0.3: ", "--vary", "paper.mu=0.3:0.4:3"),
            # The whole grid is looked at before the work.
            ("--vary paper.mu_s=0.2: paper.mu_s = 0.2: must not be below mu_k", "--vary", "paper.mu_s=0.4:0.2:3"),
            (f"--vary {SPEED}=12: ", "--vary", f"{SPEED}=12,13"),
            ("--repeat 0: must be a whole number from 1 to 1000000", "--repeat", "0"),
            ("--repeat 2.5: ", "--repeat", "2.5"),
            ("--threads 0: must be a whole number from 1 to 256", "--threads", "0"),
            ("--seed -1: ", "--seed", "-1"),
            ("--set paper.mu_s: ", "--set", "paper.mu_s"),
            ("scene ", "--duration", "20000 h"),
        ]:
            with self.subTest(options):
                done = run(CLI, "sweep", SCENE, "-o", self.folder / "a.h5", *options)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(done.stdout, "")
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertTrue(done.stderr.startswith(f"stickslip: {expected}"), done.stderr)
                self.assertEqual(sorted(self.folder.iterdir()), [])

    def test_a_file_that_stands_there_is_left_alone(self):
        taken = self.folder / "a.h5"
        taken.write_text("mine")
        done = run(CLI, "sweep", SCENE, "-o", taken)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{taken}: exists already", done.stderr)
        self.assertEqual(taken.read_text(), "mine")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

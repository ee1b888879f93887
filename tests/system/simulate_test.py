#!/usr/bin/env python3
"""`stickslip simulate` and `stickslip scenes` from outside.

simulate_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
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
from stored import told
from terminal import run_at_a_terminal

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
DAEMON = BUILD / "bin" / "stickslipd"
CLI = BUILD / "bin" / "stickslip"
SCENES = SOURCE / "config" / "scenes"
SCENE = "stick-slip-at-12-in-per-min"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600


def run(*arguments, cwd=None):
    return subprocess.run([str(a) for a in arguments], cwd=cwd, capture_output=True, text=True,
                          timeout=TIMEOUT_S, check=False)


def text(record, name):
    return record[name][()].decode()


class Folder(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.count = 0

    def simulate(self, *options, scene=SCENE):
        """The record, open, and what was printed."""
        self.count += 1
        file = self.folder / f"{self.count}.h5"
        done = run(CLI, "simulate", scene, "-o", file, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")  # No progress where there is no terminal.
        record = h5py.File(file)
        self.addCleanup(record.close)
        return record, done.stdout

    def sha256(self, *options, scene=SCENE):
        return text(self.simulate(*options, scene=scene)[0], "entry/process/sha256")


class Simulate(Folder):
    def test_record_printed_results_and_later_analysis_have_the_same_bits(self):
        record, printed = self.simulate("--json")
        printed = told(json.loads(printed))
        analysed = run(CLI, "analyze", "--json", record.filename)
        self.assertEqual(analysed.returncode, 0, analysed.stderr)
        again = told(json.loads(analysed.stdout)["tests"][0])
        compared = 0
        for name, stored in stored_in(record).items():
            if name not in again or not hasattr(stored, "shape") or stored.dtype.kind != "f":
                continue
            self.assertEqual(printed[name], again[name], name)
            if again[name] is None:
                self.assertIn("reason", stored.attrs, name)
            else:
                self.assertEqual(float(stored[()]), again[name], name)
                compared += 1
        self.assertGreater(compared, 10)
        self.assertEqual(printed["details"], again["details"])
        self.assertEqual(printed["regime"], "stick-slip")

    def test_a_repetition_that_the_daemon_played_is_repeated_by_its_seed(self):
        config = self.folder / "test.toml"
        config.write_text(f"""
[board]
driver = "simulated"
clock_speed = 50
[board.simulated]
scenes = ["{SCENES / SCENE}.toml"]
[record]
folder = "records"
""", encoding="utf-8")
        done = run(DAEMON, "--config", config, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        [file] = (self.folder / "records").glob("*.h5")
        with h5py.File(file) as live:
            seed = live["entry/truth/seed"][()]
            whole, _ = self.simulate("--seed", seed)
            scans = live["entry/raw/scan"][()]
            self.assertLess(len(scans), len(whole["entry/raw/scan"]))
            numpy.testing.assert_array_equal(live["entry/raw/counts"][()], whole["entry/raw/counts"][()][scans])
            self.assertEqual(set(live["entry/truth"]), set(whole["entry/truth"]))
            for name, stored in live["entry/truth"].items():
                if isinstance(stored, h5py.Dataset) and name != "coefficient":
                    self.assertEqual(stored[()], whole["entry/truth"][name][()], name)
            # The noise-free force to the last bit, although the daemon finds it again after the test.
            numpy.testing.assert_array_equal(live["entry/truth/coefficient"][()],
                                             whole["entry/truth/coefficient"][()][scans])
            for name in ("method", "accuracy", "accuracy_asked"):
                self.assertEqual(live["entry/truth/solver"][name][()], whole["entry/truth/solver"][name][()])
            self.assertNotIn("time_per_scan", live["entry/truth/solver"])
            for group in ("entry/instrument/tester", "entry/instrument/adc", "entry/instrument/calibration"):
                self.assertEqual(set(live[group]), set(whole[group]))
                for name, stored in live[group].items():
                    numpy.testing.assert_array_equal(stored[()], whole[group][name][()], err_msg=name)

    def test_scans_that_do_not_arrive_are_gaps(self):
        record, _ = self.simulate("--json", scene="clock-and-missing-scans")
        scans = record["entry/raw/scan"][()]
        jumps = numpy.flatnonzero(numpy.diff(scans) > 1)
        self.assertGreater(len(jumps), 0)
        self.assertEqual(len(scans), len(record["entry/raw/counts"]))
        numpy.testing.assert_array_equal(record["entry/gaps/first_scan"][()], scans[jumps] + 1)
        numpy.testing.assert_array_equal(record["entry/gaps/scan_count"][()], numpy.diff(scans)[jumps] - 1)
        self.assertEqual(record["entry/results/gap_count"][()], len(jumps))

    def test_noise_free_force_is_what_the_noise_is_added_to(self):
        for scene in (SCENE, "clock-and-missing-scans", "load-cell-and-anti-alias-filter"):
            record, _ = self.simulate(scene=scene)
            true = record["entry/truth/coefficient"]
            self.assertEqual(len(true), len(record["entry/raw/scan"]))
            self.assertEqual(true.attrs["units"], "1")
            self.assertIn("[1]", true.attrs["long_name"])
            self.assertEqual(true.dims[0][0], record["entry/raw/time"])
            self.assertTrue(numpy.isfinite(true[()]).all())
            if scene.startswith("load-cell"):
                continue  # The converter sees what the load cell makes of it.
            weight_N = record["entry/instrument/tester/sled_mass"][()] * record["entry/instrument/tester/gravity"][()]
            noise = record["entry/raw/force"][()] / weight_N - true[()]
            # White noise of 0.001: the standard deviation of n ≥ 2800 is known to 1/√(2n) = 1.4 %, the mean to 2 %.
            self.assertAlmostEqual(noise.std(), 0.001, delta=5 * 0.014 * 0.001)
            self.assertAlmostEqual(noise.mean(), 0.0, delta=5 * 0.02 * 0.001)

    def test_solver_facts_are_numbers(self):
        record, printed = self.simulate("--set", "accuracy=1e-5")
        solver = record["entry/truth/solver"]
        self.assertEqual(text(record, "entry/truth/solver/method"), "exact closed forms")
        self.assertEqual(solver["accuracy_asked"][()], 1e-5)
        self.assertLess(solver["accuracy"][()], 1e-14)
        self.assertGreater(solver["time_per_scan"][()], 0.0)
        self.assertEqual(solver["time_per_scan"].attrs["units"], "s")
        self.assertIn("(1e-05 asked)", printed)

    def peak_memory(self, *options, scene):
        """Bytes, of a process of its own."""
        code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL);"
                "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)")
        self.count += 1
        done = run(sys.executable, "-c", code, CLI, "simulate", scene, "-o", self.folder / f"{self.count}.h5", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return int(done.stdout)

    def memory_growth(self, scene, short, long):
        """Bytes by which the peak grows, and slips by which the record does."""
        if any(flag in str(CLI) for flag in ("asan", "tsan")):
            self.skipTest("a sanitizer has a memory of its own")
        memory, slips = [], []
        for duration in short, long:
            memory.append(self.peak_memory("--duration", duration, scene=scene))
            with h5py.File(self.folder / f"{self.count}.h5") as record:
                slips.append(len(record["entry/cycles/cycle"]))
        return memory[1] - memory[0], slips[1] - slips[0]

    # Both begin where the columns of scans have filled the blocks that stay in memory: 4 of 65536 scans, 12.5 min.

    def test_memory_does_not_grow_with_the_scans(self):
        # A ring-down has a handful of slips, however long it is pulled. One number of each scan would be 8 bytes, one
        # flag 1; what is seen is half of one, in HDF5's own caches, and another half: the 32 bytes that say where each entry of 64
        # scans stands in the journal. One flag more would be 2.
        growth, slips = self.memory_growth("ring-down-at-12-in-per-min", "13 min", "2 h")
        self.assertLess(slips, 10)
        self.assertLess(growth / (107 * 60 * 350), 1.5)

    def test_memory_does_not_grow_with_the_slips(self):
        # What a section needs is there from the start. A column of one number a slip still fills its 4 blocks of half
        # a megabyte, a median sorts half a megabyte at most, and allocators and HDF5 vary by some more: 8 MB in all.
        # A slip of the fit, 700 bytes, would be 19 MB if each were kept.
        growth, slips = self.memory_growth("velocity-at-3-in-per-min", "13 min", "40 min")
        self.assertGreater(slips, 27_000)
        self.assertLess(growth, 8e6)

    def test_seed_decides_the_bits(self):
        self.assertEqual(self.sha256("--seed", 7), self.sha256("--seed", 7))
        self.assertNotEqual(self.sha256("--seed", 7), self.sha256("--seed", 8))
        # Without noise there is nothing random.
        self.assertEqual(self.sha256("--seed", 7, "--without", "white_noise"),
                         self.sha256("--seed", 8, "--without", "white_noise"))
        # Not given, it is the scene's.
        self.assertEqual(self.sha256(), self.sha256("--seed", 3))

    def test_set_changes_truth_and_numbers_and_nothing_else(self):
        plain, _ = self.simulate()
        changed, _ = self.simulate("--set", "paper.mu_s=0.34", "--set", "effects.white_noise.sd=0.002")
        self.assertEqual(plain["entry/truth/mu_s"][()], 0.35)
        self.assertEqual(changed["entry/truth/mu_s"][()], 0.34)
        self.assertEqual(changed["entry/truth/mu_k"][()], plain["entry/truth/mu_k"][()])
        self.assertNotEqual(text(changed, "entry/process/sha256"), text(plain, "entry/process/sha256"))
        # Measured: S to a tenth of the change; the noise is idle for 0.5 s, 175 scans, so known to 1/√350 = 5 %.
        self.assertAlmostEqual(changed["entry/results/mu_s"][()], 0.34, delta=0.001)
        weight_N = 2.331 * 9.80665
        idle = changed["entry/raw/force"][:170].std() / weight_N
        self.assertAlmostEqual(idle, 0.002, delta=5 * 0.05 * 0.002)

    def test_the_record_alone_repeats_itself(self):
        record, _ = self.simulate("--set", "paper.mu_s=0.34", "--duration", "6 s", "--rate", "2 kHz", "--seed", 9)
        scene = self.folder / "again.toml"
        scene.write_text(text(record, "entry/truth/scene_text"), encoding="utf-8")
        self.assertEqual(self.sha256("--seed", record["entry/truth/seed"][()], scene=scene),
                         text(record, "entry/process/sha256"))

    def test_duration_and_rate_decide_the_number_of_scans(self):
        record, printed = self.simulate("--duration", "20 s", "--rate", "1 kHz")
        self.assertEqual(len(record["entry/raw/counts"]), 20_000)
        self.assertEqual(record["entry/timing/scan_rate_granted"][()], 1000.0)
        self.assertIn("20000 scans, 20 s at 1000 Hz", printed)

    def test_method_extent_and_time_stand_in_terminal_and_record(self):
        record, printed = self.simulate()
        summary = text(record, "entry/process/simulation")
        self.assertEqual(printed.splitlines()[-1], summary)
        for part in ("2800 scans", "8 s at 350 Hz", "ns a scan", "exact closed forms"):
            self.assertIn(part, summary)
        self.assertEqual(text(record, "entry/process/program"), "stickslip simulate")
        self.assertEqual(text(record, "entry/process/configuration"),
                         f"stickslip simulate {SCENE} -o {record.filename}")

    def test_progress_is_shown_on_a_terminal(self):
        shown, code, output = run_at_a_terminal([CLI, "simulate", SCENE, "-o", self.folder / "x.h5"],
                                                timeout_s=TIMEOUT_S, stdout=subprocess.PIPE)
        self.assertEqual(code, 0)
        self.assertIn(b"100 %", shown)
        self.assertTrue(shown.endswith(b"\r\x1b[K"), shown)
        self.assertNotIn(b"\x1b", output)


class Interrupted(Folder):
    def begun(self, file):
        """Simulates a day, of which some is in the journal."""
        process = subprocess.Popen([CLI, "simulate", SCENE, "-o", file, "--duration", "24 h"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + TIMEOUT_S
        while not any(journal.stat().st_size > 100_000 for journal in self.folder.glob("*.journal")):
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.001)
        return process

    def test_ctrl_c_leaves_nothing(self):
        process = self.begun(self.folder / "a.h5")
        process.send_signal(signal.SIGINT)
        printed, message = process.communicate(timeout=TIMEOUT_S)
        self.assertEqual((process.returncode, printed, message), (130, "", "stickslip: interrupted: no file was made\n"))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_what_a_kill_leaves_behind_does_not_block_the_same_command(self):
        file = self.folder / "a.h5"
        process = self.begun(file)
        process.kill()
        process.communicate(timeout=TIMEOUT_S)
        done = run(CLI, "simulate", SCENE, "-o", file)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Terminal(unittest.TestCase):
    """What the tests at a terminal rest on."""

    def test_more_than_a_pipe_and_a_terminal_hold_is_read_from_both(self):
        size = 1 << 20  # A pipe holds 64 kB.
        program = f"import sys; sys.stdout.write('x' * {size}); sys.stderr.write('y' * {size}); sys.stdout.write('z')"
        shown, code, output = run_at_a_terminal([sys.executable, "-c", program], timeout_s=TIMEOUT_S, stdout=subprocess.PIPE)
        self.assertEqual((code, len(shown), len(output)), (0, size, size + 1))

    def test_a_program_that_does_not_end_is_killed(self):
        with self.assertRaises(subprocess.TimeoutExpired):
            run_at_a_terminal(["sleep", "1000"], timeout_s=0.2)


class Scenes(Folder):
    def test_all_shipped_scenes_are_listed_and_run_by_their_names(self):
        listed = run(CLI, "scenes")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        names = [line.split()[0] for line in listed.stdout.splitlines()]
        self.assertEqual(names, sorted(file.stem for file in SCENES.glob("*.toml")))
        for line in listed.stdout.splitlines():
            self.assertGreater(len(line.split()), 2)  # A description.
        described = json.loads(run(CLI, "scenes", "--json").stdout)
        self.assertEqual([scene["name"] for scene in described["scenes"]], names)
        for name in names:
            record, _ = self.simulate(scene=name)
            self.assertEqual(text(record, "entry/truth/scene_name"), name)

    def test_another_folder_has_other_scenes(self):
        (self.folder / "mine.toml").write_bytes((SCENES / f"{SCENE}.toml").read_bytes())
        listed = run(CLI, "scenes", "--folder", self.folder)
        self.assertEqual([line.split()[0] for line in listed.stdout.splitlines()], ["mine"])
        self.assertEqual(self.sha256("--folder", self.folder, scene="mine"), self.sha256())


class Refusals(Folder):
    def refused(self, status, expected, *options, scene=SCENE, output=None):
        before = sorted(self.folder.rglob("*"))
        done = run(CLI, "simulate", scene, "-o", output or self.folder / "x.h5", *options)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertTrue(done.stderr.startswith(f"stickslip: {expected}"), done.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_wrong_options_are_named_and_leave_nothing(self):
        for expected, *options in [
            ("--set paper.mu=3: ", "--set", "paper.mu=3"),
            ("--set paper.mu_s=0.1: ", "--set", "paper.mu_s=0.1"),
            ("--set paper.mu_s: ", "--set", "paper.mu_s"),
            ("--set effects.whit_noise.sd=1: ", "--set", "effects.whit_noise.sd=1"),
            ("--set scan_rate=350: ", "--set", "scan_rate=350"),
            ("--without noise: ", "--without", "noise"),
            ("--duration 3 s: ", "--duration", "3 s"),
            ("--duration: ", "--duration", "long"),
            ("--rate: ", "--rate", "0 Hz"),
            ("--rate 2 MHz: ", "--rate", "2 MHz"),
            ("--seed -1: ", "--seed", "-1"),
            ("--seed 1.5: ", "--seed", "1.5"),
        ]:
            with self.subTest(options):
                self.refused(2, expected, *options)
        done = run(CLI, "simulate", SCENE, "-o", self.folder / "x.h5", "--set", "paper.mu_k=0.5")
        self.assertEqual(done.returncode, 2)
        self.assertIn("(with --set paper.mu_k=0.5)", done.stderr)

    def test_a_number_alone_is_read_in_the_unit_of_before_with_a_warning(self):
        """Version 0.1 took a duration in s and a rate in Hz."""
        told = []
        for options in (("--duration", "5", "--rate", "500"), ("--duration", "5 s", "--rate", "500 Hz")):
            done = run(CLI, "simulate", SCENE, "-o", self.folder / f"alone{len(told)}.h5", "--json", *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            told.append((done.stderr, json.loads(done.stdout)))
        self.assertIn('warning: --duration: "5": a time needs its unit; it is read as "5 s"', told[0][0])
        self.assertIn('warning: --rate: "500": a frequency needs its unit; it is read as "500 Hz"', told[0][0])
        self.assertNotIn("warning", told[1][0])
        with h5py.File(self.folder / "alone0.h5") as one, h5py.File(self.folder / "alone1.h5") as other:
            self.assertTrue((one["entry/raw/force"][()] == other["entry/raw/force"][()]).all())

    def test_wrong_scenes_and_files_are_named(self):
        self.refused(2, "stick-slip-at-12-in-per-mi: is neither a file nor a scene in", scene=SCENE[:-1])
        self.refused(2, "absent.toml: there is no such file", scene="absent.toml")
        self.refused(2, f"{self.folder}: is a folder", scene=self.folder)
        self.refused(2, "--folder ", "--folder", self.folder / "absent", scene="mine")
        self.refused(2, f"scene {SCENE}: ", "--duration", "20000 h")
        nowhere = self.folder / "absent" / "x.h5"
        self.refused(2, f"{nowhere}: there is no folder", output=nowhere)
        taken = self.folder / "taken.h5"
        taken.write_text("mine")
        self.refused(2, f"{taken}: exists already", output=taken)
        self.assertEqual(taken.read_text(), "mine")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""`stickslip characterise` and `stickslip analyze --tester` from outside.

characterise_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import math
import pathlib
import shlex
import subprocess
import sys
import tempfile
import tomllib
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600
SCENE = SOURCE / "config" / "scenes" / "ring-down-at-12-in-per-min.toml"


def run(*arguments, cwd=None):
    return subprocess.run([str(a) for a in arguments], cwd=cwd, capture_output=True, text=True,
                          timeout=TIMEOUT_S, check=False)


class Characterise(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.ring_downs = []
        for seed in (1, 2, 3):
            cls.ring_downs.append(cls.simulate("ring-down-at-12-in-per-min", f"ring-down-{seed}.h5", "--seed", seed))
        cls.pull = cls.simulate("stick-slip-at-12-in-per-min", "pull.h5", "--seed", 7)
        # Another spring: ω is 2 % higher, many standard errors.
        cls.changed = cls.simulate("stick-slip-at-12-in-per-min", "changed.h5", "--seed", 8,
                                   "--set", "tester.frequency=20.4 Hz")
        cls.tester = cls.folder / "tester.toml"
        done = run(CLI, "characterise", *cls.ring_downs, "-o", cls.tester, "--json")
        assert done.returncode == 0, done.stderr
        cls.json = json.loads(done.stdout)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def simulate(cls, scene, name, *options):
        file = cls.folder / name
        done = run(CLI, "simulate", scene, "-o", file, *options)
        assert done.returncode == 0, done.stderr
        return file

    def test_the_file_holds_the_tester_of_the_scenes(self):
        kept = tomllib.loads(self.tester.read_text())["tester"]
        self.assertEqual(kept["ring_downs"], 3)
        omega = float(kept["omega"].removesuffix(" rad/s"))
        error = float(kept["omega_standard_error"].removesuffix(" rad/s"))
        self.assertLess(abs(omega - 125.66370614), 5 * error)
        self.assertLess(abs(kept["gamma_over_2omega"] - 0.022), 5 * kept["gamma_over_2omega_standard_error"])
        # Three ring-downs of some 1.5 s, each known to 0.5 % at best.
        self.assertLess(kept["gamma_over_2omega_standard_error"] / 0.022, 0.01)
        self.assertAlmostEqual(self.json["tester"]["omega"], omega, places=6)
        self.assertEqual(len(self.json["ring_downs"]), 3)

    def test_it_makes_s_minus_k_surer(self):
        alone = json.loads(run(CLI, "analyze", self.pull, "--json").stdout)["tests"][0]
        known = json.loads(run(CLI, "analyze", self.pull, "--tester", self.tester, "--json").stdout)["tests"][0]
        self.assertNotIn("tester_check", alone)
        self.assertTrue(known["tester_check"]["agrees"])
        self.assertEqual(known["tester_check"]["findings"], [])
        self.assertLess(abs(known["tester_check"]["pull_speed"] / 0.00508 - 1), 0.01)
        error = known["details"]["delta_mu"]["standard_error"]
        self.assertLess(error, alone["details"]["delta_mu"]["standard_error"] / 2)
        self.assertLess(abs(known["delta_mu"] - 0.05), 5 * error)

    def test_slips_drawn_again_scatter_as_the_standard_errors_say(self):
        told = lambda *options: run(CLI, "analyze", self.pull, "--bootstrap", 300, *options)
        test = json.loads(told("--json").stdout)["tests"][0]
        drawn = test["bootstrap"]
        self.assertGreaterEqual(drawn["converged"], 290)
        for name in ("mu_s", "mu_k", "delta_mu"):
            ratio = drawn[name]["standard_deviation"] / test["details"][name]["standard_error"]
            self.assertTrue(0.5 < ratio < 2, f"{name}: {ratio}")
            lowest, highest = drawn[name]["interval"]
            self.assertTrue(lowest < test[name] < highest, name)
        self.assertEqual(json.loads(told("--json").stdout)["tests"][0]["bootstrap"], drawn)
        self.assertNotEqual(json.loads(told("--json", "--seed", 2).stdout)["tests"][0]["bootstrap"], drawn)
        text = told().stdout
        self.assertIn("slips drawn again 300 times in blocks of", text)
        self.assertLessEqual(max(map(len, text.splitlines()[-5:])), 80)
        ring_down = run(CLI, "analyze", self.ring_downs[0], "--bootstrap", 300)
        self.assertIn("no bootstrap: 8 slips that count in the means are needed, the test has 1", ring_down.stdout)
        self.assertEqual(run(CLI, "analyze", self.pull, "--bootstrap", 99).returncode, 2)

    def tapped(self, name, frequency, rate):
        """A record of two taps on a cell of 5 % damping, by the closed form, with noise from a counter."""
        ring = lambda t: math.exp(-0.05 * math.tau * frequency * t) * math.sin(math.sqrt(1 - 0.05**2) * math.tau * frequency * t)
        rows = ["time_s,force_N"]
        for scan in range(int(2.5 * rate)):
            t = scan / rate
            noise = 0.01 * math.sin(12.9898 * scan * scan)
            rows.append(f"{t:.6f},{5 * sum(ring(t - begin) for begin in (0.7, 1.6) if t >= begin) + noise:.5f}")
        trace = self.folder / f"{name}.csv"
        trace.write_text("\n".join(rows))
        record = self.folder / f"{name}.h5"
        done = run(CLI, "import", trace, "--column", "force_N", "--sled-mass", "2331 g", "-o", record)
        self.assertEqual(done.returncode, 0, done.stderr)
        return record

    def test_taps_tell_the_load_cell_in_the_words_of_the_configuration(self):
        taps = self.tapped("taps", 120.0, 1000.0)
        found = json.loads(run(CLI, "characterise", "--tap", taps, "--json").stdout)
        self.assertEqual(len(found["taps"]), 2)
        for key, truth in (("load_cell_frequency", 120.0), ("load_cell_damping", 0.05)):
            self.assertLess(abs(found["tester"][key] - truth), 4 * found["tester"][key + "_standard_error"], key)
        text = run(CLI, "characterise", "--tap", taps).stdout
        self.assertRegex(text, r"a cell that swings at (880|879\.\d*|880\.\d*) Hz looks the same")
        # What it prints is accepted where it says.
        configured = next(line for line in text.splitlines() if "load_cell_frequency" in line)
        damping = next(line for line in text.splitlines() if "load_cell_damping = " in line)
        config = self.folder / "tapped.toml"
        config.write_text(f'[board]\ndriver = "simulated"\n[board.simulated]\nscenes = ["{SCENE}"]\n[tester]\n{configured}\n{damping}\n')
        checked = run(BUILD / "bin" / "stickslipd", "--check-config", config)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        options = shlex.split(next(line for line in text.splitlines() if line.startswith("or: "))[4:])
        analysed = run(CLI, "analyze", *options, self.pull, "--json")
        self.assertEqual(analysed.returncode, 0, analysed.stderr)

    def test_a_record_without_taps_is_refused_with_a_reason(self):
        still = self.folder / "still.csv"
        still.write_text("\n".join(["time_s,force_N"] + [f"{i / 350:.6f},{0.2 + 0.01 * math.sin(i * i):.5f}" for i in range(1000)]))
        record = self.folder / "still.h5"
        imported = run(CLI, "import", still, "--column", "force_N", "--sled-mass", "2331 g", "-o", record)
        self.assertEqual(imported.returncode, 0, imported.stderr)
        done = run(CLI, "characterise", "--tap", record)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no tap is found", done.stderr)

    def test_another_spring_is_a_finding(self):
        done = run(CLI, "analyze", self.changed, "--tester", self.tester)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the tester or the paper has changed since the characterisation", done.stdout)
        check = json.loads(run(CLI, "analyze", self.changed, "--tester", self.tester, "--json").stdout)
        self.assertFalse(check["tests"][0]["tester_check"]["agrees"])

    def test_refusals_leave_no_file(self):
        for files, word in (([self.pull], "stick-slip"), ([self.folder / "none.h5"], "none.h5")):
            output = self.folder / "refused.toml"
            done = run(CLI, "characterise", *files, "-o", output)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(word, done.stderr)
            self.assertFalse(output.exists())
        before = self.tester.read_text()
        self.assertEqual(run(CLI, "characterise", self.ring_downs[0], "-o", self.tester).returncode, 2)
        self.assertEqual(self.tester.read_text(), before)

    def test_a_test_that_was_measured_without_a_fit_is_fitted(self):
        (self.folder / "daemon.toml").write_text(
            '[board]\ndriver = "simulated"\nclock_speed = 100\n[board.simulated]\n'
            f'scenes = ["{SOURCE}/config/scenes/ring-down-at-12-in-per-min.toml"]\nrepeats = 1\n'
            '[analysis]\nestimator = "turning-points"\n[record]\nfolder = "cheap"\n', encoding="utf-8")
        done = run(BUILD / "bin" / "stickslipd", "--config", "daemon.toml", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        [file] = (self.folder / "cheap").glob("*.h5")
        [as_measured] = json.loads(run(CLI, "analyze", file, "--json").stdout)["tests"]
        self.assertEqual(as_measured["regime"], "ring-down")
        self.assertIsNone(as_measured["omega"])
        self.assertIn('"fit" does, also afterwards', run(CLI, "analyze", file, "--json").stdout.replace('\\"', '"'))
        [fitted] = json.loads(run(CLI, "analyze", file, "--estimator", "fit", "--json").stdout)["tests"]
        made = run(CLI, "characterise", file, "-o", self.folder / "cheap.toml", "--json")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertAlmostEqual(json.loads(made.stdout)["tester"]["omega"], fitted["omega"], places=6)
        # What was characterised can check a test by its fit alone.
        refused = run(CLI, "analyze", file, "--tester", self.tester)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("add --estimator fit", refused.stderr)
        checked = run(CLI, "analyze", file, "--tester", self.tester, "--estimator", "fit", "--json")
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertIsNotNone(json.loads(checked.stdout)["tests"][0]["tester_check"])

    def test_help_has_examples(self):
        self.assertIn("stickslip characterise ring-down-1.h5", run(CLI, "characterise", "--help").stdout)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""`stickslip law` from outside, over simulated records.

law_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SPEED = "effects.constant_speed.pull_speed"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)


class Law(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.ageing = [cls.simulate("contact-ageing", speed, 5) for speed in (1.5, 3, 6, 12)]
        cls.constant = [cls.simulate("stick-slip-at-12-in-per-min", speed, seed)
                        for speed in (1.5, 3, 6, 12) for seed in (1, 2)]
        cls.one_speed = [cls.ageing[2]] + [cls.simulate("contact-ageing", 6, seed) for seed in (6, 7, 8)]

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def simulate(cls, scene, speed, seed, *options):
        file = cls.folder / f"{scene}-{speed}-{seed}.h5"
        done = run(CLI, "simulate", scene, "-o", file, "--set", f"{SPEED}={speed} in/min", "--seed", seed, *options)
        assert done.returncode == 0, done.stderr
        return file

    def law(self, *arguments):
        done = run(CLI, "law", *arguments, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_ageing_is_named_with_its_beta(self):
        found = self.law(*self.ageing)
        self.assertEqual(found["law"], "ageing")
        self.assertEqual(found["not_ruled_out"], ["rate-and-state"])  # These are pulls alone.
        beta = found["parameters"]["beta"]
        # The scene has 0.02 log10(1 + t/1 ms): over its rests, from 17 to 180 ms, that is 0.0196 log10 t.
        self.assertLess(abs(beta["value"] - 0.0196), 4 * beta["standard_error"])
        self.assertLess(beta["standard_error"], 0.0005)
        self.assertLess(abs(found["parameters"]["mu_k"]["value"] - 0.3), 0.001)
        self.assertEqual(len(found["scores"]), 4)
        self.assertIsNone(found["next_pull"])
        for test in found["tests"]:
            self.assertLess(abs(test["mu_s"]["residual"]), 0.001)

    def test_constant_s_and_k_are_named(self):
        found = self.law(*self.constant)
        self.assertEqual(found["law"], "constant")
        self.assertLess(abs(found["parameters"]["mu_s"]["value"] - 0.35), 0.001)

    def test_one_speed_cannot_tell_and_a_far_one_is_named(self):
        found = self.law(*self.one_speed)
        self.assertIsNone(found["law"])
        self.assertIn("all tests for S on the stick time are at one speed", found["reasons"])
        apart = found["next_pull"]["pull_speed"] / (6 * 0.0254 / 60)
        self.assertGreaterEqual(max(apart, 1 / apart), 2.999)
        self.assertNotIn("pulls_needed", found["next_pull"])
        text = run(CLI, "law", *self.one_speed, "--slowest", "1 in/min").stdout
        self.assertIn("law: cannot be told from these tests", text)
        self.assertIn("next: a pull at 1 in/min would tell most about S", text)

    def test_terminal_has_eighty_columns(self):
        for files in (self.ageing, self.constant, self.one_speed):
            done = run(CLI, "law", *files)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(done.stdout)
            for line in done.stdout.splitlines():
                # Names of files may be long.
                if line.startswith("file of test") or (line.startswith("x  ") and "left out" in line):
                    continue
                self.assertLessEqual(len(line), 80, line)

    def test_a_void_test_is_left_out_with_the_reason(self):
        file = self.simulate("contact-ageing", 6, 9)
        voided = run(CLI, "void", file, "--reason", "paper torn")
        self.assertEqual(voided.returncode, 0, voided.stderr)
        found = self.law(*self.ageing, file)
        self.assertEqual(found["law"], "ageing")
        self.assertEqual([(out["what"], out["reason"]) for out in found["left_out"] if out["file"] == str(file)],
                         [("S and K", "void: paper torn")])

    def test_a_copy_and_a_ramp_are_left_out_with_the_reason(self):
        copy = self.folder / "copy.h5"
        copy.write_bytes(self.ageing[0].read_bytes())
        ramp = self.folder / "ramp.h5"
        self.assertEqual(run(CLI, "simulate", "speed-ramp", "-o", ramp).returncode, 0)
        found = self.law(*self.ageing, copy, ramp)
        self.assertEqual(found["law"], "ageing")
        reasons = {pathlib.Path(out["file"]).name: out["reason"] for out in found["left_out"] if out["what"] == "S and K"}
        self.assertIn("same scans", reasons["copy.h5"])
        self.assertIn("the pull speed changes", reasons["ramp.h5"])

    def test_one_sheet_with_holds_tells_beta(self):
        """The scene's plan tells the holds of the record; the same scans as a table show them by themselves."""
        planned = self.folder / "holds.h5"
        self.assertEqual(run(CLI, "simulate", "slide-hold-slide", "-o", planned).returncode, 0)
        table = self.folder / "holds.csv"
        table.write_text("time (s),force (N)\n" + "".join(
            f"{fields[0]},{fields[4]}\n" for fields in (line.split(",") for line in run(
                CLI, "export", planned, "--csv").stdout.splitlines() if line[0].isdigit())))
        shown = self.folder / "shown.h5"
        done = run(CLI, "import", table, "--column", "force (N)", "--sled-mass", "2331 g", "--speed", "3 in/min",
                   "-o", shown)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the belt stood still 4 times, for 1 to 30 s", done.stdout + done.stderr)
        for file in (planned, shown):
            found = self.law(file)
            self.assertEqual(found["leading_law"], "ageing")
            beta = found["parameters"]["beta"]
            self.assertLess(abs(beta["value"] - 0.02), 3 * beta["standard_error"])
            self.assertLess(beta["standard_error"], 0.001)
            # S of the test is that of the slips between the holds, after 85 ms; with the others it would be 0.393.
            results = json.loads(run(CLI, "show", file, "--json").stdout)["results"]
            self.assertLess(abs(results["mu_s"] - 0.3887), 0.001)
            rests = [test["stick_time"] for test in found["tests"]]
            for rest, hold in zip(rests[1:], (1, 3, 10, 30)):
                self.assertLess(abs(rest - hold), 0.12)  # With the rise after it.

    def test_slow_pulls_and_holds_tell_rate_and_state_friction(self):
        def section(scene, name):
            text = (SOURCE / "config" / "scenes" / f"{scene}.toml").read_text(encoding="utf-8")
            begin = text.index(f"[effects.{name}]")
            return text, text[begin:text.index("[effects.", begin + 1)]

        _, contact = section("rate-and-state-ageing", "rate_and_state")
        holds, ageing = section("slide-hold-slide", "contact_ageing")
        scene = self.folder / "holds-of-rate-and-state.toml"
        scene.write_text("accuracy = 1e-6\n" + holds.replace(ageing, contact), encoding="utf-8")
        sheet = self.folder / "sheet.h5"
        done = run(CLI, "simulate", scene, "-o", sheet)
        self.assertEqual(done.returncode, 0, done.stderr)
        pulls = [self.simulate("rate-and-state-ageing", speed, 1, "--set", f"effects.constant_speed.pull={8 / speed + 2} s")
                 for speed in (0.25, 0.5, 1, 2)]

        # Pulls alone tell b - a, as an S that rises with the time at rest: (0.025 - 0.010) ln 10 a decade.
        alone = self.law(*pulls)
        self.assertNotEqual(alone["leading_law"], "rate-and-state")
        self.assertLess(abs(alone["parameters"]["beta"]["value"] - 0.0345), 0.004)

        found = self.law(*pulls, sheet)
        self.assertEqual((found["law"], found["not_ruled_out"]), ("rate-and-state", []))
        for name, truth in (("a", 0.010), ("b", 0.025)):
            own = found["parameters"][name]
            error = math.hypot(own["standard_error"], own["systematic_uncertainty"])
            self.assertLess(abs(own["value"] - truth), 2 * error, name)
            self.assertLess(error, 0.5 * truth, name)
        slip = found["parameters"]["critical_slip"]
        self.assertLess(abs(math.log(slip["value"] / 2e-6)), math.log(slip["within_factor"]))
        for test in found["tests"]:
            self.assertLess(abs(test["mu_s"]["residual"]), 0.003)
        picture = self.folder / "rate-and-state.svg"
        done = run(CLI, "law", *pulls, sheet, "--plot", picture)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("law: rate-and-state: S depends on the time at rest and on the speed", done.stdout)
        self.assertIn("within a factor of", done.stdout)
        self.assertIn(">rate-and-state<", picture.read_text(encoding="utf-8"))

    def test_the_picture_is_made_once(self):
        picture = self.folder / "law.svg"
        self.assertEqual(run(CLI, "law", *self.ageing, "--plot", picture).returncode, 0)
        self.assertIn("Friction law: S depends on the time at rest", picture.read_text())
        again = run(CLI, "law", *self.ageing, "--plot", picture)
        self.assertEqual(again.returncode, 2)
        self.assertEqual(again.stdout, "")

    def test_what_cannot_be_is_refused(self):
        for options, said in ((("--slowest", "5 in/min", "--fastest", "3 in/min"), "is not below"),
                              (("--plot", "law.pdf"), ".svg or .png")):
            done = run(CLI, "law", *self.ageing, *options)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)
        self.assertEqual(run(CLI, "law").returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

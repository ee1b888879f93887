#!/usr/bin/env python3
"""`stickslip methods`, `report` and `compare` from outside.

report_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import csv
import io
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

import uncertain

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SPEED = "effects.constant_speed.pull_speed"
STICKS, RINGS = "stick-slip-at-12-in-per-min", "ring-down-at-12-in-per-min"
QUANTITIES = ["static_coefficient", "kinetic_coefficient", "mu_s", "mu_k", "delta_mu", "amplitude", "oscillation_frequency",
              "gamma_over_2omega"]

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600

# Upper 2.5 % points of Student's t: scipy.stats.t.ppf(0.975, [2, 4]).
T_2, T_4 = 4.302652729911275, 2.7764451051977987


def run(*arguments, cwd=None):
    return subprocess.run([str(a) for a in (CLI, *arguments)], capture_output=True, text=True, timeout=TIMEOUT_S,
                          check=False, cwd=cwd)


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)

    @classmethod
    def simulate(cls, name, scene, speed, seed, *options):
        done = run("simulate", scene, "-o", name, "--seed", seed, "--set", f"{SPEED}={speed}", "--duration", "5 s", *options,
                   cwd=cls.folder)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return name

    def good(self, *arguments):
        done = run(*arguments, cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def refused(self, status, message, *arguments):
        done = run(*arguments, cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (status, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(message, done.stderr)


class Methods(Folder):
    def test_the_shipped_ones_are_listed(self):
        lines = self.good("methods").splitlines()
        self.assertEqual([line.split()[0] for line in lines], ["astm-d1894", "iso-15359", "iso-8295", "penner-1995",
                                                               "slide-hold-slide", "speed-ramp", "tappi-t549"])
        listed = json.loads(self.good("methods", "--json"))["methods"]
        by_name = {method["name"]: method for method in listed}
        self.assertEqual(by_name["iso-8295"]["kinetic_travel"], [0, 0.06])
        self.assertEqual(by_name["penner-1995"]["kinetic_cycles"], 10)
        self.assertEqual([m["name"] for m in listed if not m["check"]], ["penner-1995", "slide-hold-slide", "speed-ramp"])

    def test_a_method_decides_the_traditional_numbers_and_stands_in_the_record(self):
        method = self.folder / "own.toml"
        method.write_text('name = "own"\ndescription = "short travel"\n[static]\nslip = 3\n'
                          '[kinetic]\ntravel_from = "2 mm"\ntravel_to = "8 mm"\n')
        self.simulate("own.h5", STICKS, "12 in/min", 4, "--method", method)
        self.simulate("plain.h5", STICKS, "12 in/min", 4)
        with h5py.File(self.folder / "own.h5") as own, h5py.File(self.folder / "plain.h5") as plain:
            self.assertEqual(own["entry/process/method"].asstr()[()], "own static_slip=3 kinetic_travel=0.002:0.008")
            self.assertEqual(plain["entry/process/method"].asstr()[()], "penner-1995 kinetic_cycles=10")
            numpy.testing.assert_array_equal(own["entry/raw/force"], plain["entry/raw/force"])
            for name in ("static_coefficient", "kinetic_coefficient"):
                found, truth = (own[f"entry/{group}/{name}"][()] for group in ("results", "truth"))
                self.assertNotEqual(found, plain[f"entry/results/{name}"][()])
                # White noise of 0.001 at a peak, the largest of three scans; beyond it less than a scan's share of
                # the window (413 scans) of the oscillation (0.08).
                self.assertAlmostEqual(found, truth, delta=0.004, msg=name)
            self.assertEqual(own["entry/results/mu_s"][()], plain["entry/results/mu_s"][()])
        again = json.loads(self.good("analyze", "plain.h5", "--method", "own.toml", "--json"))["tests"][0]
        first = json.loads(self.good("analyze", "own.h5", "--json"))["tests"][0]
        for name in QUANTITIES:
            self.assertEqual(again[name], first[name], name)

    def test_mistakes_are_one_line(self):
        self.refused(2, "--method iso-8259: is neither a file nor a method", "analyze", "x.h5", "--method", "iso-8259")
        bad = self.folder / "bad.toml"
        bad.write_text('name = "own"\ndescription = "x"\n[static]\nslip = 0\n')
        self.refused(2, "bad.toml:4: static.slip = 0: must be an integer from 1 to 1000", "simulate", STICKS, "-o", "no.h5",
                     "--method", "bad.toml")
        self.assertFalse((self.folder / "no.h5").exists())


class Reports(Folder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        speeds = ("6 in/min", "12 in/min")
        cls.a = [cls.simulate(f"a{v}-{i}.h5", STICKS, speed, 10 * v + i, "--set", f"paper.mu_s=0.35{i}")
                 for v, speed in enumerate(speeds) for i in range(5 if v else 3)]
        cls.b = [cls.simulate(f"b-{i}.h5", RINGS, "12 in/min", 50 + i) for i in range(3)]

    def values(self, files, name):
        values = []
        for file in files:
            with h5py.File(self.folder / file) as record:
                values.append(record[f"entry/results/{name}"][()])
        return numpy.array(values)

    def test_means_and_repeatability_are_those_of_numpy_over_the_records(self):
        report = json.loads(self.good("report", *self.a, "--json"))
        self.assertEqual([test["file"] for test in report["tests"]], self.a)
        self.assertEqual([group["tests"] for group in report["groups"]], [[0, 1, 2], [3, 4, 5, 6, 7]])
        numpy.testing.assert_allclose([group["pull_speed"] for group in report["groups"]], [0.00254, 0.00508])
        for group, t in zip(report["groups"], (T_2, T_4)):
            for name in QUANTITIES:
                own = group["quantities"][name]
                values = self.values([self.a[i] for i in group["tests"]], name)
                s = values.std(ddof=1)
                half = t * s / math.sqrt(len(values))
                self.assertEqual(own["count"], len(values))
                numpy.testing.assert_allclose(
                    [own["mean"], own["standard_deviation"], own["repeatability"], *own["confidence_interval"]],
                    [values.mean(), s, 2.8 * s, values.mean() - half, values.mean() + half], rtol=1e-9)
        pooled = math.sqrt(sum((n - 1) * g["quantities"]["mu_s"]["standard_deviation"] ** 2
                               for n, g in zip((3, 5), report["groups"])) / 6)
        self.assertAlmostEqual(report["pooled_standard_deviation"]["mu_s"], pooled, delta=1e-12)

    def test_a_test_reads_the_same_alone_and_among_others(self):
        alone = [json.loads(self.good("report", file, "--json"))["tests"][0] for file in (*self.a, *self.b)]
        self.assertEqual(json.loads(self.good("report", *self.a, *self.b, "--json"))["tests"], alone)
        thrice = json.loads(self.good("report", self.a[1], self.a[1], self.a[0], self.a[1], "--json"))["tests"]
        self.assertEqual([test["file"] for test in thrice], [self.a[i] for i in (1, 1, 0, 1)])
        for test, own in zip(thrice, (1, 1, 0, 1)):
            self.assertEqual(test["delta_mu"], alone[own]["delta_mu"])

    def test_s_minus_k_by_cycle_is_the_mean_of_all_slips_but_the_first_of_each_test(self):
        report = json.loads(self.good("report", *self.a, "--json"))
        text = self.good("report", *self.a)
        for group, t in zip(report["groups"], (T_2, T_4)):
            sums, counts, slips = [], [], []
            for test in group["tests"]:
                with h5py.File(self.folder / self.a[test]) as record:
                    own = record["entry/cycles/delta_mu"][1:]
                own = own[numpy.isfinite(own)]
                sums.append(own.sum())
                counts.append(len(own))
                slips.extend(own)
            n, mean = len(sums), sum(sums) / sum(counts)
            error = math.sqrt(n / (n - 1) * sum((s - mean * c) ** 2 for s, c in zip(sums, counts))) / sum(counts)
            pooled = group["delta_mu_by_cycle"]
            self.assertEqual((pooled["tests"], pooled["slips"], pooled["escaped"]), (n, len(slips), 0))
            numpy.testing.assert_allclose([pooled["value"], pooled["standard_error"], *pooled["confidence_interval"], pooled["scatter"]],
                                          [mean, error, mean - t * error, mean + t * error, numpy.std(slips, ddof=1)], rtol=1e-9)
            self.assertIn(f"S−K by cycle   {uncertain.text(mean, error, pooled['systematic_uncertainty'])}, 95 %", text)
        # B never stuck again: only its first slips have an S − K.
        compared = json.loads(self.good("compare", *self.a, "--against", *self.b, "--json"))
        self.assertIsNone(compared["comparisons"][1]["delta_mu_by_cycle"]["p"])
        self.assertIn("in B no slip after the first", compared["comparisons"][1]["delta_mu_by_cycle"]["reason"])

    LEADING = ("delta_mu", "mu_s", "mu_k", "static_coefficient", "kinetic_coefficient")

    def check_table(self, text, details):
        """The table of one test: each number, and below it its errors and the truth."""
        shown = [uncertain.parts(details[name]["value"], details[name].get("standard_error"), details[name].get("systematic_uncertainty"))
                 for name in self.LEADING]
        lines = text.splitlines()
        self.assertEqual(lines[0].split()[:7], ["test", "regime", "S−K", "S", "K", "static", "kinetic"])
        self.assertEqual(lines[1].split()[2:7], [parts[0] for parts in shown])
        self.assertEqual([line.split()[:2] for line in lines[2:5]], [["±", "stat."], ["±", "syst."], ["truth", "stick-slip"]])
        for line, part in ((lines[2], 1), (lines[3], 2)):
            self.assertEqual(line.split()[2:], [parts[part] for parts in shown if parts[part] is not None])
        self.assertLessEqual(max(len(line) for line in lines[:4]), 80)
        for legend in ("± stat.  standard error", "± syst.  systematic part"):
            self.assertEqual(sum(line.startswith(legend) for line in lines), 1)

    def test_people_are_shown_both_errors_of_the_main_results(self):
        self.simulate("both.h5", STICKS, "12 in/min", 21)
        # By turning points S - K has a systematic part: the whole correction for belt and damping.
        again = ("analyze", "both.h5", "--estimator", "turning-points")
        [test] = json.loads(self.good(*again, "--json"))["tests"]
        self.assertGreater(test["details"]["delta_mu"]["standard_error"], 0.0)
        self.assertGreater(test["details"]["delta_mu"]["systematic_uncertainty"], 0.0)
        self.check_table(self.good(*again), test["details"])

        # A report is about the numbers in the file: there 1 % of each coefficient is systematic.
        with h5py.File(self.folder / "both.h5", "r+") as record:
            for name in self.LEADING:
                result = record[f"entry/results/{name}"]
                result.attrs["systematic_uncertainty"] = 0.01 * result[()]
            misfit = record["entry/results/misfit"]
            misfit[()] = 3.25
            misfit.attrs.pop("reason", None)
            misfit.attrs["place"] = "peak"
            record["entry/results/rung"].attrs["reason"] = "the slope is not significant"
            rung = record["entry/results/rung"].asstr()[()]
        told = json.loads(self.good("report", "both.h5", "--json"))
        details, [group] = told["tests"][0]["details"], told["groups"]
        text = self.good("report", "both.h5")
        self.check_table(text.partition("\n\n")[2], details)  # Behind the form.
        listed = self.good("show", "both.h5")
        self.assertRegex(listed, rf"(?m)^rung: {rung}, the slope is not significant$")
        self.assertRegex(listed, r"(?m)^  misfit +3\.25.*, most at the peak$")
        for name in self.LEADING:
            own = details[name]
            self.assertEqual(own["systematic_uncertainty"], 0.01 * own["value"])
            errors = own.get("standard_error"), own["systematic_uncertainty"]
            self.assertIn(f"{uncertain.text(own['value'], *errors)}\n", re.sub(rf"^  {name} +", "", listed[listed.index(f"\n  {name} ") + 1:]))
        [row] = csv.DictReader(io.StringIO(self.good("report", "both.h5", "--csv", "-")))
        for name in QUANTITIES:
            for key in ("standard_error", "systematic_uncertainty"):
                in_csv = row[f"{name}_{key}"]
                self.assertEqual(None if in_csv == "" else float(in_csv), details[name].get(key), name)
            self.assertEqual(group["quantities"][name]["systematic_uncertainty"], details[name].get("systematic_uncertainty"))
        pooled, systematic = group["delta_mu_by_cycle"], details["delta_mu"]["systematic_uncertainty"]
        self.assertEqual(pooled["systematic_uncertainty"], systematic)
        self.assertEqual(float(row["at_speed_delta_mu_by_cycle_systematic_uncertainty"]), systematic)
        self.assertIn(f"S−K by cycle   {uncertain.text(pooled['value'], None, systematic)}: ", text)
        # Nobody named the parts of what was written here.
        self.assertRegex(listed, r"(?m)^systematic, not split +B ")
        self.assertIn("!  systematic, not split: of an older version", listed)

    def test_a_budget_holds_the_errors_that_are_shown(self):
        report = json.loads(self.good("report", *self.a, "--json"))
        text = self.good("report", *self.a)
        self.assertEqual(text.count("\nuncertainty budget of these means\n"), len(report["groups"]))
        self.assertLessEqual(max(len(line) for line in text[text.index("uncertainty budget"):].splitlines() if line.startswith(("noise", "model"))), 80)
        words = " ".join(text.split())
        for group in report["groups"]:
            pooled, budget = group["delta_mu_by_cycle"], group["budgets"]["delta_mu"]
            self.assertEqual(budget["value"], pooled["value"])
            combined = math.hypot(pooled["standard_error"], pooled["systematic_uncertainty"])
            self.assertAlmostEqual(budget["combined_standard_uncertainty"], combined, delta=1e-9 * combined)
            for name in ("delta_mu", "static_coefficient", "kinetic_coefficient"):
                own = group["budgets"][name]
                self.assertEqual(own["expanded_uncertainty"], 2.0 * own["combined_standard_uncertainty"])
                self.assertAlmostEqual(sum(line["share"] or 0.0 for line in own["lines"]), 1.0, delta=1e-9)
                self.assertIn(own["statement"], words)
        # One test: its own errors.
        [test] = json.loads(self.good("report", self.a[0], "--json"))["tests"]
        errors, own = test["details"]["delta_mu"], test["budgets"]["delta_mu"]
        self.assertAlmostEqual(own["combined_standard_uncertainty"], math.hypot(errors["standard_error"], errors["systematic_uncertainty"]), delta=1e-12)
        self.assertIn(own["statement"], " ".join(self.good("show", self.a[0]).split()))
        with h5py.File(self.folder / self.a[0]) as record:
            part = record["entry/results/delta_mu"].attrs["systematic_uncertainty_damping"]
        self.assertEqual([line["standard_uncertainty"] for line in own["lines"] if line["source"] == "damping"], [part])
        self.assertEqual(errors["systematic_parts"]["damping"], part)

    def test_what_is_kept_is_said_and_shown_side_by_side(self):
        shown = json.loads(self.good("analyze", self.a[0], "--effects", "--json"))["tests"][0]
        self.assertEqual([effect["kept"] for effect in shown["effects"]], ["", "spikes", "drift", "first-slip"])
        self.assertEqual(shown["effects"][0]["delta_mu"], shown["delta_mu"])
        for effect in shown["effects"][1:]:
            kept = json.loads(self.good("analyze", self.a[0], "--keep", effect["kept"], "--json"))["tests"][0]
            self.assertEqual(kept["delta_mu"], effect["delta_mu"])
        text = self.good("analyze", self.a[0], "--effects")
        for words in ("all taken care of", "spikes kept", "drift kept", "first-slip kept"):
            self.assertIn(words, text)
        self.refused(2, '--keep hum: must be "spikes", "drift" or "first-slip", or "nothing" alone', "analyze", self.a[0], "--keep", "hum")

    def test_text_shows_the_same_numbers(self):
        report = json.loads(self.good("report", *self.a, "--json"))
        text = self.good("report", *self.a)
        for group in report["groups"]:
            own = group["quantities"]["static_coefficient"]
            half = own["confidence_interval"][1] - own["mean"]
            decimals = uncertain.decimals_for(half, 4)
            self.assertIn(f"{own['mean']:.{decimals}f} ± {half:.{decimals}f}", text)
            self.assertIn(f"{own['repeatability']:.{uncertain.decimals_for(own['repeatability'], 4)}f}", text)
        self.assertIn("group 2: 12 in/min, stick-slip, 5 tests", text)
        self.assertIn("k = 4.30 for n = 3, 2.78 for n = 5", text)
        self.assertIn("static µs: ISO 8295 µS; kinetic (dynamic) µk\nmodel quantities: S, K, S−K", text)

    def test_text_is_the_same_whichever_other_forms_are_asked_for(self):
        records = [self.simulate(f"form-{scene}.h5", scene, "12 in/min", 5, *options) for scene, *options in (
            (STICKS,), (RINGS,), ("contact-ageing",), ("rate-and-state-ageing",), ("too-few-scans",), ("slack",),
            ("threshold-oscillation",), ("stribeck", "--set", "effects.white_noise.sd=0.2"))]
        for scene in ("slide-hold-slide", "speed-ramp"):
            self.good("simulate", scene, "-o", f"form-{scene}.h5")
            records.append(f"form-{scene}.h5")
        for words in (["report", *records], *(["report", record] for record in records),
                      ["report", *records, "--pool", "grades,regimes"], ["compare", *records[:5], "--", *records[5:]]):
            with self.subTest(words):
                text = self.good(*words)
                beside = self.good(*words[:1], "--csv", "form.csv", *words[1:])
                (self.folder / "form.csv").unlink()
                self.assertEqual(beside, text)

    def test_means_fit_a_terminal_of_80_columns(self):
        text = self.good("report", *self.a, *self.b)
        means = text[text.index("Means, ± half"):].splitlines()
        self.assertGreater(len(means), 30)
        self.assertIn("± syst.", "".join(means))
        self.assertEqual([line for line in means if len(line) > 80], [])

    def test_it_opens_with_the_form_and_invents_nothing(self):
        lines = self.good("report", *self.a).splitlines()
        opens = dict((line[:17].strip(), line[17:]) for line in lines[:lines.index("")])
        self.assertEqual(list(opens), ["date", "sample", "grade", "lot", "direction, side", "conditioning", "climate", "method", "sled", "contact time", "pull speed", "n", "operator",
                                       "instrument", "calibration", "program", "verdict"])
        for fact in ("date", "sample", "grade", "lot", "direction, side", "conditioning", "climate", "contact time", "operator"):
            self.assertEqual(opens[fact], "–", fact)
        self.assertEqual(opens["pull speed"], "2 speeds: 6 in/min; 12 in/min")
        self.assertEqual((opens["sled"], opens["n"], opens["verdict"]), ("2331 g", "8", "no limits were stated"))
        self.assertRegex(opens["calibration"], r"^\d+ N/V, date not stated$")
        self.assertRegex(opens["program"], r"^stickslip simulate \d+\.\d+\.\d+")
        form = {line["name"]: line for line in json.loads(self.good("report", *self.a, "--json"))["form"]}
        self.assertEqual(form["operator"], {"name": "operator", "label": "operator", "values": [], "not_stated": 8, "text": "–"})
        self.assertEqual(form["speed"]["values"], ["6 in/min", "12 in/min"])

    def test_grades_and_regimes_are_averaged_only_if_asked(self):
        files = [*self.a[3:], *self.b]
        def groups(*options):
            return [(group["regimes"], len(group["tests"])) for group in json.loads(self.good("report", *files, *options, "--json"))["groups"]]
        self.assertEqual(groups(), [(["stick-slip"], 5), (["ring-down"], 3)])
        self.assertEqual(groups("--pool", "grades"), groups())
        self.assertEqual(groups("--pool", "regimes"), [(["stick-slip", "ring-down"], 8)])
        text = self.good("report", *files)
        self.assertIn("group 1: 12 in/min, stick-slip, 5 tests", text)
        self.assertIn("group 2: 12 in/min, ring-down, 3 tests", text)
        self.assertIn("Regimes at one speed are not averaged; --pool regimes does", text)
        self.assertNotIn("not averaged", self.good("report", *files, "--pool", "regimes"))
        self.refused(2, '--pool "all": must be grades, regimes or grades,regimes', "report", *files, "--pool", "all")

    def test_csv_has_one_line_for_each_test_and_no_quoting_goes_wrong(self):
        odd = 'odd, "name".h5'
        (self.folder / odd).write_bytes((self.folder / self.a[0]).read_bytes())
        self.good("report", odd, *self.a, "--csv", "tests.csv")
        with (self.folder / "tests.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["file"] for row in rows], [odd, *self.a])
        numpy.testing.assert_array_equal([float(row["mu_s"]) for row in rows[1:]], self.values(self.a, "mu_s"))
        self.assertEqual(rows[1]["scan_rate_measured"], "")
        self.assertIn("scan_rate_measured: no clock readings", rows[1]["absent"])
        for name in ("date", "sample", "grade", "operator", "batch"):
            self.assertEqual(rows[1][name], "")
        details = json.loads(self.good("report", self.a[0], "--json"))["tests"][0]["details"]
        results = [name for name in rows[1] if name in details and name not in ("regime", "rung")]
        self.assertGreater(len(results), 20)
        for name in results:
            found = rows[1][f"{name}_standard_error"]
            self.assertEqual(None if found == "" else float(found), details[name].get("standard_error"), name)

    def test_compare_is_welchs_test_over_the_records(self):
        comparison = json.loads(self.good("compare", *self.a, "--", *self.b, "--json", "--csv", "c.csv", "--label-b", "Thorold"))
        self.assertEqual(comparison["b"]["label"], "Thorold")
        slow, fast = comparison["comparisons"]
        self.assertEqual({own["reason"] for own in slow["quantities"].values()}, {"no test of B at this speed"})
        for name in QUANTITIES:
            own = fast["quantities"][name]
            a, b = self.values(self.a[3:], name), self.values(self.b, name)
            error = math.sqrt(a.var(ddof=1) / 5 + b.var(ddof=1) / 3)
            numpy.testing.assert_allclose([own["difference"], own["t"]], [a.mean() - b.mean(), (a.mean() - b.mean()) / error],
                                          rtol=1e-6)
        self.assertLess(fast["quantities"]["delta_mu"]["p"], 1e-4)
        self.assertEqual(fast["quantities"]["delta_mu"]["tests_needed_80"], 2)
        # All of A stick and none of B: 1 of 8!/(5! 3!) = 56 tables.
        self.assertEqual(fast["regime"], {"a_sticking": 5, "a_sliding": 0, "b_sticking": 0, "b_sliding": 3, "p": fast["regime"]["p"]})
        self.assertAlmostEqual(fast["regime"]["p"], 1 / 56, delta=1e-12)
        with (self.folder / "c.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["quantity"] for row in rows], 2 * ["delta_mu_by_cycle", *QUANTITIES])
        pooled = comparison["a"]["groups"][0]["delta_mu_by_cycle"]
        self.assertEqual([float(rows[0][key]) for key in ("a_count", "a_mean", "a_mean_low", "a_mean_high")],
                         [pooled["tests"], pooled["value"], *pooled["confidence_interval"]])
        self.assertEqual(float(rows[-1]["p"]), fast["quantities"][QUANTITIES[-1]]["p"])

    def test_options_may_stand_before_or_behind_the_mark(self):
        plain = self.good("compare", *self.a, "--", *self.b, "--label-a", "X", "--json")
        self.assertEqual(self.good("compare", "--json", "--label-a", "X", *self.a, "--", *self.b), plain)
        self.assertEqual(self.good("compare", *self.a, "--label-a", "X", "--json", "--against", *self.b), plain)

    def test_one_output_may_be_the_standard_output(self):
        self.good("report", *self.a, "-o", "whole.html", "--csv", "whole.csv")
        self.assertEqual(self.good("report", *self.a, "-o", "-"), (self.folder / "whole.html").read_text(encoding="utf-8"))
        self.assertEqual(self.good("report", *self.a, "--csv", "-"), (self.folder / "whole.csv").read_text(encoding="utf-8"))
        self.assertTrue(self.good("compare", *self.a, "--", *self.b, "-o", "-").startswith("<!DOCTYPE html>"))
        for both in (("-o", "-", "--json"), ("-o", "-", "--csv", "-")):
            self.refused(2, "one of them has the standard output to itself", "report", self.a[0], *both)

    def test_a_single_test_has_no_scatter_and_an_absent_number_its_reason(self):
        self.simulate("film.h5", STICKS, "12 in/min", 9, "--method", "iso-8295")
        text = self.good("report", "film.h5")
        self.assertIn("no kinetic in test 1: ", text)
        self.assertIn("test 1: sled mass 2.331 kg, iso-8295 asks 0.2 ± 0.002 kg", text)
        own = json.loads(self.good("report", "film.h5", "--json"))["groups"][0]["quantities"]
        self.assertIsNone(own["static_coefficient"]["standard_deviation"])
        self.assertIsNone(own["kinetic_coefficient"]["mean"])
        self.assertIn("the method wants 0.06 m", own["kinetic_coefficient"]["absent"][0]["reason"])
        comparison = json.loads(self.good("compare", "film.h5", "--", *self.b, "--json"))["comparisons"][0]["quantities"]
        self.assertEqual(comparison["static_coefficient"]["reason"], "two values of each are needed to know the scatter")

    def test_what_is_wrong_is_one_line_and_no_file_is_left(self):
        (self.folder / "junk.h5").write_text("junk")
        self.refused(2, "junk.h5: ", "report", self.a[0], "junk.h5", "-o", "r.html", "--csv", "r.csv")
        self.refused(2, "junk.h5: ", "report", *self.a[:3], "junk.h5", *self.a[3:])
        self.refused(2, "none.h5: there is no such file", "compare", *self.a, "--", "none.h5")
        self.refused(2, "compare needs records on both sides", "compare", *self.a)
        self.refused(2, "compare needs records on both sides", "compare", "--", *self.a)
        self.refused(2, "files", "report")
        self.refused(2, "name the same file", "report", self.a[0], "-o", "same", "--csv", "same")
        (self.folder / "there.html").write_text("mine")
        self.refused(2, "there.html", "report", self.a[0], "-o", "there.html", "--csv", "r.csv")
        self.assertEqual((self.folder / "there.html").read_text(), "mine")
        self.refused(2, "nowhere/x.html", "report", self.a[0], "-o", "nowhere/x.html")
        self.assertEqual(sorted(p.name for p in self.folder.glob("r.*")), [])

    def test_the_page_holds_the_json_and_loads_nothing(self):
        self.good("report", *self.a, "-o", "page.html")
        page = (self.folder / "page.html").read_text(encoding="utf-8")
        held = json.loads(page.split('id="data">')[1].split("</script>")[0])
        report = json.loads(self.good("report", *self.a, "--json"))
        for i in range(len(self.a)):
            trace = json.loads(page.split(f'id="trace-0-{i}">')[1].split("</script>")[0])
            self.assertGreater(len(trace["force"]["value"]), 1000)
        self.assertEqual(held["materials"][0]["tests"], report["tests"])
        self.assertEqual(held["materials"][0]["groups"], report["groups"])
        for loads in ('src="', "href=\"http", "@import", "fetch(", "XMLHttpRequest"):
            self.assertNotIn(loads, page)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

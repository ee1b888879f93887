#!/usr/bin/env python3
"""The pages of `stickslip report` and `stickslip compare` in a real browser.

report_page_test.py BUILD_DIR CHROMIUM [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment pictures of the pages are left there.
"""

import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import re
import tempfile
import unicodedata
import unittest

import h5py
import numpy

import pdf_text
from chromium import Chromium
from contrast import CONTROLS, MARK, TARGETS, TARGET_PX, TEXT, TEXTS, colours, contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
import uncertain  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
CLI = BUILD / "bin" / "stickslip"
SPEED = "effects.constant_speed.pull_speed"
HOSTILE = "</script><img src=x onerror='window.hacked=1'><b>&amp;"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600


def run(*arguments, cwd=None):
    done = subprocess.run([str(a) for a in (CLI, *arguments)], capture_output=True, text=True, timeout=TIMEOUT_S,
                          check=False, cwd=cwd)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


def simulate(folder, name, scene, speed, seed, *options):
    run("simulate", scene, "-o", name, "--seed", seed, "--set", f"{SPEED}={speed}", *options, cwd=folder)
    return name


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        sticks, rings = "stick-slip-at-12-in-per-min", "ring-down-at-12-in-per-min"
        cls.a = [simulate(cls.folder, f"a{i}-{speed[:2].strip()}.h5", sticks, speed, i, "--duration", "5 s")
                 for speed in ("6 in/min", "12 in/min") for i in (1, 2, 3)]
        cls.b = [simulate(cls.folder, f"b{i}.h5", rings, "12 in/min", 10 + i, "--duration", "5 s") for i in (1, 2, 3)]
        cls.report = cls.json_of("report", *cls.a, "-o", "report.html")
        cls.comparison = cls.json_of("compare", *cls.a, "--", *cls.b, "-o", "compare.html", "--label-b", HOSTILE)
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    @classmethod
    def json_of(cls, *arguments):
        return json.loads(run(*arguments, "--json", cwd=cls.folder))

    def page(self, name="report.html", **options):
        page = self.browser.open(self.folder / name, **options)
        self.addCleanup(lambda: self.assertEqual(page.complaints(), []))
        return page

    def rows(self, page, table):
        return page.value(f"[...document.querySelectorAll('#{table} tbody tr')].map(r => [...r.cells].map(c => c.textContent))")

    def range(self, page, viewer=0, chart=0):
        return page.value(f"(({{min, max}}) => [min, max])(stickslip.viewers[{viewer}].chart.charts[{chart}].scales.x)")

    def cycles(self, file):
        with h5py.File(self.folder / file) as record:
            return record["entry/cycles/peak_time"][()]

    def test_it_opens_without_a_complaint_and_asks_no_network(self):
        for name in ("report.html", "compare.html"):
            page = self.page(name)
            self.assertEqual(page.value("document.readyState"), "complete")
            urls = [url for url in page.requests() if not url.startswith("data:")]
            self.assertEqual(urls, [(self.folder / name).resolve().as_uri()])
            if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
                page.screenshot(pathlib.Path(folder) / name.replace(".html", ".png"))

    def test_traces_are_drawn_and_hold_each_scan(self):
        page = self.page()
        with h5py.File(self.folder / self.a[0]) as record:
            scans = record["entry/raw/force"].shape[0]
        self.assertEqual(page.value("stickslip.viewers[0].chart.charts[0].data[1].length"), scans)
        for chart in (0, 1):
            # Pixels of the line's own colour, and columns that have one: from the left end to the right.
            columns = page.value("""(() => {
              const u = stickslip.viewers[0].chart.charts[%d], {left, top, width, height} = u.bbox;
              const probe = document.createElement('canvas').getContext('2d');
              probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--a'); probe.fillRect(0, 0, 1, 1);
              const [r, g, b] = probe.getImageData(0, 0, 1, 1).data, pixels = u.ctx.getImageData(left, top, width, height).data;
              let columns = 0;
              for (let x = 0; x < width; ++x) {
                for (let y = 0; y < height; ++y) {
                  const at = 4 * (y * width + x);
                  if (Math.abs(pixels[at] - r) + Math.abs(pixels[at + 1] - g) + Math.abs(pixels[at + 2] - b) < 90) { ++columns; break; }
                }
              }
              return columns / width;
            })()""" % chart)
            self.assertGreater(columns, 0.95)

    def test_as_many_cycles_are_marked_as_the_record_has_in_view(self):
        page = self.page()
        for test, file in enumerate(self.a):
            page.value(f"stickslip.viewers[0].show({test})")
            page.settle()
            cycles = self.cycles(file)
            self.assertGreater(len(cycles), 10)
            self.assertEqual(page.value("document.getElementById('marked-0').textContent"), f"{len(cycles)} cycles marked")
        page.value("stickslip.viewers[0].chart.view(1.0, 1.5)")
        page.settle()
        inside = numpy.count_nonzero((cycles >= 1.0) & (cycles <= 1.5))
        self.assertGreater(inside, 2)
        self.assertEqual(page.value("document.getElementById('marked-0').textContent"),
                         f"{inside} cycles marked of {len(cycles)}")

    def test_tables_show_the_numbers_of_the_json_output(self):
        page = self.page()
        quantities = page.value("stickslip.data.quantities")
        self.assertEqual(len(quantities), 8)
        for index, group in enumerate(self.report["groups"]):
            rows = self.rows(page, f"replicates-0-{index}")
            self.assertEqual(len(rows), len(quantities))
            for row, quantity in zip(rows, quantities):
                own = group["quantities"][quantity["name"]]
                low, high = own["confidence_interval"]

                def scatter(value):
                    return "–" if value is None else f"{value:.{uncertain.decimals_for(value, quantity['decimals'])}f}"

                digits = uncertain.decimals_for((high - low) / 2, quantity["decimals"])
                self.assertEqual(row[0].split(" (model)")[0].split(" (Hz)")[0], quantity["label"])
                self.assertEqual(row[1:], [str(own["count"]), f"{own['mean']:.{digits}f}", scatter(own["systematic_uncertainty"]),
                                           scatter(own["standard_deviation"]), scatter(own["repeatability"]), f"{low:.{digits}f} … {high:.{digits}f}"])
            # All columns are in sight.
            wide = page.value(f"(t => [t.scrollWidth, t.clientWidth])(document.getElementById('replicates-0-{index}').parentNode)")
            self.assertLessEqual(wide[0], wide[1])
            pooled = group["delta_mu_by_cycle"]
            self.assertIn(f"S−K by cycle {uncertain.text(pooled['value'], pooled['standard_error'], pooled['systematic_uncertainty'])}: {pooled['slips']} slips",
                          page.value(f"document.getElementById('by-cycle-0-{index}').textContent"))
        rows = self.rows(page, "tests-0")
        self.assertEqual([row[1] for row in rows], self.a)
        [first, *_] = self.report["tests"]
        self.assertIn(f" · rung: {first['rung']}", page.value("document.querySelector('p.facts').textContent"))
        for row, test in zip(rows, self.report["tests"]):
            self.assertEqual(row[3], test["regime"])
            for cell, quantity in zip(row[4:], self.in_tests(quantities), strict=True):
                own = test["details"][quantity["name"]]
                self.assertEqual(cell, uncertain.text(own["value"], own.get("standard_error"), own.get("systematic_uncertainty"), quantity["decimals"]))

        page = self.page("compare.html")
        compared = self.comparison["comparisons"]
        self.assertEqual(len(compared), 2)
        # B has no test at 6 in/min.
        self.assertEqual(page.value("document.getElementById('comparison-0').textContent"), "no test of B at this speed")
        self.assertEqual(page.value("document.getElementById('regime-1').textContent"), "Sticking: 3 of 3 tests of A, 0 of 3 of B; p 0.1000 (Fisher's exact test).")
        rows = self.rows(page, "comparison-1")
        self.assertEqual(rows[0][:2], ["S−K by cycle", "–"])  # B never stuck again.
        for row, quantity in zip(rows[1:], quantities, strict=True):
            own = compared[1]["quantities"][quantity["name"]]
            low, high = own["confidence_interval"]
            digits = uncertain.decimals_for((high - low) / 2, quantity["decimals"])
            self.assertEqual(row[1], f"{own['difference']:.{digits}f}")
            self.assertEqual(row[3], "< 0.0001" if own["p"] < 0.0001 else f"{own['p']:.4f}")
            self.assertEqual(row[4], f"{own['hedges_g']:.2f}")
            self.assertEqual(row[6:], ["> 10000" if own[key] is None else str(own[key])
                                       for key in ("tests_needed_80", "tests_needed_90")])

    def test_budgets_are_those_of_the_json_output(self):
        page = self.page()
        page.resize(1280, 720)
        names = ("delta_mu", "static_coefficient", "kinetic_coefficient")
        shown = [(f"budget-0-{index}", group["budgets"]) for index, group in enumerate(self.report["groups"])]
        shown += [(f"budget-of-test-0-{index}", test["budgets"]) for index, test in enumerate(self.report["tests"])]
        for table, budgets in shown:
            rows = {row[0]: row[2:] for row in self.rows(page, table)}
            text = page.value(f"document.getElementById('{table}').closest('div:not(.table)').textContent")
            for at, budget in enumerate(budgets[name] for name in names):
                for line in budget["lines"]:
                    size, share = rows[line["title"]][2 * at:2 * at + 2]
                    if line["state"] == "counted":
                        # Two digits of the size, whole per cent of the share.
                        self.assertAlmostEqual(float(size), line["standard_uncertainty"], delta=0.051 * line["standard_uncertainty"] + 5e-8)
                        self.assertAlmostEqual(float(share.replace("<1", "0.25")), 100 * line["share"], delta=0.51)
                    else:
                        self.assertEqual((size[0], share), ({"included": "(", "none": "0", "unknown": "–"}[line["state"]], ""))
                self.assertEqual(rows["expanded, U = 2 u"][2 * at] == "–", budget["expanded_uncertainty"] is None)
                self.assertIn(budget["statement"], text)
            wide = page.value(f"(t => [t.scrollWidth, t.clientWidth])(document.getElementById('{table}').parentNode)")
            self.assertLessEqual(wide[0], wide[1])
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.value("document.getElementById('budgets').scrollIntoView()")
            page.screenshot(pathlib.Path(folder) / "report-budgets.png")

    def test_it_opens_with_the_form_and_has_a_chart_against_speed_only_of_two_speeds(self):
        run("report", *self.a[3:], "-o", "one-speed.html", cwd=self.folder)
        for name, drawn in (("report.html", True), ("one-speed.html", False)):
            page = self.page(name)
            page.resize(1280, 720)
            sections = page.value("[...document.querySelectorAll('section')].map(s => s.id)")
            self.assertEqual(sections, ["form", "means", "replicates", "budgets", "all-tests-0", *(["against-speed"] if drawn else []), "traces-0"])
            form = page.value("[...document.querySelectorAll('#form-0 > div')].map(line => [line.dataset.name, line.children[1].textContent])")
            self.assertEqual([line[0] for line in form], [line["name"] for line in self.report["form"]] + ["verdict"])
            self.assertEqual(dict(form)["operator"], "–")
            self.assertEqual(dict(form)["speed"], "2 speeds: 6 in/min; 12 in/min" if drawn else "12 in/min")
            # The form and the means are on the first screen.
            self.assertLessEqual(page.value("document.getElementById('form').getBoundingClientRect().bottom"), 720)
            self.assertIn("k = 4.30 for n = 3.", page.value("document.getElementById('means-note').textContent"))
            self.assertIn("model quantities", page.value("document.getElementById('means-note').textContent"))
            self.assertEqual(page.value("document.querySelector('#replicates-0-0 td').textContent"), "static µs (ISO 8295: µS)")
            if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
                page.screenshot(pathlib.Path(folder) / name.replace(".html", "-top.png"))

    def test_on_paper_no_heading_is_left_alone(self):
        page = self.page("compare.html")
        page.print()
        kept = page.value("[...document.querySelectorAll('h2, h3, h2 + .note, thead')].map(e => getComputedStyle(e).breakAfter)")
        self.assertGreater(len(kept), 10)
        self.assertEqual(set(kept), {"avoid"})

    def test_printed_each_row_is_whole_on_a_page_and_nothing_is_left_out(self):
        def squeezed(text):
            return "".join(unicodedata.normalize("NFKC", text).split())
        for name in ("report.html", "compare.html"):
            page = self.page(name)
            shown = page.value("[...document.querySelectorAll('h1, h2, h3, tbody tr, dl.form > div, footer')].filter(e => !e.closest('.u-legend, details:not([open])')).map(e => e.innerText)")
            self.assertGreater(len(shown), 40)
            file = self.folder / "printed.pdf"
            page.pdf(file)
            sheets = [squeezed(text) for text in pdf_text.pages(file.read_bytes())]
            self.assertEqual(len(sheets), max(int(count) for count in re.findall(rb"/Count (\d+)", file.read_bytes())))
            self.assertGreater(len(sheets), 2)
            for text in shown:
                self.assertTrue(any(squeezed(text) in sheet for sheet in sheets), f"{name}: {text}")
            axes = ["coefficientoffriction", "force/weight", "stretching(mm/s)"]
            self.assertEqual([axis for axis in axes if not any(axis in sheet for sheet in sheets)], [])
            # What stands under the cursor is nothing on paper.
            self.assertEqual([sheet for sheet in sheets if ":–" in sheet], [])

    @staticmethod
    def in_tests(quantities):
        """S - K first, then what it is made of."""
        leading = ["delta_mu", "mu_s", "mu_k"]
        return sorted(quantities, key=lambda quantity: leading.index(quantity["name"]) if quantity["name"] in leading else len(leading))

    def test_both_errors_and_what_is_not_significant_are_shown(self):
        (self.folder / "both.h5").write_bytes((self.folder / self.a[0]).read_bytes())
        with h5py.File(self.folder / "both.h5", "r+") as record:
            for name, systematic in (("delta_mu", 0.06), ("mu_s", 0.004), ("static_coefficient", 0.003)):
                record[f"entry/results/{name}"].attrs["systematic_uncertainty"] = systematic
            expected = {name: uncertain.of(record, name) for name in ("delta_mu", "mu_s", "mu_k", "static_coefficient")}
        self.assertRegex(expected["delta_mu"], r"^0\.05\d\? ± (<?0\.\d+) ± 0\.060$")
        report = self.json_of("report", "both.h5", "-o", "both.html")
        page = self.page("both.html")
        [row] = self.rows(page, "tests-0")
        self.assertEqual(row[4:8], [expected[name] for name in ("delta_mu", "mu_s", "mu_k")] + [expected["static_coefficient"]])
        self.assertEqual(page.value("document.getElementById('errors-0').textContent"),
                         "± standard error ± systematic part (calibration, corrections) · ? not significant, its errors together exceed it")
        pooled = report["groups"][0]["delta_mu_by_cycle"]
        self.assertIn(f"S−K by cycle {uncertain.text(pooled['value'], None, 0.06)}: ", page.value("document.getElementById('by-cycle-0-0').textContent"))
        replicates = self.rows(page, "replicates-0-0")
        self.assertEqual([cells[3] for cells in replicates[:5]], ["0.0030", "–", "0.0040", "–", "0.060"])
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.screenshot(pathlib.Path(folder) / "report-errors.png")

    # As tests/unit/uncertain_test.cpp has them; null is what JSON has for NaN and infinity.
    def test_numbers_are_formatted_as_at_the_terminal(self):
        page = self.page()
        infinite, nan = math.inf, math.nan
        cases = [(0.04698, 0.00271, 0.00188), (0.04698, 0.00188, 0.0271), (0.05, 0.0003, None), (0.05, 0.00996, None), (-0.05, 0.0012, None),
                 (0.05, None, None), (0.3822, None, 0.003), (0.047, 0.27, None), (-0.047, 0.27, None), (0.005, 0.004, 0.004), (0.005, 0.003, 0.004),
                 (0.0, 0.0012, None), (3.2, 120.0, 0.3), (0.05, nan, nan), (0.05, nan, 0.003), (0.05, infinite, None), (0.05, 0.0012, infinite),
                 (0.05, 0.0, None), (0.0, 0.0, 0.0), (0.3, 0.00001, 0.003), (0.3, 0.0028, 0.0000096), (0.3, 1e-8, 0.003), (0.3, 1e-12, None), (None, 0.1, None), (nan, 0.1, None), (infinite, 0.1, None)]
        def script(number):
            return "null" if number is None else {"inf": "Infinity", "nan": "NaN"}.get(str(number), repr(number))
        for value, random, constant in cases:
            shown = page.value(f"Uncertain.text({script(value)}, {{standard_error: {script(random)}, systematic_uncertainty: {script(constant)}}}, 4)")
            self.assertEqual(shown, uncertain.text(value, random, constant), (value, random, constant))
        self.assertEqual(page.value("Uncertain.text(0.05, undefined, 4)"), "0.0500")

    def test_a_measured_pull_speed_has_a_chart_of_its_own(self):
        scene = pathlib.Path(__file__).resolve().parents[2] / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
        (self.folder / "speed.toml").write_text(f"""
[board]
driver = "simulated"
clock_speed = 200
[board.simulated]
scenes = ["{scene}"]
speed_gain = "1 mm/s/V"
[record]
folder = "speed"
[log]
level = "warning"
""", encoding="utf-8")
        subprocess.run([BUILD / "bin" / "stickslipd", "--config", "speed.toml"], cwd=self.folder, check=True, timeout=TIMEOUT_S)
        [record] = (self.folder / "speed").glob("*.h5")
        run("report", record, "-o", "speed.html", cwd=self.folder)
        page = self.page("speed.html")
        with h5py.File(record) as file:
            speed = file["entry/raw/pull_speed"][()]
        self.assertEqual(page.value("stickslip.viewers[0].chart.charts.length"), 3)
        drawn = page.value("stickslip.viewers[0].chart.charts[2].data[1]")
        self.assertEqual(len(drawn), len(speed))
        for i in range(0, len(speed), 97):
            self.assertAlmostEqual(drawn[i], 1e3 * float(speed[i]), delta=1e-6)  # Half a millionth; 24 bits of 5 mm/s.
        self.assertEqual(self.range(page, chart=2), self.range(page, chart=0))

    def test_dragging_zooms_both_charts_and_a_double_click_shows_the_whole_again(self):
        page = self.page()
        whole = self.range(page)
        page.drag("#traces-0 .u-over", 0.25, 0.5)
        zoomed = self.range(page)
        # A pixel of 1100 is 0.1 % of the width.
        numpy.testing.assert_allclose(zoomed, [0.25 * whole[1], 0.5 * whole[1]], atol=0.004 * whole[1])
        self.assertEqual(self.range(page, chart=1), zoomed)
        page.click("#traces-0 .u-over", times=2)
        self.assertEqual(self.range(page), whole)
        self.assertEqual(self.range(page, chart=1), whole)

    def test_keys_and_buttons_do_the_same(self):
        page = self.page()
        whole = self.range(page)
        page.value("stickslip.viewers[0].box.focus()")
        page.press("+")
        numpy.testing.assert_allclose(self.range(page), [0.25 * whole[1], 0.75 * whole[1]], rtol=1e-9)
        page.press("ArrowRight")
        numpy.testing.assert_allclose(self.range(page), [0.375 * whole[1], 0.875 * whole[1]], rtol=1e-9)
        page.press("0")
        self.assertEqual(self.range(page), whole)
        page.click("#traces-0 button[aria-label='zoom in']")
        numpy.testing.assert_allclose(self.range(page), [0.25 * whole[1], 0.75 * whole[1]], rtol=1e-9)
        page.click("#tests-0 button", index=4)
        self.assertEqual(page.value("stickslip.viewers[0].shown"), 4)
        self.assertEqual(page.value("document.getElementById('test-0').selectedIndex"), 4)
        # Each control can be reached by the tab key.
        self.assertEqual(page.value("[...document.querySelectorAll('button, select, .charts')].filter(e => e.tabIndex < 0).length"), 0)

    def test_it_is_dark_where_the_reader_likes_it_dark_and_can_be_changed(self):
        light = "getComputedStyle(document.body).backgroundColor"
        brightness = {}
        for dark in (False, True):
            page = self.page(dark=dark)
            colour = page.value(light)
            brightness[dark] = sum(int(part) for part in colour.strip("rgb()").split(","))
            page.click("#theme")
            self.assertNotEqual(page.value(light), colour)
            self.assertIn("cycles marked", page.value("document.getElementById('marked-0').textContent"))
        self.assertGreater(brightness[False], 600)
        self.assertLess(brightness[True], 150)

    def check_contrast(self, page, what):
        texts = page.value(f"{TEXTS}('body, body *')")
        self.assertGreater(len(texts), 50)
        for name, front, back in texts:
            self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"{name} {front} on {back}, {what}")
        drawn = colours(page, "--card", "--soft", "--a", "--b", "--limit", "--mark", "--free", "--accent")
        self.assertGreaterEqual(contrast(drawn["--soft"], drawn["--card"]), TEXT, f"names of the axes, {what}")
        for name in ("--a", "--b", "--limit", "--mark", "--free", "--accent"):
            self.assertGreaterEqual(contrast(drawn[name], drawn["--card"]), MARK, f"{name}, {what}")
        for name in ("--a", "--b"):  # Single tests, drawn through: charts.js.
            mixed = [0.75 * front + 0.25 * back for front, back in zip(drawn[name], drawn["--card"])]
            self.assertGreaterEqual(contrast(mixed, drawn["--card"]), MARK, f"single tests in {name}, {what}")

    def test_it_can_be_read_in_both_colours(self):
        for name in ("report.html", "compare.html"):
            for dark in (False, True):
                self.check_contrast(self.page(name, dark=dark), f"{name}, dark {dark}")

    # The strongest ink of the numbers at the left of the first trace, on white paper.
    DARKEST = """(() => {
      const u = stickslip.viewers[0].chart.charts[0], {data} = u.ctx.getImageData(0, 0, Math.floor(u.bbox.left) - 4, u.ctx.canvas.height);
      let found = [255, 255, 255];
      for (let at = 0; at < data.length; at += 4) {
        const alpha = data[at + 3] / 255, on = [0, 1, 2].map(k => alpha * data[at + k] + (1 - alpha) * 255);
        if (on[0] + on[1] + on[2] < found[0] + found[1] + found[2]) found = on;
      }
      return found;
    })()"""

    def test_on_paper_it_is_light_whatever_the_screen_is(self):
        for name in ("report.html", "compare.html"):
            page = self.page(name, dark=True)
            ink = "[getComputedStyle(document.body).color, stickslip.viewers[0].chart.charts[0].axes[0].stroke()]"
            screen = page.value(ink)
            page.resize(718, 1000)  # A4 between Chromium's margins, at 96 pixels an inch.
            page.print()
            page.settle()
            self.check_contrast(page, f"{name} printed")
            self.assertEqual(page.value("getComputedStyle(document.body).backgroundColor"), "rgb(255, 255, 255)")
            # Charts are drawn anew: their numbers in dark ink, and no wider than the paper.
            self.assertGreaterEqual(contrast(page.value(self.DARKEST), (255, 255, 255)), TEXT)
            self.assertLessEqual(page.value("Math.max(...[...document.querySelectorAll('.uplot')].map(u => u.getBoundingClientRect().right))"), 718)
            self.assertLessEqual(page.value("document.documentElement.scrollWidth"), 718)
            if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
                page.screenshot(pathlib.Path(folder) / name.replace(".html", "-printed.png"))
            page.print(False)
            page.settle()
            self.assertEqual(page.value(ink), screen)
            # Printed in earnest: looked at before the page knows that the printer is done.
            page.value(f"addEventListener('afterprint', () => {{ window.printed = {self.DARKEST}; }}, {{capture: true}})")
            page.pdf(self.folder / "printed.pdf")
            self.assertGreaterEqual(contrast(page.value("window.printed"), (255, 255, 255)), TEXT)
            self.assertEqual((self.folder / "printed.pdf").read_bytes()[:5], b"%PDF-")
            # As it was, when the printer is done.
            self.assertEqual(page.value(ink), screen)

    def test_fingers_meet_its_controls_on_a_tablet(self):
        for name in ("report.html", "compare.html"):
            page = self.page(name, touch=True)
            self.assertTrue(page.value("matchMedia('(pointer: coarse)').matches"))
            for width, height in ((820, 1180), (1280, 720)):
                page.resize(width, height)
                self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                targets = page.value(f"{TARGETS}('{CONTROLS}')")
                self.assertGreater(len(targets), 10)
                for target, wide, high in targets:
                    self.assertGreaterEqual(min(wide, high), TARGET_PX, f"{target} {wide} x {high}, {name} at {width}")
            page.tap("#traces-0 button[aria-label='next test']")
            self.assertEqual(page.value("stickslip.viewers[0].shown"), 1)

    def test_no_text_becomes_markup(self):
        page = self.page("compare.html")
        self.assertEqual(page.value("document.getElementById('title').textContent"), f"A against {HOSTILE}")
        self.assertIsNone(page.value("window.hacked"))
        # As markup the label would make an image, and bold text that begins with its last character.
        self.assertEqual(page.value("document.querySelectorAll('img').length"), 0)
        self.assertEqual(page.value("[...document.querySelectorAll('b')].filter(b => b.textContent.startsWith('&')).length"), 0)
        self.assertEqual(page.value("stickslip.data.materials[1].label"), HOSTILE)

    def test_a_long_record_keeps_its_highest_and_lowest_scans(self):
        simulate(self.folder, "long.h5", "stick-slip-at-12-in-per-min", "12 in/min", 5, "--duration", "100 s")
        run("report", "long.h5", "-o", "long.html", cwd=self.folder)
        with h5py.File(self.folder / "long.h5") as record:
            truth = record["entry/truth/coefficient"][()]
        self.assertGreater(len(truth), 30000)
        page = self.page("long.html")
        points, low, high = page.value("(v => [v.length, Math.min(...v), Math.max(...v)])(stickslip.viewers[0].chart.charts[0].data[1])")
        self.assertLessEqual(points, 20002)  # Two for each of 10 000 parts, and the ends.
        # Counts have noise of 0.001; five of its standard deviations beside the true extremes.
        self.assertAlmostEqual(low, truth.min(), delta=0.005)
        self.assertAlmostEqual(high, truth.max(), delta=0.005)
        self.assertEqual(page.value("document.getElementById('marked-0').textContent"), f"{len(self.cycles('long.h5'))} cycles marked")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

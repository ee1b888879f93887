#!/usr/bin/env python3
"""The trace of a finished test on the live page, in a real browser: whole and a span of it, against the record's scans.

trace_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment pictures of the page are left there.
"""

import os
import pathlib
import shutil
import sys
import unittest

import h5py
import numpy

from chromium import Chromium
from contrast import CONTROLS, TARGETS, TARGET_PX, TEXT, TEXTS, contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

READY = "document.getElementById('trace-dialog').getAttribute('aria-busy') === 'false'"
# Of the first test that is shown; the other one follows. What the chart has, not what it was told.
SHOWN = """(({number, view, tests, chart}) => ({number, view, tests, columns: [...chart.data].map(column => [...column]), x: [chart.scales.x.min, chart.scales.x.max],
  span: document.getElementById('trace-span').textContent, message: document.getElementById('trace-message').textContent}))(Trace.shown())"""


def values(shown, at, which="lowest"):
    """What the chart draws of a test: the first that is shown is drawn last, on top."""
    return [value for value in shown["columns"][-2 - 2 * at + (which == "highest")] if value is not None]


class TracePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, tests, dark=False, speed=4):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, speed=speed, config='http = "127.0.0.1:0"\ntoken_file = "token"\n')
        token = (self.daemon.folder / "token").read_text().strip()
        page = self.browser.open(f"http://{self.daemon.port_line()}/#token={token}", dark=dark)
        self.addCleanup(page.close)
        page.resize(1280, 720)
        page.until(" && ".join(f"document.getElementById('record-{number}')" for number in range(1, tests + 1)))
        return page

    def shown(self, page):
        page.until(READY)
        return page.value(SHOWN)

    def scans(self, number):
        with h5py.File(self.daemon.record(number)) as record:
            tester = record["entry/instrument/tester"]
            force = record["entry/raw/force"][()] / (tester["sled_mass"][()] * tester["gravity"][()])
            return (record["entry/raw/scan"][()], force, float(record["entry/timing/scan_rate_granted"][()]),
                    {name: record[f"entry/cycles/{name}"][()] for name in ("peak_time", "peak", "flags")},
                    {name: float(record[f"entry/results/{name}"][()]) for name in ("mu_s", "mu_k")})

    def compare(self, trace, scans, force, rate):
        """Each bin has the lowest and the highest of its scans. Returns their times."""
        at, width = scans - scans[0], trace["scans_in_bin"]
        for time, low, high in zip(trace["time"], trace["lowest"], trace["highest"], strict=True):
            first = round(time * rate)
            part = force[(at >= first) & (at < first + width)]
            self.assertAlmostEqual(high, part.max(), delta=2e-6)
            self.assertAlmostEqual(low, part.min(), delta=2e-6)
        return trace["time"]

    def test_a_row_opens_its_whole_trace_a_span_has_each_scan_and_a_second_test_lies_over_it(self):
        page = self.open(3)
        page.value("document.getElementById('trace-2').focus()")
        page.press("Enter")
        whole = self.shown(page)
        scans, force, rate, cycles, levels = self.scans(2)
        self.assertEqual((whole["number"], whole["span"], whole["message"]), (2, "the whole trace", ""))
        trace = whole["tests"][0]["trace"]
        self.assertGreater(trace["scans_in_bin"], 1)
        times = self.compare(trace, scans, force, rate)
        self.assertEqual(times[0], 0)
        self.assertAlmostEqual(times[-1] + trace["scans_in_bin"] / rate, (scans[-1] - scans[0] + 1) / rate, delta=trace["scans_in_bin"] / rate)
        self.assertEqual(values(whole, 0), trace["lowest"])
        self.assertEqual(values(whole, 0, "highest"), trace["highest"])
        slips = whole["tests"][0]["slips"]
        numpy.testing.assert_allclose([slip["peak_time"] for slip in slips], cycles["peak_time"], atol=1e-6)
        self.assertEqual([slip["captured"] for slip in slips], [bool(flags & 8) for flags in cycles["flags"]])
        for name, value in levels.items():
            self.assertAlmostEqual(trace[name], value, delta=1e-6)
        # S and K are drawn over its width, peaks where they are.
        drawn = page.value("""(() => {
          const u = Trace.shown().chart, probe = document.createElement('canvas').getContext('2d'), trace = Trace.shown().tests[0].trace;
          const rgba = name => { probe.fillStyle = Chart.colour(name); probe.fillRect(0, 0, 1, 1); return [...probe.getImageData(0, 0, 1, 1).data]; };
          const near = (pixels, k, want) => Math.abs(pixels[k] - want[0]) + Math.abs(pixels[k + 1] - want[1]) + Math.abs(pixels[k + 2] - want[2]) < 60;
          const part = (value, want) => { const pixels = u.ctx.getImageData(u.bbox.left, Math.round(u.valToPos(value, 'y', true)) - 1, u.bbox.width, 3).data;
            let like = 0; for (let k = 0; k < pixels.length; k += 4) like += near(pixels, k, want); return like / u.bbox.width; };
          const mark = rgba('--mark');
          return {levels: [['mu_s', 0], ['mu_k', 1]].map(([name, at]) => part(trace[name], rgba(Trace.levels()[at][2]))),
            peaks: Trace.shown().tests[0].slips.filter(slip => slip.captured).map(slip => near(u.ctx.getImageData(Math.round(u.valToPos(slip.peak_time, 'x', true)), Math.round(u.valToPos(slip.peak, 'y', true)), 1, 1).data, 0, mark))};
        })()""")
        self.assertTrue(all(part > 0.1 for part in drawn["levels"]), drawn["levels"])
        self.assertGreater(sum(drawn["peaks"]), 0.8 * len(drawn["peaks"]))
        self.picture(page, "trace")
        # A span that is dragged over: each of its scans.
        page.drag("#trace-chart .u-over", 0.45, 0.5)
        page.until("Trace.shown().tests[0].trace.scans_in_bin === 1")
        span = self.shown(page)
        length = trace["end"]
        self.assertAlmostEqual(span["view"][0], 0.45 * length, delta=0.01 * length)
        self.assertAlmostEqual(span["view"][1], 0.50 * length, delta=0.01 * length)
        self.assertEqual(span["x"], span["view"])
        part = span["tests"][0]["trace"]
        self.assertEqual(part["lowest"], part["highest"])
        self.compare(part, scans, force, rate)
        self.assertEqual(len(part["time"]), round((part["time"][-1] - part["time"][0]) * rate) + 1)
        self.assertTrue(part["time"][0] <= span["view"][0] and part["time"][-1] >= span["view"][1])
        self.picture(page, "trace-span")
        # By keyboard: shorter, longer, earlier, later, the whole again; and once more Escape closes it.
        page.value("document.getElementById('trace-in').focus()")
        page.press("+")
        near = self.shown(page)["view"]
        self.assertAlmostEqual(near[1] - near[0], (span["view"][1] - span["view"][0]) / 2, delta=1e-9)
        page.press("ArrowLeft")
        moved = self.shown(page)["view"]
        self.assertAlmostEqual(moved[0], near[0] - (near[1] - near[0]) / 4, delta=1e-9)
        page.press("ArrowRight")
        page.press("-")
        numpy.testing.assert_allclose(self.shown(page)["view"], span["view"], atol=1e-9)
        page.press("Escape")
        again = self.shown(page)
        self.assertEqual((again["span"], again["tests"][0]["trace"]), ("the whole trace", trace))
        # Another test over it, with its own S and K.
        page.value("document.getElementById('trace-other').focus()")
        page.value("(s => { s.value = '1'; s.dispatchEvent(new Event('change')); })(document.getElementById('trace-other'))")
        page.until("Trace.shown().tests.length === 2")
        both = self.shown(page)
        self.assertEqual([test["number"] for test in both["tests"]], [2, 1])
        scans1, force1, rate1, _, levels1 = self.scans(1)
        self.compare(both["tests"][1]["trace"], scans1, force1, rate1)
        self.assertAlmostEqual(both["tests"][1]["trace"]["mu_s"], levels1["mu_s"], delta=1e-6)
        self.assertEqual(values(both, 1, "highest"), both["tests"][1]["trace"]["highest"])
        self.assertEqual({value for column in both["columns"][1:-4] for value in column}, {None})
        self.assertEqual([name for name, *_ in page.value("Trace.levels()")], ["S, test 2", "K, test 2", "S, test 1", "K, test 1"])
        self.picture(page, "trace-two")
        page.press("Escape")
        self.assertFalse(page.value("document.getElementById('trace-dialog').open"))
        self.assertEqual(page.value("document.activeElement.id"), "trace-2")
        # A click anywhere in the row, too.
        page.value("document.getElementById('trace-3').closest('tr').cells[2].click()")
        self.assertEqual(self.shown(page)["number"], 3)
        # The browser's advice is on how this test reads pixels.
        self.assertEqual([said for said in page.complaints() if "willReadFrequently" not in said], [])

    def choices(self, page):
        return page.value("[...document.getElementById('trace-other').options].map(option => [option.value, option.textContent.split(',')[0]])")

    def choose(self, page, value):
        page.value(f"(s => {{ s.value = '{value}'; s.dispatchEvent(new Event('change')); }})(document.getElementById('trace-other'))")

    def test_a_reference_and_the_others_of_a_batch_lie_over_a_test(self):
        page = self.open(2, speed=12)
        page.value("document.getElementById('trace-1').click()")
        self.shown(page)
        # Without a batch there are only single tests.
        self.assertNotIn("others", dict(self.choices(page)))
        page.click("#trace-reference")
        page.press("Escape")
        status, begun = self.daemon.ask("POST", "/v1/batch", {"name": "liner", "replicates": 1000})
        self.assertEqual(status, 200, begun)
        page.until("document.querySelectorAll('#tests tr.own a[id^=record-]').length >= 13")
        own = sorted(page.value("[...document.querySelectorAll('#tests tr.own:has(a[id^=record-]) button.link')].map(button => Number(button.textContent))"))
        # A test of the batch: the reference, which is not of it, lies over it at once.
        page.value(f"document.getElementById('trace-{own[0]}').click()")
        page.until("Trace.shown().tests.length === 2")
        self.assertEqual([test["number"] for test in self.shown(page)["tests"]], [own[0], 1])
        self.assertEqual(self.choices(page)[1], ["1", "reference: test 1"])
        self.assertFalse(page.value("document.getElementById('trace-reference').checked"))
        # Its batch: the latest ten others, each from its record, drawn, with the levels of the first alone.
        self.assertEqual(dict(self.choices(page))["others"], "the latest 10 others of its batch")
        self.choose(page, "others")
        page.until("Trace.shown().tests.length === 11")
        shown = self.shown(page)
        numbers = [test["number"] for test in shown["tests"]]
        self.assertEqual((numbers[0], len(set(numbers)), set(numbers[1:]) <= set(range(own[0] + 1, own[0] + 1000))), (own[0], 11, True))
        self.assertEqual(sorted(numbers[1:], reverse=True), numbers[1:])
        for number in (0, 1, 10):
            trace = shown["tests"][number]
            scans, force, rate, _, _ = self.scans(trace["number"])
            self.compare(trace["trace"], scans, force, rate)
            self.assertEqual(values(shown, number), trace["trace"]["lowest"])
        self.assertEqual([name for name, *_ in page.value("Trace.levels()")], [f"S, test {own[0]}", f"K, test {own[0]}"])
        self.picture(page, "trace-batch")
        page.press("Escape")
        # The reference is kept over a reload, and until another test is it, or none.
        page.reload()
        page.until(f"document.getElementById('trace-{own[1]}')")
        page.value(f"document.getElementById('trace-{own[1]}').click()")
        page.until("Trace.shown().tests.length === 2")
        self.assertEqual([test["number"] for test in self.shown(page)["tests"]], [own[1], 1])
        self.picture(page, "trace-reference")
        page.click("#trace-reference")
        page.press("Escape")
        page.value(f"document.getElementById('trace-{own[2]}').click()")
        page.until("Trace.shown().tests.length === 2")
        self.assertEqual([test["number"] for test in self.shown(page)["tests"]], [own[2], own[1]])
        page.press("Escape")
        page.value(f"document.getElementById('trace-{own[1]}').click()")
        self.assertEqual(len(self.shown(page)["tests"]), 1)
        self.assertTrue(page.value("document.getElementById('trace-reference').checked"))
        page.click("#trace-reference")
        page.press("Escape")
        page.value(f"document.getElementById('trace-{own[2]}').click()")
        self.assertEqual(len(self.shown(page)["tests"]), 1)
        self.assertEqual(self.choices(page)[0][0], page.value("document.getElementById('trace-other').value"))

    def test_it_says_why_a_test_has_no_trace(self):
        page = self.open(2)
        # With a reference, whose trace comes all the same.
        page.value("document.getElementById('trace-2').click()")
        self.shown(page)
        page.click("#trace-reference")
        page.press("Escape")
        self.assertEqual(self.daemon.ask("POST", "/v1/void", {"test": 1, "reason": "paper torn"})[0], 200)
        page.value("document.getElementById('trace-1').click()")
        page.until(READY)
        self.assertTrue(page.value("document.getElementById('trace-message').textContent").startswith("test 1 is void: paper torn"))
        page.until("document.getElementById('trace-reference').disabled")
        self.assertEqual(page.value("Trace.shown().tests.length"), 0)

    def test_it_fits_and_can_be_read(self):
        for dark in (False, True):
            page = self.open(1, dark=dark)
            page.value("document.getElementById('trace-1').click()")
            self.shown(page)
            for width, height in ((1280, 720), (390, 844)):
                page.resize(width, height)
                self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                self.assertLessEqual(page.value("(d => d.scrollWidth - d.clientWidth)(document.getElementById('trace-dialog'))"), 0)
                self.picture(page, f"trace-{width}{'-dark' if dark else ''}")
            for name, front, back in page.value(f"{TEXTS}('#trace-dialog *')"):
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"{name} {front} on {back}, dark {dark}")
            for name, width, height in page.value(f"{TARGETS}('#trace-dialog :is({CONTROLS})')"):
                self.assertGreaterEqual(min(width, height), TARGET_PX, name)

    def picture(self, page, name):
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.screenshot(pathlib.Path(folder) / f"{name}.png")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

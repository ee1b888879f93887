#!/usr/bin/env python3
"""The live page of a running daemon in a real browser: every number that it shows against the record's.

live_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment a picture of the page is left there.
"""

import functools
import math
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

import h5py
import numpy

from chromium import Chromium
from contrast import contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

# Of the table of tests, after number and regime.
COLUMNS = [("mu_s", 4), ("mu_k", 4), ("delta_mu", 4), ("static_coefficient", 4), ("kinetic_coefficient", 4), ("amplitude", 4),
           ("oscillation_frequency", 3), ("cycle_count", 0)]


@functools.lru_cache
def student_t(freedom):
    """Two-sided 5 %: where the density [Student 1908] has 95 % between -t and t; midpoints, then halving."""
    middles = (numpy.arange(100_000) + 0.5) / 100_000
    scale = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(freedom * math.pi)
    low, high = 0.0, 13.0  # 12.71 for one degree of freedom.
    for _ in range(40):
        t = (low + high) / 2
        inside = 2 * t * numpy.mean(scale * (1 + (t * middles) ** 2 / freedom) ** (-(freedom + 1) / 2))
        low, high = (t, high) if inside < 0.95 else (low, t)
    return low


class LivePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def daemon(self, config="", speed=20, board=None):
        daemon = RunningDaemon(self, BUILD, SOURCE, speed=speed, board=board, config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n{config}')
        self.address = f"http://{daemon.port_line()}/"
        self.token = (daemon.folder / "token").read_text().strip()
        return daemon

    def page(self, dark=False):
        page = self.browser.open(f"{self.address}#token={self.token}", dark=dark)
        page.until("document.querySelectorAll('#health dd').length > 5 && Scope.data.scan.length > 100")
        return page

    def test_each_number_in_the_table_is_the_records_to_the_digits_shown(self):
        daemon = self.daemon()
        page = self.page()
        page.until("[...document.querySelectorAll('#tests tbody td:last-child')].filter(c => c.textContent.endsWith('.h5')).length >= 3")
        rows, foot = page.value("[['#tests tbody tr', '#tests tfoot tr'].map(s => [...document.querySelectorAll(s)].map(r => [...r.cells].map(c => c.textContent)))][0]")
        compared, values = 0, {name: [] for name, _ in COLUMNS}
        for row in rows:
            test = next(t for t in daemon.ask("GET", "/v1/tests")[1]["tests"] if t["number"] == int(row[0]))
            file = daemon.record(int(row[0])) if not row[-1].endswith(".h5") else daemon.folder / test["file"]
            with h5py.File(file) as record:
                self.assertEqual(row[1], record["entry/results/regime"].asstr()[()])
                for cell, (name, digits) in zip(row[2:], COLUMNS):
                    value = float(record[f"entry/results/{name}"][()])
                    self.assertEqual(cell, "–" if numpy.isnan(value) else f"{value:.{digits}f}", name)
                    if not numpy.isnan(value):
                        values[name].append(value)
                        compared += 1
                self.assertEqual(row[-3], record["entry/process/end_cause"].asstr()[()])
        self.assertGreaterEqual(compared, 3 * (len(COLUMNS) - 1))
        def half_width(v):
            return student_t(len(v) - 1) * numpy.std(v, ddof=1) / numpy.sqrt(len(v))
        self.assertEqual([row[0] for row in foot], ["mean", "r = 2.8 s", "95 % from", "95 % to", "lowest", "highest"])
        for row, of in zip(foot, (numpy.mean, lambda v: 2.8 * numpy.std(v, ddof=1), lambda v: numpy.mean(v) - half_width(v),
                                  lambda v: numpy.mean(v) + half_width(v), numpy.min, numpy.max), strict=True):
            for cell, (name, digits) in zip(row[2:], COLUMNS[:-1]):
                self.assertAlmostEqual(float(cell), of(values[name]), delta=0.5001 * 10.0 ** -digits, msg=f"{row[0]} of {name}")
        self.assertEqual(page.complaints(), [])
        self.assertTrue(all(url.startswith(self.address) or url.startswith(("data:", "ws:")) for url in page.requests()), page.requests())
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.screenshot(pathlib.Path(folder) / "live.png")

    def test_the_scope_shows_the_scans_of_the_record(self):
        daemon = self.daemon()
        page = self.page()
        # A test has some hundred slips: at least one test that is over has its slips here, however slow this browser is.
        page.until("document.querySelectorAll('#tests tbody tr').length >= 2 && Scope.data.scan.length > 1200 && Scope.slips.length > 300")
        shown = page.value("({scan: Scope.data.scan, lowest: Scope.data.lowest, highest: Scope.data.highest, slope: Scope.data.slope, time: Scope.data.time,"
                           "slips: Scope.slips})")
        compared = peaks = 0
        ended = daemon.ask("GET", "/v1/tests")[1]["tests"]
        earliest = min(shown["scan"][0], 350 * shown["slips"][0]["peak_time"])
        for number in [test["number"] for test in ended if test["end_scan"] > earliest and test["first_scan"] < shown["scan"][-1]]:
            with h5py.File(daemon.record(number)) as record:
                scans = record["entry/raw/scan"][()]
                force = record["entry/raw/force"][()]
                facts = record["entry/instrument/tester"]
                weight = facts["sled_mass"][()] * facts["gravity"][()]
                rate = float(record["entry/timing/scan_rate_granted"][()])
                marked = record["entry/cycles/peak_time"][()] + scans[0] / rate
            first = scans[0]
            width = int(numpy.median(numpy.diff(shown["scan"])))  # A gap in the line is closer, or wider.
            for scan, low, high in zip(shown["scan"], shown["lowest"], shown["highest"]):
                at = scan - first
                if low is None or at < 0 or at + width > len(scans) or scans[at] != scan:
                    continue
                # Single precision in the record, six decimals on the way.
                part = force[at:at + width] / weight
                self.assertAlmostEqual(low, part.min(), delta=1e-6)
                self.assertAlmostEqual(high, part.max(), delta=1e-6)
                compared += 1
            for slip in shown["slips"]:
                if scans[0] / rate <= slip["peak_time"] <= scans[-1] / rate:
                    # Live and final estimate of a peak differ by less than a scan.
                    self.assertLess(numpy.abs(marked - slip["peak_time"]).min(), 1.0 / rate)
                    peaks += 1
        self.assertGreater(compared, 200)
        self.assertGreater(peaks, 5)
        lowest = numpy.array([numpy.nan if v is None else v for v in shown["lowest"]])
        middle = (lowest + numpy.array([numpy.nan if v is None else v for v in shown["highest"]])) / 2
        slope = numpy.array([numpy.nan if v is None else v for v in shown["slope"]])
        own = numpy.diff(middle) / numpy.diff(shown["time"])
        both = ~numpy.isnan(own) & ~numpy.isnan(slope[1:])
        numpy.testing.assert_allclose(slope[1:][both], own[both], rtol=1e-6, atol=1e-6)
        # Pixels of the line's colour, from the left end to the right.
        self.assertGreater(page.value("""(() => {
          const canvas = document.querySelector('#force canvas'), pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
          let columns = 0;
          for (let x = 0; x < canvas.width; ++x) for (let y = 0; y < canvas.height; ++y) {
            const at = 4 * (y * canvas.width + x);
            if (pixels[at] < 60 && Math.abs(pixels[at + 1] - 100) < 40 && Math.abs(pixels[at + 2] - 160) < 40 && pixels[at + 3] > 100) { ++columns; break; }
          }
          return columns / canvas.width;
        })()"""), 0.5)

    def test_people_plan_begin_mark_and_end_a_test_by_keyboard(self):
        # Slow enough that a pull of 5 s leaves time for all that is done in it.
        daemon = self.daemon('[test]\nbegins = "command"\n', speed=2)
        page = self.page()
        word = "document.getElementById('bench-word').textContent"
        self.assertEqual(page.value(word), "idle")
        shapes = {"idle": page.value("document.getElementById('bench-shape').getAttribute('d')")}
        for name, typed in (("name", "liner 42"), ("operator", "Ada"), ("replicate", "3"), ("pull_speed", "12 in/min")):
            page.value(f"document.querySelector('#plan [name={name}]').focus()")
            page.type(typed)
        page.press("Enter")
        page.until("document.getElementById('message').textContent.startsWith('the plan is set')")
        self.assertEqual(daemon.ask("GET", "/v1/plan")[1]["name"], "liner 42")
        self.assertEqual(page.value("document.querySelector('#plan [name=pull_speed]').value"), "5.08 mm/s")
        page.until("Scope.data.highest.slice(-50).every(force => force < 0.02)")  # A whole pull is to come.
        page.value("document.querySelector('[data-command=start]').focus()")
        page.press("Enter")
        page.until(f"['loading', 'running'].includes({word})")
        page.until(f"{word} === 'running' && Scope.cycles.number.length > 2")
        shapes["running"] = page.value("document.getElementById('bench-shape').getAttribute('d')")
        self.assertEqual(page.value("document.getElementById('regime-word').textContent"), "stick-slip")
        page.value("document.getElementById('mark-text').focus()")
        page.type("sheet moved")
        page.press("Enter")
        page.until("document.getElementById('message').textContent.startsWith('mark: test 1')")
        # Somebody else is told who has the bench, and the page is told why it is refused.
        self.assertRegex(daemon.ask("POST", "/v1/stop", who="bob")[1]["error"], "^page .... has the bench")
        page.value("document.querySelector('[data-command=arm]').focus()")
        page.press("Enter")
        page.until("document.getElementById('message').textContent.startsWith('a test is running')")
        page.value("document.querySelector('[data-command=stop]').focus()")
        page.press("Enter")
        page.until("document.querySelectorAll('#tests tbody tr').length === 1")
        self.assertNotEqual(shapes["idle"], shapes["running"])
        with h5py.File(daemon.record(1)) as record:
            texts = [text.decode() for text in record["entry/events/text"][()]]
            self.assertIn("mark: sheet moved", texts)
            self.assertEqual(record["entry/user/name"].asstr()[()], "Ada")

    def test_limits_void_tests_and_records_that_are_saved(self):
        daemon = self.daemon()
        status, begun = daemon.ask("POST", "/v1/batch", {"name": "liner", "replicates": 1000,
                                                         "limits": {"delta_mu": {"lowest": 0.03, "highest": 0.07}, "mu_k": {"highest": 0.2}}})
        self.assertEqual(status, 200, begun)
        batch = begun["batch"]["id"]
        page = self.page()
        foot = "Object.fromEntries([...document.querySelectorAll('#tests tfoot tr')].map(r => [r.cells[0].textContent, [...r.cells].map(c => c.textContent)]))"
        page.until(f"({foot}).limits && ({foot}).mean")
        self.assertEqual(page.value("document.getElementById('counted').textContent"), f"mean and limits of batch {batch}")
        # The scene has S − K = 0.05 and K = 0.30: one limit is kept, one missed by each test.
        limits = page.value(foot)["limits"]
        names = ["test", "regime"] + [name for name, _ in COLUMNS]
        self.assertEqual(limits[names.index("delta_mu")], "0.0300 … 0.0700 ✓ kept")
        self.assertEqual(limits[names.index("mu_k")], "≤ 0.2000 ✗ missed")
        summary = daemon.ask("GET", "/v1/tests")[1]["summary"]
        self.assertEqual(summary["batch"], batch)
        missed = page.value(f"[...document.querySelectorAll('#tests tbody tr')].filter(r => {summary['tests'][:1]}.includes(Number(r.cells[0].textContent))).map(r => r.cells[{names.index('mu_k')}].textContent)")
        self.assertRegex(missed[0], r"^0\.\d{4} ✗$")
        # What is void does not count, and says why.
        number = summary["tests"][0]
        self.assertEqual(daemon.ask("POST", "/v1/void", {"test": number, "reason": "paper torn"})[0], 200)
        page.until(f"[...document.querySelectorAll('#tests tbody tr.void')].some(r => r.cells[0].textContent === '{number}' && r.textContent.includes('void: paper torn'))")
        summary = daemon.ask("GET", "/v1/tests")[1]["summary"]
        self.assertNotIn(number, summary["tests"])
        # Saved by keyboard, byte for byte.
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            self.browser.save_downloads(folder)
            name = page.value("(() => { const links = document.querySelectorAll('#tests tbody a'), link = links[links.length - 1]; link.focus(); return link.textContent; })()")
            page.press("Enter")
            page.until(f"document.getElementById('message').textContent === 'saved {name}'")
            self.browser.wait_for_download()
            self.assertEqual((pathlib.Path(folder) / name).read_bytes(), (daemon.folder / "records" / name).read_bytes())

    def test_it_fits_it_can_be_reached_by_keys_and_read(self):
        self.daemon()
        for dark in (False, True):
            page = self.page(dark=dark)
            for width, height in ((1280, 720), (820, 1180)):
                page.resize(width, height)
                page.settle()
                self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
            self.assertEqual(page.value("[...document.querySelectorAll('button, input')].filter(e => e.tabIndex < 0).length"), 0)
            self.assertEqual(page.value("[...document.querySelectorAll('input')].filter(e => !e.labels.length).length"), 0)
            pairs = page.value("""[...document.querySelectorAll('h1, h2, .note, dt, dd, td, th, button, input, label, .state, #message')].map(e => {
              let back = e;
              while (back && getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
              return [e.tagName + '.' + e.className, getComputedStyle(e).color, getComputedStyle(back || document.body).backgroundColor];
            })""")
            for name, front, back in pairs:
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), 4.5, f"{name} {front} on {back}, dark {dark}")
            # Each state of the bench and of the regime as well, on the paper.
            paper = rgb(page.value("getComputedStyle(document.body).backgroundColor"))
            for state in ("idle", "armed", "loading", "running", "finishing", "degraded"):
                colour = page.value(f"(() => {{ Tables.bench('{state}'); return getComputedStyle(document.getElementById('bench')).color; }})()")
                self.assertGreaterEqual(contrast(rgb(colour), paper), 4.5, state)

    def test_without_the_token_it_asks_for_it(self):
        self.daemon()
        page = self.browser.open(self.address)
        page.until("!document.getElementById('access').hidden")
        page.value("document.getElementById('token').focus()")
        page.type(self.token)
        page.press("Enter")
        page.until("Scope.data.scan.length > 10")
        self.assertTrue(page.value("document.getElementById('access').hidden"))


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

#!/usr/bin/env python3
"""The history on the live page, in a real browser: records found by their content, with trace, report and file; and the
control charts of the tester.

history_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment pictures of the page are left there.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from chromium import Chromium
from contrast import CONTROLS, TARGETS, TARGET_PX, TEXT, TEXTS, contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

HOSTILE = "liner <b id=bold>42</b> & more"
READY = "document.getElementById('records-dialog').getAttribute('aria-busy') === 'false'"
MESSAGE = "document.getElementById('records-message').textContent"
FILES = "[...document.querySelectorAll('#records-rows a')].map(link => link.textContent)"
LIMIT = 7  # The decision interval of the charts.


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def history(folder):
    """Of 230 tests: noise in control, a zero that rises by four standard deviations with the test 221, omega of the first 50 alone."""
    (folder / "records").mkdir()
    with (folder / "records" / "tester-history.jsonl").open("w", encoding="utf-8") as file:
        for k in range(230):
            scatter = (k * 7919 % 101) / 101 - 0.5
            test = {"at": f"2026-11-20T{k // 60:02}:{k % 60:02}:00+00:00", "event": "test", "uuid": f"00000000-0000-4000-8000-{k:012}",
                    "file": f"20261120T{k // 60:02}{k % 60:02}00Z-{k:04}.h5", "status": "complete", "zero_N": 0.01 + 0.001 * (scatter + (1.2 if k >= 220 else 0)),
                    "noise_N": 0.002 + 0.0001 * scatter, "omega_rad_per_s": 125 + scatter if k < 50 else None}
            text = json.dumps(test)[:-1]
            file.write(f'{text},"crc32c":"{crc32c(text.encode()):08x}"}}\n')


class HistoryPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, dark=False, tests=3, config="", speed=20, **options):
        cache = self.enterContext(tempfile.TemporaryDirectory(prefix="stickslip-"))
        self.daemon = RunningDaemon(self, BUILD, SOURCE, speed=speed, environment={"XDG_CACHE_HOME": cache},
                                    config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n[sample]\nname = "{HOSTILE}"\n{config}', **options)
        self.records = self.daemon.folder / "records"
        token = (self.daemon.folder / "token").read_text().strip()
        page = self.browser.open(f"http://{self.daemon.port_line()}/#token={token}", dark=dark)
        self.addCleanup(page.close)
        page.resize(1280, 720)
        page.until(" && ".join(["Scope.data.scan.length > 100"] + [f"document.getElementById('record-{number}')" for number in range(1, tests + 1)]))
        self.page = page
        return page

    def enter(self, selector, settle=True):
        """By keyboard: what cannot be reached cannot be pressed."""
        self.page.value(f"document.querySelector(\"{selector}\").focus()")
        self.assertTrue(self.page.value(f"document.activeElement === document.querySelector(\"{selector}\")"), selector)
        self.page.press("Enter", settle)

    def find(self, **fields):
        """Fields of the form, one after the other, then Enter. Returns what is said."""
        self.page.value("document.getElementById('records-form').reset()")
        for name, text in fields.items():
            self.page.value(f"(field => {{ field.value = {json.dumps(text)}; field.focus(); }})(document.getElementById('records-form').elements['{name}'])")
        self.page.value("document.getElementById('records-form').requestSubmit()")
        self.page.until(READY)
        return self.page.value(MESSAGE)

    def test_records_are_found_and_lead_to_trace_report_and_file(self):
        # Few tests follow: the copies of the first stay among the newest 100.
        page = self.open(tests=2, speed=60, times={"idle": "2 s", "pull": "5 s", "rest": "900 s"})
        first = self.daemon.record(1)
        copies = [self.records / f"copy {k}.h5" for k in range(105)]
        for copy in copies:
            shutil.copy(first, copy)
        self.enter("#records-open")
        page.until(READY)
        self.assertEqual(page.value("document.activeElement.name"), "sample")
        # The newest first; how many are left out is told.
        count = self.daemon.ask("GET", "/v1/records")[1]["count"]
        self.assertGreaterEqual(count, 107)
        self.assertRegex(page.value(MESSAGE), r"^100 of \d+ records, the newest first; \d+ older ones not shown: narrow the search$")
        files = page.value(FILES)
        self.assertEqual(len(files), 100)
        own = files[:next(k for k, file in enumerate(files) if file.startswith("copy"))]
        self.assertEqual(own, sorted(own, reverse=True))
        self.assertEqual(own[-1], self.daemon.record(2).name)
        self.picture("history")
        # What a record says of itself stays text.
        self.assertEqual(page.value("[document.querySelector('#records-rows td:nth-child(2)').textContent, document.getElementById('bold')]"), [HOSTILE, None])
        # Conditions, as those of `stickslip find`.
        self.assertEqual(self.find(sample="fluting*"), "no record meets these conditions")
        self.assertEqual(page.value("document.getElementById('records-table').hidden"), True)
        self.assertEqual(self.find(**{"mu_s.lowest": "9"}), "no record meets these conditions")
        self.assertRegex(self.find(**{"mu_s.lowest": "0.1", "mu_s.highest": "9", "mu_k.highest": "9", "sample": "liner*"}), r"^100 of \d+ records")
        self.assertEqual(self.find(to="2020-01-01"), "no record meets these conditions")
        # A refusal names field, value and what is right.
        page.value("document.getElementById('records-form').elements.from.type = 'text'")
        self.assertRegex(self.find(**{"from": "2026-13-01"}), r"^from 2026-13-01: ")
        # A void test says so.
        self.assertEqual(self.daemon.run("void", copies[98], "--reason", "<i>torn</i>").returncode, 0)
        self.find(sample="liner*")
        self.assertEqual(page.value("[...document.querySelectorAll('#records-rows tr.void')].map(tr => tr.cells[6].textContent.split(' · ')[1])"), ["void: <i>torn</i>"])
        # By keyboard to the trace of a record that the list of tests does not have, and back.
        name = copies[99].name
        self.enter(f"button[id='trace-{name}']")
        page.until("document.getElementById('trace-dialog').getAttribute('aria-busy') === 'false'")
        self.assertEqual(page.value("document.getElementById('trace-title').textContent"), f"Trace of {name}")
        trace = page.value("Trace.shown().tests[0].trace")
        self.assertEqual(trace["scan_count"], self.daemon.ask("GET", "/v1/records/copy%207.h5/trace")[1]["scan_count"])
        self.picture("history-trace")
        page.press("Escape")
        self.assertEqual(page.value("document.activeElement.id"), f"trace-{name}")
        # Its file.
        with tempfile.TemporaryDirectory(prefix="stickslip-") as downloads:
            self.browser.save_downloads(downloads)
            self.enter(f"a[id='found-{name}']")
            self.assertEqual(self.browser.wait_for_download().read_bytes(), first.read_bytes())
        # The report on it, in a window of its own.
        self.enter(f"button[aria-label='show the report on {name}']", settle=False)
        report = self.browser.opened("/page/report")
        report.until("document.readyState === 'complete' && document.body.textContent.includes('copy 99.h5')")
        report.close()
        page.until(f"{MESSAGE} === 'the report on {name} stands in a window of its own'")
        page.press("Escape")
        self.assertEqual(page.value("document.activeElement.id"), "records-open")
        # The browser tells of the one search that was refused.
        self.assertEqual([said for said in page.complaints() if "400 (Bad Request)" not in said], [])

    def charts(self):
        return {name: one for name, one in self.page.value("""[...Trend.shown()].map(([name, {u, chart}]) => [name, {columns: [...u.data].map(column => [...column]), chart,
          word: document.getElementById(`trend-${name}-word`).textContent, told: document.getElementById(`trend-${name}-told`).textContent,
          label: document.getElementById(`trend-${name}-chart`).getAttribute('aria-label')}])""")}

    def test_control_charts_are_drawn_with_their_limits_and_follow_a_restart(self):
        page = self.open(tests=0, config='[test]\nbegins = "command"\n', prepare=history)
        page.until("document.getElementById('trend-said').textContent === 'alarm: zero; 1 in control; 1 learning; 4 off'")
        self.enter("#trend > summary")
        page.until("Trend.shown().size === 7")
        charts = self.charts()
        told = {chart["chart"]: chart for chart in self.daemon.ask("GET", "/v1/trend")[1]["charts"]}
        self.assertEqual(list(charts), list(told))
        self.assertEqual({name: charts[name]["word"] for name in ("reference", "omega", "zero", "noise")}, {"reference": "off", "omega": "learning", "zero": "alarm", "noise": "in control"})
        zero = charts["zero"]
        tests, upper, lower = zero["columns"]
        self.assertEqual((tests[-1], tests), (230, list(range(31, 231))))
        self.assertEqual((upper, [-height for height in lower]), (zero["chart"]["points"]["upper"], zero["chart"]["points"]["lower"]))
        self.assertGreater(max(upper), LIMIT)
        self.assertLess(max(map(abs, charts["noise"]["columns"][1] + charts["noise"]["columns"][2])), LIMIT)
        self.assertRegex(zero["told"], r"^rose by 0\.00\d+ with the test of 2026-11-20 .*; 230 tests, mean 0\.0\d+, ")
        self.assertRegex(zero["label"], r"^zero, N: alarm; rose by .*; its CUSUM is at \d+\.\d up and \d+\.\d down, an alarm above 7$")
        self.assertRegex(charts["reference"]["told"], r"^no reference paper is configured")
        # The limits stand in each chart, where they are.
        drawn = page.value("""[...Trend.shown().values()].map(({u}) => { const probe = document.createElement('canvas').getContext('2d');
          probe.fillStyle = Chart.colour('--degraded'); probe.fillRect(0, 0, 1, 1);
          const want = [...probe.getImageData(0, 0, 1, 1).data];
          return [7, -7].map(limit => { const pixels = u.ctx.getImageData(u.bbox.left, Math.round(u.valToPos(limit, 'y', true)) - 1, u.bbox.width, 3).data;
            let like = 0; for (let k = 0; k < pixels.length; k += 4) like += Math.abs(pixels[k] - want[0]) + Math.abs(pixels[k + 1] - want[1]) + Math.abs(pixels[k + 2] - want[2]) < 60;
            return like / u.bbox.width; }); })""")
        self.assertTrue(all(part > 0.3 for both in drawn for part in both), drawn)
        page.value("document.getElementById('trend').scrollIntoView()")
        self.picture("trend")
        # A restart beside the daemon is there without a further test.
        done = subprocess.run([BUILD / "bin" / "stickslip", "trend", str(self.records), "--restart", "zero", "--reason", "new load cell"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        page.until("document.getElementById('trend-zero-word').textContent === 'off' && document.getElementById('trend-said').textContent === 'no alarm; 1 in control; 1 learning; 5 off'")
        self.assertEqual((self.charts()["zero"]["told"], self.charts()["zero"]["columns"][0]), ("no test since the restart", []))
        self.assertEqual([said for said in page.complaints() if "willReadFrequently" not in said], [])

    def test_it_fits_and_can_be_read(self):
        for dark in (False, True):
            page = self.open(dark=dark, tests=1, prepare=history)
            for opener, part in (("#trend > summary", "#trend"), ("#records-open", "#records-dialog")):
                self.enter(opener)
                page.until("Trend.shown().size === 7" if part == "#trend" else READY)
                for width, height in ((1280, 720), (390, 844)):
                    page.resize(width, height)
                    self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
                    self.assertLessEqual(page.value(f"(e => e.scrollWidth - e.clientWidth)(document.querySelector('{part}'))"), 0)
                    page.value(f"document.querySelector('{part}').scrollIntoView()")
                    self.picture(f"{part[1:]}-{width}{'-dark' if dark else ''}")
                for name, front, back in page.value(f"{TEXTS}('{part} *')"):
                    self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"{name} {front} on {back}, dark {dark}")
                for name, width, height in page.value(f"{TARGETS}('{part} :is({CONTROLS})')"):
                    self.assertGreaterEqual(min(width, height), TARGET_PX, name)
                page.resize(1280, 720)

    def picture(self, name):
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            self.page.screenshot(pathlib.Path(folder) / f"{name}.png")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

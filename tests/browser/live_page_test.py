#!/usr/bin/env python3
"""The live page of a running daemon in a real browser: every number that it shows against the record's.

live_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment a picture of the page is left there.
"""

import functools
import math
import os
import pathlib
import queue
import shutil
import sys
import tempfile
import threading
import unittest

import h5py
import numpy

from chromium import Chromium
from contrast import CONTROLS, MARK, TARGETS, TARGET_PX, TEXT, TEXTS, colours, contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import PATIENT, RunningDaemon  # noqa: E402
from service_manager import TIMEOUT_S  # noqa: E402
import uncertain  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

# Of the table of tests, after number and regime.
COLUMNS = [("delta_mu", 4), ("mu_s", 4), ("mu_k", 4), ("static_coefficient", 4), ("kinetic_coefficient", 4), ("amplitude", 4),
           ("oscillation_frequency", 3), ("cycle_count", 0)]
WITH_ERRORS = {"delta_mu", "mu_s", "mu_k", "static_coefficient", "kinetic_coefficient"}


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


def shown_in(record, name, digits):
    """Text of a cell of the table of tests."""
    value = float(record[f"entry/results/{name}"][()])
    return uncertain.of(record, name, digits) if name in WITH_ERRORS else uncertain.text(value, decimals=digits)


def until_ended(frames, test):
    """Frames until a test has ended."""
    for frame in frames:
        yield frame
        if frame["type"] == "test-ended" and frame["test"] == test:
            return


class LivePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def daemon(self, config="", speed=20, **options):
        daemon = RunningDaemon(self, BUILD, SOURCE, speed=speed, **options, config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n{config}')
        self.address = f"http://{daemon.port_line()}/"
        self.token = (daemon.folder / "token").read_text().strip()
        return daemon

    def scene(self, name, speed, texts=()):
        """A board that plays a shipped scene, with texts of it replaced."""
        text = (SOURCE / "config" / "scenes" / f"{name}.toml").read_text(encoding="utf-8")
        for old, new in texts:
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, new)
        place = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(place.cleanup)
        file = pathlib.Path(place.name) / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return f'[board]\ndriver = "simulated"\nclock_speed = {speed}\n[board.simulated]\nscenes = ["{file}"]\nrepeats = 0\n'

    def page(self, dark=False, touch=False):
        page = self.browser.open(f"{self.address}#token={self.token}", dark=dark, touch=touch)
        self.addCleanup(page.close)
        page.until("document.querySelectorAll('#health dd').length > 5 && Scope.data.scan.length > 100")
        return page

    def test_each_number_in_the_table_is_the_records_to_the_digits_shown(self):
        daemon = self.daemon(speed=4)  # So slow that the page is never a test behind for long.
        page = self.page()
        page.until("[...document.querySelectorAll('#tests tbody td:last-child')].filter(c => c.textContent.endsWith('.h5')).length >= 3")
        # The tester goes on meanwhile: what the page shows is compared with the daemon's answer about the same tests.
        for _ in range(200):
            rows, foot, titles = page.value("[...['#tests tbody tr', '#tests thead tr:not(:first-child), #tests tfoot tr'].map(s => [...document.querySelectorAll(s)].map(r => [...r.cells].map(c => c.textContent))), "
                                            "[...document.querySelectorAll('#tests tbody tr')].map(r => r.cells[1].title)]")
            summary = daemon.ask("GET", "/v1/tests")[1]["summary"]
            if sorted(summary["tests"]) == sorted(int(row[0]) for row in rows):
                break
        else:
            self.fail(f"the page never showed the tests that the daemon had: {summary['tests']}")
        compared, values = 0, {name: [] for name, _ in COLUMNS}
        for row, title in zip(rows, titles):
            test = next(t for t in daemon.ask("GET", "/v1/tests")[1]["tests"] if t["number"] == int(row[0]))
            file = daemon.record(int(row[0])) if not row[-1].endswith(".h5") else daemon.folder / test["file"]
            with h5py.File(file) as record:
                # With its first finding, which a sound bench may have by chance.
                found = test["results"]["coded_findings"]
                more = f" + {len(found) - 1}" if len(found) > 1 else ""
                self.assertEqual(row[1], record["entry/results/regime"].asstr()[()] + (f" · {found[0]['code']}{more}" if found else ""))
                self.assertEqual(title, "\n".join([f"rung: {record['entry/results/rung'].asstr()[()]}", *(finding["text"] for finding in found)]))
                for cell, (name, digits) in zip(row[2:], COLUMNS):
                    value = float(record[f"entry/results/{name}"][()])
                    self.assertEqual(cell, shown_in(record, name, digits), name)
                    if not numpy.isnan(value):
                        values[name].append(value)
                        compared += 1
                self.assertEqual(row[-3], record["entry/process/end_cause"].asstr()[()])
        self.assertGreaterEqual(compared, 3 * (len(COLUMNS) - 1))
        def half_width(v):
            return student_t(len(v) - 1) * numpy.std(v, ddof=1) / numpy.sqrt(len(v))
        self.assertEqual([row[0] for row in foot], [f"mean, n = {len(summary['tests'])}", "by cycle", "r = 2.8 s", "95 % from", "95 % to", "lowest", "highest"])
        pooled = summary["delta_mu_by_cycle"]
        at = 2 + [name for name, _ in COLUMNS].index("delta_mu")
        self.assertEqual(foot[1][at], uncertain.text(pooled["value"], pooled["standard_error"], pooled["systematic_uncertainty"]))
        for row, of in zip([foot[0], *foot[2:]], (numpy.mean, lambda v: 2.8 * numpy.std(v, ddof=1), lambda v: numpy.mean(v) - half_width(v),
                                  lambda v: numpy.mean(v) + half_width(v), numpy.min, numpy.max), strict=True):
            for cell, (name, digits) in zip(row[2:], COLUMNS[:-1]):
                self.assertAlmostEqual(float(cell), of(values[name]), delta=0.5001 * 10.0 ** -digits, msg=f"{row[0]} of {name}")
        self.assertEqual(page.complaints(), [])
        self.assertTrue(all(url.startswith(self.address) or url.startswith(("data:", "ws:")) for url in page.requests()), page.requests())
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.screenshot(pathlib.Path(folder) / "live.png")

    def test_both_errors_are_shown_and_the_table_is_no_wider_than_the_window(self):
        # By turning points S - K, S and K have a systematic part.
        daemon = self.daemon('[analysis]\nestimator = "turning-points"\n')
        page = self.page()
        page.resize(1280, 720)
        page.until("document.querySelector('#tests tbody td:last-child a')")
        row = page.value("[...document.querySelector('#tests tbody td:last-child a').closest('tr').cells].map(c => c.textContent)")
        with h5py.File(daemon.folder / "records" / row[-1]) as record:
            for cell, name in zip(row[2:5], ("delta_mu", "mu_s", "mu_k")):
                self.assertIn("systematic_uncertainty", record[f"entry/results/{name}"].attrs)
                self.assertEqual(cell, uncertain.of(record, name), name)
        self.assertEqual(page.value("document.getElementById('errors').textContent"), "± standard error ± systematic part (calibration, corrections)")
        wide = page.value("[document.documentElement.scrollWidth, innerWidth, ...(t => [t.scrollWidth, t.clientWidth])(document.getElementById('tests').parentElement)]")
        self.assertLessEqual(wide[0], wide[1])
        self.assertLessEqual(wide[2], wide[3])
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.screenshot(pathlib.Path(folder) / "live-errors.png")

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

    def listen(self, daemon):
        """Frames of the live stream, kept from now on: read at once, for the daemon drops what waits too long."""
        process, frames = daemon.watch()
        kept = queue.Queue()
        reader = threading.Thread(target=lambda: [kept.put(frame) for frame in frames])
        reader.start()
        self.addCleanup(process.stdout.close)
        self.addCleanup(reader.join)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return iter(lambda: kept.get(timeout=TIMEOUT_S), None)

    def start(self, page):
        """A test, where a whole pull is to come."""
        page.until("Scope.data.highest.slice(-50).every(force => force < 0.02)")
        page.value("document.querySelector('[data-command=start]').focus()")
        page.press("Enter")
        page.until("['loading', 'running'].includes(document.getElementById('bench-word').textContent)")

    def stop(self, page, tests):
        page.value("document.querySelector('[data-command=stop]').focus()")
        page.press("Enter")
        page.until(f"document.querySelectorAll('#tests tbody tr').length === {tests}")

    def check_cycles(self, shown, record, frames):
        """The strip, the peaks and the remark under the strip. Peaks and falls are measured once; S − K is estimated again at the end,
        with what the whole test says of the motion, which the first cycles do not know yet: four standard errors of both."""
        cycles = {name: column[()] for name, column in record["entry/cycles"].items() if hasattr(column, "shape")}
        first = record["entry/raw/scan"][0]
        rate = float(record["entry/timing/scan_rate_granted"][()])
        numbers = shown["cycles"]["number"]
        told = {frame["number"]: frame for frame in frames}
        self.assertGreater(len(numbers), 10)
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
        for number, delta, amplitude in zip(numbers, shown["cycles"]["delta"], shown["cycles"]["amplitude"], strict=True):
            self.assertEqual(cycles["cycle"][number], number)
            self.assertAlmostEqual(amplitude, cycles["force_drop"][number] / 2, delta=1e-12)
            self.assertEqual(delta, told[number]["delta_mu"])
            if delta is not None:
                self.assertAlmostEqual(delta, cycles["delta_mu"][number], delta=4 * math.hypot(cycles["delta_mu_standard_error"][number], told[number]["delta_mu_standard_error"] or 0))
        peaks = [slip for slip in shown["slips"] if first / rate <= slip["peak_time"]]
        self.assertEqual(len(peaks), len(numbers))
        for number, slip in zip(numbers, peaks):
            self.assertAlmostEqual(slip["peak"], cycles["peak"][number], delta=1e-12)
            self.assertAlmostEqual(slip["peak_time"], first / rate + cycles["peak_time"][number], delta=1e-9)
        last = told[numbers[-1]]
        delta = "–" if last["delta_mu"] is None else f"{last['delta_mu']:.4f}"
        self.assertEqual(shown["cycle"], f"cycle {numbers[-1]}: peak {cycles['peak'][numbers[-1]]:.4f}, S − K {delta}")

    SHOWN = "({cycles: Scope.cycles, slips: Scope.slips, spikes: Scope.spikes, cycle: document.getElementById('cycle').textContent, scan: Scope.data.scan, step: Scope.data.scan.at(-1) - Scope.data.scan.at(-2)})"

    def test_cycles_peaks_and_spikes_are_the_records(self):
        # Spikes of one size, four a second, far above noise. At this speed a part of the scope has two scans.
        daemon = self.daemon('[test]\nbegins = "command"\n', board=self.scene("drift-hum-and-spikes", 2, texts=[
            ('rate = "1 1/s"', 'rate = "4 1/s"'), ('sizes = "exponential"', 'sizes = "fixed"')]))
        frames = self.listen(daemon)
        page = self.page()
        self.start(page)
        page.until("Scope.cycles.number.length > 40")
        self.stop(page, 1)
        record = daemon.record(1)
        cycles = [frame for frame in until_ended(frames, 1) if frame["type"] == "cycle"]
        with h5py.File(record) as file:
            scans, flags = file["entry/raw/scan"][()], file["entry/raw/flags"][()]
            spikes = scans[(flags & 1) != 0]
            force = file["entry/raw/force"][()] / (file["entry/instrument/tester/sled_mass"][()] * file["entry/instrument/tester/gravity"][()])
            page.until(f"Scope.data.scan.at(-1) > {scans[-1]}")
            shown = page.value(self.SHOWN)
            self.check_cycles(shown, file, cycles)
        # Each spike, with the force of its scan, though a part of the scope has two scans.
        self.assertEqual(shown["step"], 2)
        self.assertGreater(len(spikes), 3)
        self.assertEqual([spike["scan"] for spike in shown["spikes"]], list(spikes))
        for spike in shown["spikes"]:
            self.assertAlmostEqual(spike["value"], force[spike["scan"] - scans[0]], delta=1e-7)  # A record's force is of single precision.
        # They are drawn, in the colours of the legend: where the strokes of the cross meet, and in the middle of the disc.
        drawn = page.value("""(() => {
          const probe = document.createElement('canvas').getContext('2d'), style = getComputedStyle(document.documentElement), u = Scope.force;
          const rgba = name => { probe.fillStyle = style.getPropertyValue(name); probe.fillRect(0, 0, 1, 1); return [...probe.getImageData(0, 0, 1, 1).data]; };
          const at = (time, value) => [...u.ctx.getImageData(Math.round(u.valToPos(time, 'x', true)), Math.round(u.valToPos(value, 'y', true)), 1, 1).data];
          const inView = time => time > u.scales.x.min + 0.2 && time < u.scales.x.max - 0.2;
          return {mark: rgba('--mark'), spike: rgba('--spike'), peaks: Scope.slips.filter(s => s.captured && inView(s.peak_time)).map(s => at(s.peak_time, s.peak)),
            spikes: Scope.spikes.filter(s => inView(s.time)).map(s => at(s.time, s.value))};
        })()""")
        for kind, colour in (("peaks", "mark"), ("spikes", "spike")):
            self.assertGreater(len(drawn[kind]), 2, kind)
            alike = [pixel for pixel in drawn[kind] if max(abs(a - b) for a, b in zip(pixel, drawn[colour])) < 60]
            self.assertGreaterEqual(len(alike), 0.8 * len(drawn[kind]), (kind, drawn))  # One may lie on another.

    def test_the_charts_stand_still_while_paused_tell_what_is_under_the_cursor_and_draw_s_and_k(self):
        daemon = self.daemon(speed=5)
        page = self.page()
        page.until("document.querySelectorAll('#tests tbody tr').length >= 1 && Scope.data.scan.length > 1000")
        ends = "[Scope.force.scales.x.max, Scope.force.data[0].length]"
        page.click("#pause")
        self.assertEqual(page.value("document.getElementById('pause').getAttribute('aria-pressed')"), "true")
        still, scan = page.value(ends), page.value("Scope.data.scan.at(-1)")
        page.until(f"Scope.data.scan.at(-1) > {scan} + 100")
        page.settle()
        self.assertEqual(page.value(ends)[0], still[0])
        # The part of the middle of the chart, by its own column.
        page.drag("#force .u-over", 0.5, 0.5)
        told = page.value("[document.getElementById('force-at').textContent, Scope.force.cursor.idx, Scope.force.data]")
        time, low, high = (column[told[1]] for column in told[2])
        self.assertEqual(told[0], f"{time:.2f} s: {low:.4f}{'' if low == high else f' … {high:.4f}'} · ")
        page.click("#pause")
        page.until(f"Scope.force.scales.x.max > {still[0]}")
        # Lines of S and K: those of the last test, once it has ended.
        results = daemon.ask("GET", "/v1/tests")[1]["tests"]
        levels = page.value("Scope.levels()")
        self.assertAlmostEqual(levels["S"], results[-1]["results"]["mu_s"], delta=0.02)
        self.assertAlmostEqual(levels["K"], results[-1]["results"]["mu_k"], delta=0.02)
        drawn = page.value("""(() => {
          const u = Scope.force, probe = document.createElement('canvas').getContext('2d'), {S, K} = Scope.levels();
          return [[S, '--static'], [K, '--kinetic']].map(([level, name]) => {
            probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(name); probe.fillRect(0, 0, 1, 1);
            const want = [...probe.getImageData(0, 0, 1, 1).data];
            const y = Math.round(u.valToPos(level, 'y', true)), pixels = u.ctx.getImageData(u.bbox.left, y - 1, u.bbox.width, 3).data;
            let like = 0;
            for (let k = 0; k < pixels.length; k += 4) like += Math.abs(pixels[k] - want[0]) + Math.abs(pixels[k + 1] - want[1]) + Math.abs(pixels[k + 2] - want[2]) < 60 && pixels[k + 3] > 100;
            return like / u.bbox.width;
          });
        })()""")
        self.assertTrue(all(part > 0.1 for part in drawn), drawn)

    def test_wheel_and_keys_change_the_time_in_view(self):
        self.daemon(speed=1)
        page = self.page()
        width, words = "Scope.force.scales.x.max - Scope.force.scales.x.min", "document.getElementById('window').textContent"
        page.until(f"Math.abs({width} - 10) < 1e-6")
        # The latest scan stays at the right end.
        page.wheel("#force .u-over", 0.2, -120)
        page.until(f"Math.abs({width} - 5) < 1e-6 && {words} === '5 s'")
        self.assertAlmostEqual(*page.value("[Scope.force.scales.x.max, Scope.force.data[0].at(-1)]"), delta=1)  # More may have come since it was drawn.
        self.assertEqual(*page.value("[Scope.slope, Scope.force].map(u => u.scales.x.max - u.scales.x.min)"))
        page.value("document.getElementById('force').focus()")
        page.press("-")
        page.press("-")
        page.until(f"Math.abs({width} - 20) < 1e-6 && {words} === '20 s'")
        page.press("+")
        page.click("#zoom-in")
        page.until(f"Math.abs({width} - 5) < 1e-6")
        # While the charts stand still what is under the cursor does.
        page.until("Scope.data.time.at(-1) > 6")
        page.click("#pause")
        before = page.value("[Scope.force.scales.x.min, Scope.force.scales.x.max]")
        scans = page.value("Scope.force.data[0].length")
        page.wheel("#force .u-over", 0.25, -120)
        page.until(f"Math.abs({width} - 2) < 1e-6")
        after = page.value("[Scope.force.scales.x.min, Scope.force.scales.x.max]")
        self.assertAlmostEqual(before[0] + 0.25 * 5, after[0] + 0.25 * 2, delta=0.02)
        self.assertEqual(page.value("Scope.force.data[0].length"), scans)
        # At the last step the wheel is the page's.
        for _ in range(6):
            page.press("+")
        page.until(f"{words} === '0.5 s'")
        page.resize(1280, 300)
        page.wheel("#force .u-over", 0.25, -120)
        self.assertEqual(page.value(words), "0.5 s")
        self.assertEqual(page.complaints(), [])

    def test_the_health_list_is_the_status_to_the_digits_shown(self):
        # With scans that go missing; in the world's time, by which alone the rate is measured.
        daemon = self.daemon(board=self.scene("clock-and-missing-scans", 1))
        page = self.page()
        page.value("(() => { const own = Tables.health; Tables.health = status => { own(status); window.told = status; }; })()")
        page.until("document.querySelectorAll('#tests tbody tr').length >= 2 && window.told?.gap_count > 2 && window.told.scan_rate_measured")
        earlier = daemon.ask("GET", "/v1/status")[1]
        page.until(f"window.told.scan_count > {earlier['scan_count']}")
        shown, told = page.value("[Object.fromEntries([...document.querySelectorAll('#health dt')].map(dt => [dt.textContent, dt.nextSibling.textContent])), window.told]")
        later = daemon.ask("GET", "/v1/status")[1]

        def number(name, value, decimals, unit):
            digits, _, rest = shown[name].partition(" ")
            self.assertEqual(rest, unit, name)
            self.assertEqual(len(digits.partition(".")[2]), decimals, name)
            self.assertAlmostEqual(float(digits), value, delta=0.5001 * 10.0 ** -decimals, msg=name)
        self.assertEqual(shown["daemon"], told["state"])
        self.assertEqual(shown["board"], told["board"]["name"])
        self.assertEqual(shown["rate"], "350 Hz")
        self.assertEqual(told["board"]["scan_rate_granted"], 350)
        number("measured", told["scan_rate_measured"]["value"], 4, "Hz")
        self.assertEqual(shown["load cell"], "as configured")
        self.assertEqual(shown["scans"], str(told["scan_count"]))
        self.assertEqual(shown["gaps"], f"{told['gap_count']} ({told['lost_scan_count']} scans)")
        number("disk", told["storage"]["room_h"], 0, "h")
        number("worst read", 1000 * told["read_latency"]["largest"], 2, "ms")
        number("worst commit", 1000 * told["commit_time"]["largest"], 1, "ms")
        number("ring", 100 * told["ring"]["high_water_block_count"] / told["ring"]["capacity_block_count"], 1, "% at most")
        self.assertEqual(shown["tests"], str(told["test_count"]))
        self.assertEqual(shown["readers"], f"{told['live_clients']['count']}, {told['live_clients']['dropped_frame_count']} dropped")
        # What it was told is what anybody is told who asks: between two answers, as these numbers only grow.
        for of in (lambda s: s["scan_count"], lambda s: s["gap_count"], lambda s: s["lost_scan_count"], lambda s: s["test_count"], lambda s: s["read_latency"]["largest"],
                   lambda s: s["commit_time"]["largest"], lambda s: s["ring"]["high_water_block_count"]):
            self.assertLessEqual(of(earlier), of(told))
            self.assertLessEqual(of(told), of(later))
        self.assertEqual(earlier["board"], told["board"])
        # The records: the rate, and the gaps inside the tests. Between tests scans go missing as well.
        ended = [test for test in daemon.ask("GET", "/v1/tests")[1]["tests"] if test["number"] <= told["test_count"]]
        self.assertEqual(len(ended), told["test_count"])
        gaps = lost = 0
        for test in ended:
            with h5py.File(daemon.record(test["number"])) as record:
                self.assertEqual(float(record["entry/timing/scan_rate_granted"][()]), told["board"]["scan_rate_granted"])
                missing = numpy.diff(record["entry/raw/scan"][()]) - 1
                gaps += numpy.count_nonzero(missing)
                lost += missing.sum()
        self.assertGreater(gaps, 0)
        self.assertTrue(gaps <= told["gap_count"] and lost <= told["lost_scan_count"], (gaps, lost, told["gap_count"], told["lost_scan_count"]))

    def test_a_page_that_is_reloaded_in_the_middle_of_a_test_goes_on(self):
        # The second test begins when the pull of the first has ended.
        daemon = self.daemon('[test]\nbegins = "command"\n', speed=2, times={**PATIENT, "pull": "30 s"})
        frames = self.listen(daemon)
        page = self.page()
        self.start(page)
        page.until("Scope.cycles.number.length > 20")
        self.stop(page, 1)
        page.until("document.getElementById('record-1')")
        self.start(page)
        page.until("Scope.cycles.number.length > 20 && document.getElementById('regime-word').textContent === 'stick-slip'")
        table = "[...document.querySelectorAll('#tests tbody tr')].map(r => [...r.cells].map(c => c.textContent))"
        before = page.value(f"({{table: {table}, cycle: Scope.cycles.number.at(-1), scan: Scope.data.scan.at(-1), name: sessionStorage.getItem('name')}})")
        page.reload()
        # The state and the table at once, and the scope is full with its first frame; without the token in the address.
        page.until("document.getElementById('bench-word').textContent === 'running' && Scope.data.scan.length > 100 && Scope.cycles.number.length > 15")
        after = page.value(f"({{table: {table}, cycle: Scope.cycles.number[0], scan: Scope.data.scan[0], name: sessionStorage.getItem('name'), holder: document.getElementById('holder').textContent}})")
        self.assertEqual(after["table"], before["table"])
        self.assertLess(after["cycle"], before["cycle"])
        self.assertLess(after["scan"], before["scan"] - 350)  # A second and more.
        self.assertEqual(page.value(f"Scope.data.lowest.filter((low, k) => low === null && Scope.data.scan[k] > {before['scan']}).length"), 0)
        self.assertEqual((after["name"], after["holder"]), (before["name"], "this page commands"))
        self.assertEqual(page.value("document.getElementById('regime-word').textContent"), "stick-slip")
        self.assertEqual(page.value("document.getElementById('message').textContent"), "")
        self.stop(page, 2)
        page.until("document.getElementById('record-2')")
        rows = page.value(table)
        self.assertEqual(rows[1], before["table"][0])
        cycles = [frame for frame in until_ended(frames, 2) if frame["type"] == "cycle" and frame["test"] == 2]
        with h5py.File(daemon.record(2)) as record:
            for cell, column in zip(rows[0][2:], COLUMNS):
                self.assertEqual(cell, shown_in(record, *column), column)
            self.check_cycles(page.value(self.SHOWN), record, cycles)
            scans, force = record["entry/raw/scan"][()], record["entry/raw/force"][()]
            weight = record["entry/instrument/tester/sled_mass"][()] * record["entry/instrument/tester/gravity"][()]
            shown = page.value("({scan: Scope.data.scan, lowest: Scope.data.lowest, highest: Scope.data.highest})")
            step, compared = int(numpy.median(numpy.diff(shown["scan"]))), 0
            for scan, low, high in zip(shown["scan"], shown["lowest"], shown["highest"], strict=True):
                at = scan - scans[0]
                if low is None or at < 0 or at + step > len(scans):
                    continue
                part = force[at:at + step] / weight
                self.assertAlmostEqual(low, part.min(), delta=1e-6)
                self.assertAlmostEqual(high, part.max(), delta=1e-6)
                compared += 1
            self.assertGreater(compared, 100)
        self.assertEqual(page.complaints(), [])

    def test_people_plan_begin_mark_and_end_a_test_by_keyboard(self):
        # Slow enough that a pull of 5 s leaves time for all that is done in it.
        daemon = self.daemon('[test]\nbegins = "command"\n', speed=2)
        page = self.page()
        word = "document.getElementById('bench-word').textContent"
        self.assertEqual(page.value(word), "idle")
        shapes = {"idle": page.value("document.getElementById('bench-shape').getAttribute('d')")}
        # They stand in a drawer, below the answer.
        self.assertFalse(page.value("document.querySelector('#plan').checkVisibility()"))
        page.value("document.querySelector('#more > summary').focus()")
        page.press("Enter")
        for name, typed in (("name", "liner 42"), ("operator", "Ada"), ("replicate", "3"), ("pull_speed", "12 in/min"), ("facts", "room=lab 2"),
                            ("fact.temperature", "23 degC")):
            page.value(f"document.querySelector('#plan [name=\"{name}\"]').focus()")
            page.type(typed)
        page.press("Enter")
        page.until_said("the plan holds")
        self.assertEqual(daemon.ask("GET", "/v1/plan")[1]["name"], "liner 42")
        self.assertEqual(daemon.ask("GET", "/v1/plan")[1]["facts"], {"temperature": "23 degC", "room": "lab 2"})
        # Who changes one field leaves what others have set meanwhile.
        daemon.ask("PUT", "/v1/plan", {**{key: value for key, value in daemon.ask("GET", "/v1/plan")[1].items() if key != "pull_speed"}, "pull_speed": "12 in/min",
                                       "facts": {"lot": "7", "door": "a=b"}}, who=daemon.ask("GET", "/v1/controller")[1]["controller"])
        page.value("document.querySelector('#plan [name=\"fact.humidity\"]').focus()")
        page.type("50 %")
        page.press("Enter")
        page.until("document.querySelector('#plan [name=facts]').value === 'door=a=b'")
        self.assertEqual(daemon.ask("GET", "/v1/plan")[1]["facts"], {"lot": "7", "door": "a=b", "humidity": "50 %"})
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.value("document.querySelector('#plan').scrollIntoView()")
            page.screenshot(pathlib.Path(folder) / "plan.png")
        self.assertEqual(page.value("document.getElementById('planned').textContent"), "liner 42, 5.08 mm/s, Ada")
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
        page.until_said("mark: test 1")
        # Somebody else is told who has the bench, and the page is told why it is refused.
        self.assertRegex(daemon.ask("POST", "/v1/stop", who="bob")[1]["error"], "^page .... has the bench")
        page.value("document.querySelector('[data-command=arm]').focus()")
        page.press("Enter")
        page.until_said("a test is running")
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
        foot = "Object.fromEntries([...document.querySelectorAll('#tests thead tr:not(:first-child)')].map(r => [r.cells[0].textContent.split(',')[0], [...r.cells].map(c => c.textContent)]))"
        page.until(f"({foot}).limits && ({foot}).mean")
        self.assertEqual(page.value("document.getElementById('counted').textContent"), f"● mean and limits of batch {batch}")
        # The scene has S − K = 0.05 and K = 0.30: one limit is kept, one missed by each test.
        limits = page.value(foot)["limits"]
        names = ["test", "sample", "grade", "speed", "replicate", "regime"] + [name for name, _ in COLUMNS]
        self.assertEqual(limits[names.index("delta_mu")], "0.0300 … 0.0700 ✓ kept")
        self.assertEqual(limits[names.index("mu_k")], "≤ 0.2000 ✗ missed")
        summary = daemon.ask("GET", "/v1/tests")[1]["summary"]
        self.assertEqual(summary["batch"], batch)
        missed = page.value(f"[...document.querySelectorAll('#tests tbody tr')].filter(r => {summary['tests'][:1]}.includes(Number(r.cells[0].textContent))).map(r => r.cells[{names.index('mu_k')}].textContent)")
        self.assertRegex(missed[0], r"^0\.\d{4,6} ✗( ± |$)")
        # What is void does not count, and says why.
        number = summary["tests"][0]
        self.assertEqual(daemon.ask("POST", "/v1/void", {"test": number, "reason": "paper torn"})[0], 200)
        page.until(f"[...document.querySelectorAll('#tests tbody tr.void')].some(r => r.cells[0].textContent === '{number}' && r.textContent.includes('void: paper torn'))")
        summary = daemon.ask("GET", "/v1/tests")[1]["summary"]
        self.assertNotIn(number, summary["tests"])
        # Saved by keyboard, byte for byte: the newest, since the page shows the latest 200 and the tester goes on.
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            self.browser.save_downloads(folder)
            name = page.value("(() => { const link = document.querySelector('#tests tbody a'); link.focus(); return link.textContent; })()")
            page.press("Enter")
            page.until_said(f"saved {name}")
            self.browser.wait_for_download()
            self.assertEqual((pathlib.Path(folder) / name).read_bytes(), (daemon.folder / "records" / name).read_bytes())

    def test_it_fits_it_can_be_reached_by_keys_and_read(self):
        self.daemon()
        for dark in (False, True):
            page = self.page(dark=dark)
            page.value("document.getElementById('more').open = true")
            for width, height in ((1280, 720), (820, 1180), (390, 844)):
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
            for name, front, back in page.value(f"{TEXTS}('body, body *')"):
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"{name} {front} on {back}, dark {dark}")
            for name, front, back in page.value("[...document.querySelectorAll('input[placeholder]')].map(e => [e.id || e.name, getComputedStyle(e, '::placeholder').color, getComputedStyle(e).backgroundColor])"):
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"what may be typed into {name}, dark {dark}")
            regimes = ("stick-slip", "ring-down", "mixed", "inertial-oscillation", "steady-sliding", "undecided")
            shapes = {page.value(f"(() => {{ Tables.regime('{word}'); return document.getElementById('regime-shape').getAttribute('d'); }})()") for word in regimes}
            self.assertEqual(len(shapes), len(regimes))
            # Each state of the bench and each regime as well, on the paper.
            paper = rgb(page.value("getComputedStyle(document.body).backgroundColor"))
            for kind, words in (("bench", ("idle", "armed", "loading", "running", "finishing", "degraded", "not connected")),
                                ("regime", regimes)):
                for word in words:
                    colour, back = page.value(f"(() => {{ Tables.{kind}('{word}'); const s = getComputedStyle(document.getElementById('{kind}')); return [s.color, s.backgroundColor]; }})()")
                    self.assertEqual(back, "rgba(0, 0, 0, 0)")
                    self.assertGreaterEqual(contrast(rgb(colour), paper), TEXT, f"{word}, dark {dark}")
            # What the canvases are drawn with: numbers of the axes, lines and marks, these on the shades as well.
            self.check_drawn(page, dark)

    def check_drawn(self, page, dark):
        names = ("--force", "--delta", "--amplitude", "--mark", "--free", "--static", "--kinetic", "--other", "--spike", "--accent")
        drawn = colours(page, "--card", "--soft", *names)
        self.assertGreaterEqual(contrast(drawn["--soft"], drawn["--card"]), TEXT, f"dark {dark}")
        alpha = page.value("""['--slip', '--stick'].map(name => getComputedStyle(document.documentElement).getPropertyValue(name).match(/[0-9.]+/g).map(Number))""")
        grounds = [drawn["--card"], *([part * shade[3] + own * (1 - shade[3]) for part, own in zip(shade, drawn["--card"])] for shade in alpha)]
        for name in names:
            for ground in grounds:
                self.assertGreaterEqual(contrast(drawn[name], ground), MARK, f"{name} on {ground}, dark {dark}")
        # The canvas has them, and has others when the reader's liking changes.
        axis = "[Scope.force.axes[0].stroke(), Scope.force.series[1].stroke()].map(c => c.trim())"
        own = "['--soft', '--force'].map(name => getComputedStyle(document.documentElement).getPropertyValue(name).trim())"
        self.assertEqual(page.value(axis), page.value(own))
        before = page.value(axis)
        page.like(not dark)
        self.assertEqual(page.value(axis), page.value(own))
        self.assertNotEqual(page.value(axis), before)
        page.like(dark)

    # What has the keyboard: how it is known, whether it is seen, and where it is.
    HELD = """(() => {
      const e = document.activeElement, style = getComputedStyle(e), box = e.getBoundingClientRect();
      let back = e.parentElement;
      while (back && getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
      const all = [...document.querySelectorAll('*')];
      return {at: all.indexOf(e), name: `${e.tagName}#${e.id} ${e.name ?? ''} ${e.textContent.trim().slice(0, 30)}`, body: e === document.body, outline: style.outlineStyle, width: parseFloat(style.outlineWidth),
        colour: style.outlineColor, back: back ? getComputedStyle(back).backgroundColor : 'rgb(255, 255, 255)', inView: box.bottom > 0 && box.top < innerHeight && box.right > 0 && box.left < innerWidth};
    })()"""
    REACHABLE = """(within => { const all = [...document.querySelectorAll('*')];
      return [...document.querySelectorAll(within)].filter(e => e.checkVisibility({visibilityProperty: true}) && !e.disabled && e.tabIndex >= 0).map(e => all.indexOf(e)); })"""

    def walk(self, page, key, steps):
        """Where the keyboard goes, press by press, until it comes back to its first place."""
        held = []
        for _ in range(steps):
            page.press(key)
            now = page.value(self.HELD)
            if held and now["at"] == held[0]["at"]:
                return held
            if now["body"]:  # Between the last control and the first.
                continue
            held.append(now)
            self.assertTrue(now["outline"] != "none" and now["width"] >= 2, now)
            self.assertGreaterEqual(contrast(rgb(now["colour"]), rgb(now["back"])), MARK, now)
            self.assertTrue(now["inView"], now)
        self.fail(f"{key} does not come back after {steps} presses: {[h['name'] for h in held]}")

    def test_the_tab_key_goes_through_all_controls_in_order_and_comes_back(self):
        # Nothing changes the page meanwhile: the bench is idle; one test and its batch are in the tables.
        daemon = self.daemon('[test]\nbegins = "command"\n', speed=2)
        self.assertEqual(daemon.ask("POST", "/v1/batch", {"name": "liner", "replicates": 2})[0], 200)
        self.assertEqual(daemon.ask("DELETE", "/v1/controller")[0], 200)
        page = self.page()
        page.resize(1280, 720)
        self.start(page)
        page.until("Scope.cycles.number.length > 3")
        self.stop(page, 1)
        page.until("document.getElementById('record-1') && document.querySelectorAll('#batch-rows tr').length === 1")
        page.value("document.getElementById('give-back').click()")  # Else it would end by itself meanwhile, with its button.
        page.until("document.getElementById('give-back').hidden")
        page.value("document.getElementById('batch-tests').open = true")
        page.value("document.activeElement.blur()")
        wanted = page.value(f"{self.REACHABLE}('{CONTROLS}')")
        self.assertGreater(len(wanted), 18)
        forward = self.walk(page, "Tab", 3 * len(wanted))
        places = [held["at"] for held in forward]
        begin = places.index(min(places))
        places = places[begin:] + places[:begin]
        self.assertEqual(places, sorted(places), [held["name"] for held in forward])  # As it is read.
        self.assertEqual([at for at in places if at in wanted], wanted)
        backward = [held["at"] for held in self.walk(page, "Shift+Tab", 3 * len(wanted))]
        self.assertEqual(sorted(backward), places)
        # A dialog keeps the keyboard, lets it go by Escape, and gives it back to what opened it.
        for opener in ("tare-open", "calibrate-open", "batch-end", "batches-open", "void-1", "batch-void-0", "trace-1"):
            page.value(f"document.getElementById('{opener}').focus()")
            page.press("Enter")
            page.until("document.querySelector('dialog:modal') && document.activeElement.closest('dialog')")
            page.until("document.querySelector('dialog:modal').getAttribute('aria-busy') !== 'true'")
            wanted = page.value(f"{self.REACHABLE}('dialog:modal :is({CONTROLS})')")
            inside = [held["at"] for held in self.walk(page, "Tab", 3 * len(wanted) + 3)]
            self.assertTrue(set(wanted) <= set(inside), opener)
            self.assertTrue(page.value("document.activeElement.closest('dialog') !== null"))
            page.press("Escape")
            page.until(f"!document.querySelector('dialog:modal') && document.activeElement.id === '{opener}'")

    def test_the_findings_of_the_latest_test_stand_below_the_answer_and_in_its_row(self):
        daemon = self.daemon('[tester]\npull_speed = "6 in/min"\n')
        page = self.page()
        page.until("document.querySelectorAll('#findings li').length === 1")
        shown = page.value("document.querySelector('#findings li').textContent")
        self.assertRegex(shown, r"^test \d+, warning: the pull speed was 1[12]\.\d+ \+- 0\.0*[1-9]\d in/min, the plan says 6 in/min → correct the tester's speed, or pull_speed of the plan \(pull-speed\)$")
        self.assertIn(page.value("document.querySelector('#tests tbody tr').cells[1].textContent"), ("stick-slip · pull-speed", "undecided · pull-speed"))
        [told] = daemon.ask("GET", "/v1/tests/1")[1]["results"]["coded_findings"]
        self.assertIn(told["text"], page.value("[...document.querySelectorAll('#tests tbody tr')].at(-1).cells[1].title"))
        front, back = page.value("[...document.querySelectorAll('#findings strong')].map(e => [getComputedStyle(e).color, getComputedStyle(document.getElementById('band')).backgroundColor])[0]")
        self.assertGreaterEqual(contrast(rgb(front), rgb(back)), 4.5)

    def test_a_sled_that_no_tester_has_is_asked_about_before_a_test(self):
        daemon = self.daemon('[tester]\nsled_mass = "100 kg"\n[test]\nbegins = "command"\n')
        page = self.page()
        self.assertEqual(daemon.ask("GET", "/v1/status")[1]["findings"], ["the sled mass is 100 kg, outside 0.005 … 20 kg: check its unit"])
        page.until("document.getElementById('trouble').textContent.includes('the sled mass is 100 kg')")
        for answer in ("no", "yes"):
            page.value("document.querySelector('[data-command=start]').focus()")
            page.press("Enter")
            page.until("document.getElementById('confirm-dialog').matches(':modal')")
            self.assertEqual(page.value("document.activeElement.id"), "confirm-no")
            self.assertIn("the sled mass is 100 kg", page.value("document.getElementById('confirm-text').textContent"))
            page.value(f"document.getElementById('confirm-{answer}').focus()")
            page.press("Enter")
            page.until("!document.getElementById('confirm-dialog').open")
            if answer == "no":
                self.assertIsNone(daemon.ask("GET", "/v1/status")[1]["current_test"])
        page.until("document.getElementById('message').textContent.startsWith('start: test 1')")
        self.assertEqual(page.complaints(), [])

    def test_fingers_meet_its_controls_on_a_tablet(self):
        daemon = self.daemon('[test]\nbegins = "command"\n', speed=2, times=PATIENT)
        page = self.page(touch=True)
        self.assertTrue(page.value("matchMedia('(pointer: coarse)').matches"))
        page.resize(820, 1180)
        page.until("Scope.data.highest.slice(-50).every(force => force < 0.02)")
        page.tap("[data-command=start]")
        page.until("Scope.cycles.number.length > 3")
        page.tap("[data-command=stop]")
        page.until("document.getElementById('record-1')")
        page.tap("#batch-open")
        page.value("document.querySelector('#batch-begin [name=name]').value = 'liner'")
        page.tap("#batch-begin > button")
        page.until("!document.querySelector('dialog:modal')")
        self.assertEqual(daemon.ask("GET", "/v1/batch")[1]["batch"]["name"], "liner")
        for width, height in ((820, 1180), (390, 844), (1280, 720)):
            page.resize(width, height)
            page.value("document.getElementById('more').open = true")
            self.assertLessEqual(page.value("document.documentElement.scrollWidth"), width)
            self.fingers(page, "body", width)
            for opener in ("tare-open", "calibrate-open", "batch-end", "batches-open", "void-1", "trace-1"):
                page.tap(f"#{opener}")
                page.until("document.querySelector('dialog:modal')")
                if opener == "batches-open":
                    page.until("document.querySelectorAll('#batches-rows tr').length === 1")
                self.fingers(page, "dialog:modal", width)
                left, right = page.value("(r => [r.left, r.right])(document.querySelector('dialog:modal').getBoundingClientRect())")
                self.assertTrue(0 <= left and right <= width, opener)
                page.press("Escape")
                page.until("!document.querySelector('dialog:modal')")
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            page.resize(820, 1180)
            page.screenshot(pathlib.Path(folder) / "tablet.png")

    def fingers(self, page, within, width):
        targets = page.value(f"{TARGETS}('{within} :is({CONTROLS})')")
        self.assertGreater(len(targets), 1, within)
        for name, wide, high in targets:
            self.assertGreaterEqual(min(wide, high), TARGET_PX, f"{name} {wide} x {high} at {width}")

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

#!/usr/bin/env python3
"""The load cell tared through the live page, by keyboard, in a real browser: what the page says to do, what it reads
meanwhile, and each number that it shows against the daemon's answer and the next record.

tare_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment a picture of the page is left there.
"""

import math
import os
import pathlib
import shutil
import sys
import unittest

import h5py
import numpy

from chromium import Chromium
from contrast import TEXT, TEXTS, contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from hanging import Hanging, weighing_board  # noqa: E402
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

GAIN = 1.9  # N/V, of weighing_board: what the daemon takes the cell for.
WEIGHT = 2.331 * 9.80665  # N, of the sled.
STEP = "document.getElementById('tare-step').textContent"
MESSAGE = "document.getElementById('tare-message').textContent"
DRAWN = """({reading: document.getElementById('tare-reading').textContent, scatter: document.getElementById('tare-scatter').textContent,
  drift: document.getElementById('tare-drift').textContent, step: document.getElementById('tare-step').textContent,
  scan: Scope.data.scan, lowest: Scope.data.lowest, highest: Scope.data.highest})"""
# What the daemon answers to a tare, kept for the test.
LISTEN = """(() => {
  const own = window.fetch;
  window.fetch = async (...given) => {
    const reply = await own(...given);
    if (given[0] === '/v1/tare') window.tared = await reply.clone().json();
    return reply;
  };
})()"""


class TarePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, dark=False, **options):
        self.hanging = Hanging(self)
        self.hanging.hang(0)
        self.daemon = RunningDaemon(self, BUILD, SOURCE, board=weighing_board(self, SOURCE) + 'load_cell_zero = "0 V"\n',
                                    config='http = "127.0.0.1:0"\ntoken_file = "token"\n[test]\nbegins = "command"\n')
        token = (self.daemon.folder / "token").read_text().strip()
        self.page = self.browser.open(f"http://{self.daemon.port_line()}/#token={token}", dark=dark, **options)
        self.addCleanup(self.page.close)
        self.page.until("document.querySelectorAll('#health dd').length > 5")
        self.page.value(LISTEN)
        self.name = self.page.value("sessionStorage.getItem('name')")

    def text(self, part):
        return self.page.value(f"document.getElementById('tare-{part}').textContent")

    def enter(self, selector):
        self.page.value(f"document.querySelector('{selector}').focus()")
        self.assertTrue(self.page.value(f"document.activeElement === document.querySelector('{selector}')"), selector)
        self.page.press("Enter")

    def wizard(self):
        self.enter("#tare-open")
        self.page.until("document.getElementById('tare-dialog').matches(':modal') && document.getElementById('tare-zero').textContent !== '–'")
        self.assertEqual(self.page.value("document.activeElement.id"), "tare-do")

    def refused(self):
        """Tares; returns why not, once it is told."""
        self.page.value("window.tared = null")
        self.enter("#tare-do")
        self.page.until(f"window.tared !== null && {MESSAGE} !== ''")
        self.assertEqual(self.text("message"), self.page.value("window.tared.error"))
        self.assertTrue(self.page.value("document.getElementById('tare-done').hidden"))
        return self.text("message")

    def check_reading(self):
        """What it shows of the latest seconds against the scope's scans: half of the last digit, and six decimals on the way."""
        shown = self.page.value(DRAWN)
        scan = numpy.array(shown["scan"])
        after_gap = numpy.flatnonzero([low is None for low in shown["lowest"]])
        start = after_gap[-1] + 1 if len(after_gap) else 0
        scan, lowest, highest = (numpy.array(part[start:], dtype=float) for part in (scan, shown["lowest"], shown["highest"]))

        def both(some):
            return numpy.concatenate((lowest[some], highest[some]))
        five = numpy.flatnonzero(scan > scan[-1] - 5 * 350)
        half = len(five) // 2
        self.assertAlmostEqual(float(shown["reading"]), both(scan > scan[-1] - 350).mean(), delta=0.51e-4)
        self.assertAlmostEqual(float(shown["scatter"].split(",")[0]), both(five).std(), delta=0.51e-4)
        self.assertAlmostEqual(float(shown["drift"].split(",")[0]), both(five[half:]).mean() - both(five[:half]).mean(), delta=0.51e-4)
        return shown

    def test_a_tare_by_keyboard_and_each_number_is_the_daemons_and_the_records(self):
        self.open()
        # A weight that swings: not quiet, and said so.
        self.hanging.hang(0.5, swing=0.2)
        self.wizard()
        self.assertEqual(self.text("zero"), "0.000000 V")
        self.page.until(f"{STEP}.startsWith('Step 1 of 2: take the sled off the load cell')")
        self.page.until("document.getElementById('tare-scatter').textContent.includes('✗ above 0.005')")
        # At rest, and yet a load: the daemon says so, and the page in the same words.
        self.hanging.hang(1)
        self.page.until(f"{STEP}.startsWith('Step 2 of 2: ✓ quiet') && Number(document.getElementById('tare-reading').textContent) > 0.4")
        shown = self.check_reading()
        self.assertAlmostEqual(float(shown["reading"]), (Hanging.ZERO + 9.80665 / Hanging.GAIN) * GAIN / WEIGHT, delta=1e-4)
        self.assertEqual(self.refused(), "there are only 0 scans of the unloaded bench so far, 60 are needed")
        self.assertEqual(self.daemon.ask("POST", "/v1/tare", who=self.name)[1]["error"], self.text("message"))
        # Nothing pulls: the cell shows its own zero.
        self.hanging.hang(0)
        self.page.until(f"{STEP}.startsWith('Step 2 of 2: ✓ quiet') && Number(document.getElementById('tare-reading').textContent) < 0.01")
        shown = self.check_reading()
        zero = Hanging.ZERO * GAIN / WEIGHT
        self.assertAlmostEqual(float(shown["reading"]), zero, delta=0.51e-4)  # The mean of 350 scans is as good as exact.
        self.assertIn("✓ at most 0.005", shown["scatter"])
        self.assertIn("✓ at most 0.0025", shown["drift"])
        before = self.daemon.ask("GET", "/v1/calibration")[1]["in_use"]["zero"]
        self.page.value("window.tared = null")
        self.enter("#tare-do")
        self.page.until("!document.getElementById('tare-done').hidden")
        told = self.page.value("window.tared")
        self.assertEqual(self.text("before"), f"{before:.6f} V")
        self.assertEqual(self.text("after").split(" ± ")[0], f"{told['zero']:.6f} V")
        self.assertAlmostEqual(float(self.text("after").split(" ± ")[1].split()[0]), told["zero_standard_error"], delta=0.051 * told["zero_standard_error"])
        self.assertEqual(self.text("zero"), f"{told['zero']:.6f} V")
        self.assertAlmostEqual(float(self.text("moved").split()[0]), told["moved_force"], delta=0.0051 * told["moved_force"])
        self.assertAlmostEqual(told["moved_force"], GAIN * (told["zero"] - before), delta=1e-9)
        self.assertEqual(self.text("scans"), str(told["scan_count"]))
        self.assertEqual(self.text("message"), f"the zero is {told['zero']:.6f} V from scan {told['scan']} on")
        # What hung was known: four standard errors. One scan has the cell's noise; their mean that over the root of their number.
        self.assertAlmostEqual(told["zero"], Hanging.ZERO, delta=4 * told["zero_standard_error"])
        self.assertAlmostEqual(told["zero_standard_error"], Hanging.NOISE / math.sqrt(told["scan_count"]), delta=0.2 * Hanging.NOISE / math.sqrt(told["scan_count"]))
        self.assertEqual(self.daemon.ask("GET", "/v1/calibration")[1]["in_use"]["zero"], told["zero"])
        self.page.until("document.getElementById('tare-reading').textContent === '0.0000'")
        self.page.until(f"{STEP}.startsWith('✓ Done')")
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            self.page.resize(1280, 720)
            self.page.screenshot(pathlib.Path(folder) / "tare.png")
        # The keyboard goes on to what closes it, and back to what opened it.
        self.assertEqual(self.page.value("document.activeElement.id"), "tare-close")
        self.page.press("Enter")
        self.page.until("!document.getElementById('tare-dialog').open && document.activeElement.id === 'tare-open'")
        # The next record states it, and who did it.
        self.enter("[data-command=start]")
        self.page.until_said("start: test 1")
        self.enter("[data-command=stop]")
        self.page.until("document.querySelectorAll('#tests tbody tr').length === 1")
        with h5py.File(self.daemon.record(1)) as record:
            self.assertEqual(record["entry/instrument/calibration/zero"][()], told["zero"])
            texts = [text.decode() for text in record["entry/events/text"][()]]
        self.assertIn(f"bench: zero of the load cell set from {before:.6g} V to {told['zero']:.6g} V at scan {told['scan']}, by {self.name}", texts)
        # Refusals alone: the browser's own words for them.
        self.assertEqual([words for words in self.page.complaints() if "409" not in words], [])

    def test_a_test_or_a_calibration_under_way_is_told(self):
        self.open()
        self.enter("[data-command=start]")
        self.page.until_said("start: test 1")
        self.wizard()
        self.page.until(f"{STEP} === 'A test is under way: let it end, or stop it.'")
        self.assertEqual(self.refused(), "a test is running; stop it first")
        self.page.press("Escape")
        self.page.until("!document.getElementById('tare-dialog').open && document.activeElement.id === 'tare-open'")
        self.enter("[data-command=stop]")
        self.page.until("document.querySelectorAll('#tests tbody tr').length === 1")
        self.assertEqual(self.daemon.ask("POST", "/v1/calibration", {}, who=self.name)[0], 200)
        self.wizard()
        self.assertIn("calibrat", self.refused())

    def test_it_can_be_read_and_reached_in_both_colours(self):
        for dark in (False, True):
            self.open(dark=dark)
            self.wizard()
            self.page.until(f"{STEP}.startsWith('Step 2 of 2')")
            self.enter("#tare-do")
            self.page.until("!document.getElementById('tare-done').hidden")
            for width, height in ((820, 1180), (1280, 720)):
                self.page.resize(width, height)
                left, top, right, bottom = self.page.value("(r => [r.left, r.top, r.right, r.bottom])(document.getElementById('tare-dialog').getBoundingClientRect())")
                self.assertTrue(left >= 0 and top >= 0 and right <= width and bottom <= height, (left, top, right, bottom))
            texts = self.page.value(f"{TEXTS}('#tare-dialog *')")
            self.assertGreater(len(texts), 20)
            for name, front, back in texts:
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), TEXT, f"{name} {front} on {back}, dark {dark}")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

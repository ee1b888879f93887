#!/usr/bin/env python3
"""How many clicks and keys the daily work takes on the live page: a first test, a batch of five, two batches compared, a calibration.

effort_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment pictures of the page are left there.
"""

import os
import pathlib
import shutil
import sys
import unittest

from chromium import Chromium

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from hanging import Hanging, weighing_board  # noqa: E402
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

MOST_CLICKS = {"first test": 0, "batch": 2, "comparison": 4, "calibration": 10}
MOST_KEYS_OF_BATCH = 10


class Effort(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, begins, **options):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n[test]\nbegins = "{begins}"\n', **options)
        token = (self.daemon.folder / "token").read_text().strip()
        self.page = self.browser.open(f"http://{self.daemon.port_line()}/#token={token}")
        self.addCleanup(self.page.close)
        self.page.resize(1280, 720)

    def take_effort(self, task):
        """Compares what the hand did since the last call with what the task may take. Returns the keys."""
        clicks, keys = self.page.clicks, self.page.keys
        self.page.clicks = self.page.keys = 0
        print(f"{task}: {clicks} clicks, {keys} keys")
        self.assertLessEqual(clicks, MOST_CLICKS[task], task)
        return keys

    def batch(self, name):
        """Five sheets, planned by hand, measured as the sled is pulled."""
        self.page.click("#batch-open")
        self.page.until("document.getElementById('batch-dialog').open")
        self.page.type(name)
        self.page.click("#batch-begin [name='replicates']")
        self.page.type("5")
        self.page.press("Enter")
        self.page.until("!document.getElementById('batch-dialog').open")
        self.assertLessEqual(self.take_effort("batch"), MOST_KEYS_OF_BATCH)
        self.assertEqual(self.page.value("document.getElementById('batch-name').textContent").split(" ")[0], f"{name}:")
        self.page.until("document.getElementById('now').textContent === 'Now: the batch is finished, all 5 tests are made'")

    def test_a_first_test_two_batches_and_their_comparison(self):
        self.open("force", speed=20)
        self.page.until("document.getElementById('answer').textContent.includes('±')")
        self.assertEqual(self.take_effort("first test"), 0)
        self.batch("A1")
        self.batch("A2")
        self.page.click("#batches-open")
        self.page.until("document.querySelectorAll('#batches-rows tr').length === 2")
        for side, row in (("a", 0), ("b", 1)):
            self.page.click(f"#batches-rows [name={side}]", row)
        self.page.call("click", selector="#compare-show", index=0, times=1)  # A window opens: this page paints no frames.
        self.page.clicks += 1
        shown = self.browser.opened("/page/report")
        shown.until("window.stickslip?.data")
        self.take_effort("comparison")
        # The tester goes on pulling.
        self.page.bring_to_front()
        self.page.until("document.getElementById('next').textContent === 'Next: let it pull to its end; the batch is finished, it is none of its tests'")
        self.assertRegex(shown.value("document.getElementById('title').textContent"), "A[12] .* against A[12] ")
        self.assertEqual(shown.complaints() + self.page.complaints(), [])
        shown.close()

    def test_a_calibration(self):
        self.hanging = Hanging(self)
        self.open("command", board=weighing_board(self, SOURCE))
        self.page.until("document.querySelectorAll('#health dd').length > 5")
        self.page.click("#calibrate-open")
        self.page.until("document.getElementById('calibrate-dialog').open && document.getElementById('calibrate-in-use').textContent !== ''")
        self.page.click("#calibrate-begin button")
        self.page.until("!document.getElementById('calibrate-weigh').hidden")
        for number, (mass, typed) in enumerate([(0, None), (0.5, "500 g"), (1, "1 kg"), (1.5, "1.5 kg"), (1, "1 kg"), (0.5, "500 g"), (0, "0")]):
            self.page.until("document.getElementById('calibrate-dialog').getAttribute('aria-busy') === 'false'")
            self.hanging.hang(mass, 0)
            if typed:
                self.page.value("document.getElementById('calibrate-mass').select()")
                self.page.type(typed)
                self.page.press("Enter")
            else:
                self.page.click("#calibrate-read")
            self.page.until(f"document.querySelectorAll('#calibrate-rows tr').length === {number + 1}")
        self.page.until("document.getElementById('calibrate-dialog').getAttribute('aria-busy') === 'false'")
        self.page.click("#calibrate-save button")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('kept in')")
        self.page.click("#calibrate-close")
        self.take_effort("calibration")
        self.assertEqual(len(list((self.daemon.folder / "calibrations").iterdir())), 1)

    def test_the_page_fits_a_telephone_and_a_screen_of_4k(self):
        self.open("force", speed=20)
        self.page.until("document.querySelectorAll('#tests tbody tr').length >= 2")
        for width, height in ((390, 844), (1920, 1080), (3840, 2160)):
            self.page.resize(width, height)
            self.assertLessEqual(self.page.value("document.documentElement.scrollWidth"), width)
            # The answer's line and the first row of the tests stand above the fold.
            self.assertLess(self.page.value("document.getElementById('answer').getBoundingClientRect().bottom"), height)
            if height > 1000:
                self.assertLess(self.page.value("document.querySelector('#tests tbody tr').getBoundingClientRect().bottom"), height)
                # Its content takes the width.
                self.assertGreater(self.page.value("document.querySelector('.chart canvas').getBoundingClientRect().width"), 0.4 * width)
            if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
                self.page.screenshot(pathlib.Path(folder) / f"live-{width}.png", height=height)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)

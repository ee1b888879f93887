#!/usr/bin/env python3
"""The load cell calibrated through the live page, by keyboard, in a real browser: weights hung on the simulated tester,
and each number that the page shows against the file that it leaves.

calibration_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment a picture of the page is left there.
"""

import math
import os
import pathlib
import re
import shutil
import sys
import tempfile
import tomllib
import unittest

from chromium import Chromium
from contrast import contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from hanging import NOTHING_HANGS, Hanging, standard_errors_allowed, weighing_board  # noqa: E402
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

EXPIRED = """[calibration]
date = "2020-01-01T00:00:00.000000000+00:00"
expires = "2021-01-01T00:00:00.000000000+00:00"
gain = "2.01 N/V"
zero = "0.01 V"
"""
UP_AND_DOWN = ["500 g", "1 kg", "1.5kg", "1 kg", "0.5 kg", "0"]


def kg(typed):
    number, unit = re.match(r"([0-9.]+) ?(\w*)", typed).groups()
    return float(number) / (1000 if unit == "g" else 1)


def quantity(text):
    """A key of the file: "1.25 V"."""
    return float(text.split()[0])


class CalibrationPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, begins="command", dark=False, calibrations="calibrations"):
        self.hanging = Hanging(self)
        self.daemon = RunningDaemon(self, BUILD, SOURCE, board=weighing_board(self, SOURCE, calibrations=calibrations),
                                    config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n[test]\nbegins = "{begins}"\n')
        address = f"http://{self.daemon.port_line()}/"
        token = (self.daemon.folder / "token").read_text().strip()
        self.page = self.browser.open(f"{address}#token={token}", dark=dark)
        self.page.until("document.querySelectorAll('#health dd').length > 5")
        self.focus("open")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-dialog').open && document.getElementById('calibrate-in-use').textContent !== ''")

    def text(self, part):
        return self.page.value(f"document.getElementById('calibrate-{part}').textContent")

    def focus(self, part):
        self.page.value(f"document.getElementById('calibrate-{part}').focus()")
        self.assertEqual(self.page.value("document.activeElement.id"), f"calibrate-{part}")

    def type(self, part, text):
        self.focus(part)
        self.page.value(f"document.getElementById('calibrate-{part}').select()")
        self.page.type(text)

    def rows(self):
        return self.page.value("[...document.querySelectorAll('#calibrate-rows tr')].map(r => [...r.cells].map(c => c.textContent))")

    def settled(self):
        self.page.until("document.getElementById('calibrate-dialog').getAttribute('aria-busy') === 'false'")

    def begin(self):
        self.type("settle", "0.5 s")
        self.type("reading", "0.5 s")
        self.page.press("Enter")
        self.page.until("!document.getElementById('calibrate-weigh').hidden")
        self.settled()
        self.assertIn("take everything off", self.text("step"))

    def read(self, typed, hung=None, swing=0):
        """By keyboard: the mass, then Enter. Of the tare the button alone."""
        self.hanging.hang(kg(typed) if hung is None else hung, swing)
        before = len(self.rows())
        if before:
            self.type("mass", typed)
        else:
            self.focus("read")
        self.page.press("Enter")
        self.page.until(f"document.querySelectorAll('#calibrate-rows tr').length === {before + 1}")
        self.settled()
        return self.rows()[-1][-1]

    def shows(self, shown, value, digits):
        """Half of the last digit, and what rounding in two programs adds to it."""
        number = float(re.match(r"[-+]?[0-9.]+(?:e[-+]?\d+)?", shown.strip())[0])
        last = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1) if value else 0.0
        self.assertLessEqual(abs(number - value), 0.5 * last + 4 * sys.float_info.epsilon * abs(value), f"{shown} for {value}")

    def test_a_whole_calibration_by_keyboard_and_each_digit_is_the_files(self):
        self.open()
        self.assertIn("gain 1.9000000 N/V", self.text("in-use"))
        self.assertIn("as the configuration says", self.text("in-use"))
        self.begin()
        self.read("0")
        self.assertEqual(self.text("read"), "Read")
        self.assertIn("up: hang a weight heavier than 0 kg", self.text("step"))
        # What cannot count is told with its reason, stays in the list, and can be forgotten.
        for typed, hung, swing, why in (("1 kg", 0, 0, NOTHING_HANGS), ("30 g", None, 0, "less than 1 %"), ("30 kg", None, 0, "saturated"),
                                        ("1 kg", None, 0.05, "unstable")):
            self.assertRegex(self.read(typed, hung, swing), f"^✗ .*({why})")
            self.assertRegex(self.text("message"), why)
            rows = len(self.rows())
            self.focus("undo")
            self.page.press("Enter")
            self.page.until(f"document.querySelectorAll('#calibrate-rows tr').length === {rows - 1}")
            self.settled()
        for typed in UP_AND_DOWN:
            self.assertTrue(self.page.value("document.getElementById('calibrate-save').hidden") or typed == "0")
            self.assertEqual(self.read(typed), "✓ counts")
        self.assertIn("Step 4 of 4", self.text("step"))
        self.assertEqual(self.text("missing"), "")
        rows = self.rows()
        fit = self.page.value("Object.fromEntries([...document.querySelectorAll('#calibrate-fit dt')].map(dt => [dt.textContent, dt.nextSibling.textContent]))")
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            self.page.screenshot(pathlib.Path(folder) / "calibration.png")
        self.type("certificate", "DKD-7")
        self.type("days", "180")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('kept in')")
        [file] = (self.daemon.folder / "calibrations").iterdir()
        self.assertIn(file.name, self.text("message"))

        kept = tomllib.loads(file.read_text(encoding="utf-8"))
        result = {key: quantity(text) for key, text in kept["calibration"].items() if key not in ("date", "expires", "certificate")}
        self.assertEqual(kept["calibration"]["certificate"], "DKD-7")
        for name, digits, key in (("gain", 8, "gain"), ("zero", 6, "zero")):
            shown, error = fit[name].split(" ± ")
            self.shows(shown, result[key], digits)
            self.shows(error, result[f"{key}_standard_error"], 2)
        self.shows(fit["off the line"], 1000 * result["residual"], 3)
        self.shows(fit["hysteresis"], 1000 * result["hysteresis"], 3)
        self.assertEqual(len(kept["weight"]), 1 + len(UP_AND_DOWN))
        for row, weight, typed in zip(rows, kept["weight"], ["0", *UP_AND_DOWN], strict=True):
            self.assertEqual(quantity(weight["mass"]), kg(typed))
            self.assertEqual(float(row[1].split()[0]), kg(typed))
            self.shows(row[2], quantity(weight["force"]), 6)
            voltage, error = row[3].split(" ± ")
            self.shows(voltage, quantity(weight["voltage"]), 8)
            self.shows(error, quantity(weight["standard_error"]), 2)
            # Three decimals of a millivolt.
            self.assertAlmostEqual(float(row[4].split()[0]), 1000 * quantity(weight["residual"]), delta=0.5001e-3)
        # What hung was known.
        allowed = standard_errors_allowed(len(kept["weight"]))
        self.assertAlmostEqual(result["gain"], Hanging.GAIN, delta=allowed * result["gain_standard_error"])
        self.assertAlmostEqual(result["zero"], Hanging.ZERO, delta=allowed * result["zero_standard_error"])
        # It is the one in use, on the page as well.
        self.assertEqual(self.daemon.ask("GET", "/v1/calibration")[1]["in_use"]["gain"], result["gain"])
        self.shows(self.text("in-use").split("gain ")[1], result["gain"], 8)
        self.assertEqual(self.page.value("document.activeElement.id"), "calibrate-close")
        self.page.press("Enter")
        self.page.until("!document.getElementById('calibrate-dialog').open")
        self.page.until(f"document.getElementById('health').textContent.includes('calibrated {kept['calibration']['date'][:10]}, until {kept['calibration']['expires'][:10]}')")
        self.assertEqual(self.page.complaints(), [])

    def test_a_mass_is_shown_as_understood_before_it_is_sent_and_needs_its_unit(self):
        self.open()
        self.begin()
        self.read("0")
        for typed, shown in (("500 g", "500 g = 0.5000 kg = 4.903 N"), ("500", '500: a mass needs its unit, such as "500 g" or "500 kg"'),
                             ("1 lb", "1 lb = 0.4536 kg = 4.448 N"), ("5 st", "5 st: write a number and kg, g, mg or lb"), ("0", "0 = 0.0000 kg = 0.000 N")):
            self.type("mass", typed)
            self.assertEqual(self.text("understood"), shown)
        self.type("mass", "500")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.includes('a mass needs its unit')")
        self.assertEqual(len(self.rows()), 1)

    def test_a_gain_far_from_the_one_in_use_is_saved_only_if_the_dialog_is_confirmed(self):
        self.open()
        self.begin()
        self.read("0")
        for mass in (0.5, 1, 1.5, 1, 0.5, 0):
            self.read(f"{1000 * mass:g} kg", hung=mass)
        self.assertRegex(self.text("findings"), "the load cell gain .* times the 1.9 N/V in use before, a change of more than 20 %")
        for answer, text in (("no", ""), ("yes", "kept in")):
            self.type("certificate", "DKD-7")
            self.page.press("Enter")
            self.page.until("document.getElementById('confirm-dialog').matches(':modal')")
            self.assertEqual(self.page.value("document.activeElement.id"), "confirm-no")
            facts = self.page.value("[...document.querySelectorAll('#confirm-facts dd')].map(dd => dd.textContent)")
            self.shows(facts[0], 1.9, 8)
            self.assertLess(abs(float(facts[1].split()[0]) - 1000 * Hanging.GAIN), 1)
            self.assertLess(abs(float(facts[2]) - 1000 * Hanging.GAIN / 1.9), 1)
            self.page.value(f"document.getElementById('confirm-{answer}').focus()")
            self.page.press("Enter")
            self.page.until("!document.getElementById('confirm-dialog').open")
            self.page.until(f"document.getElementById('calibrate-message').textContent.startsWith('{text}')")
            self.settled()
            self.assertEqual((self.daemon.folder / "calibrations").exists(), answer == "yes")
        [file] = (self.daemon.folder / "calibrations").iterdir()
        self.assertEqual(tomllib.loads(file.read_text(encoding="utf-8"))["calibration"]["replaced_gain"], "1.9 N/V")
        self.assertEqual(self.page.complaints(), [])

    def test_an_armed_bench_is_disarmed_first_and_who_gives_up_leaves_nothing(self):
        self.open(begins="force")
        self.hanging.hang(0)
        self.page.until("!document.getElementById('calibrate-disarm').hidden")
        self.focus("start")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('the bench is armed')")
        self.settled()
        self.focus("disarm")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('the bench is idle')")
        self.begin()
        # A tare that swings does not count: it is told, and is not in the list.
        self.hanging.hang(0, swing=0.1)
        self.focus("read")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('the tare does not count: unstable')")
        self.assertEqual(self.rows(), [])
        self.settled()
        self.read("0")
        # A page that is opened anew finds it where it was left.
        self.page.reload()
        self.page.until("document.querySelectorAll('#health dd').length > 5")
        self.focus("open")
        self.page.press("Enter")
        self.page.until("document.querySelectorAll('#calibrate-rows tr').length === 1")
        self.focus("give-up")
        self.page.press("Enter")
        self.page.until("document.getElementById('calibrate-message').textContent.startsWith('given up')")
        self.assertFalse((self.daemon.folder / "calibrations").exists())

    def test_one_that_has_expired_is_told(self):
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            (pathlib.Path(folder) / "20200101T000000Z.toml").write_text(EXPIRED, encoding="utf-8")
            self.open(calibrations=folder)
            self.assertIn("gain 2.0100000 N/V", self.text("in-use"))
            self.assertIn("of 2020-01-01, EXPIRED on 2021-01-01", self.text("in-use"))
            self.page.until("document.getElementById('health').textContent.includes('calibrated 2020-01-01, EXPIRED on 2021-01-01')")

    def test_it_can_be_read_and_reached_in_both_colours(self):
        for dark in (False, True):
            self.open(dark=dark)
            self.begin()
            for typed, hung in (("0", 0), ("1 kg", 0), ("0.5 kg", None), ("1 kg", None), ("1.5 kg", None), ("1 kg", None), ("0.5 kg", None), ("0", None)):
                self.read(typed, hung)
            self.assertEqual(self.page.value("[...document.querySelectorAll('dialog button, dialog input')].filter(e => e.tabIndex < 0).length"), 0)
            self.assertEqual(self.page.value("[...document.querySelectorAll('dialog input')].filter(e => !e.labels.length).length"), 0)
            # The dialog keeps the keyboard to itself.
            inside = self.page.value("document.getElementById('calibrate-dialog').matches(':modal')")
            self.assertTrue(inside)
            for width, height in ((1280, 720), (820, 1180)):
                self.page.resize(width, height)
                self.page.settle()
                self.assertLessEqual(self.page.value("document.getElementById('calibrate-dialog').getBoundingClientRect().right"), width)
            pairs = self.page.value("""[...document.querySelectorAll('dialog *')].filter(e => e.offsetParent && e.textContent.trim() + (e.value ?? '')).map(e => {
              let back = e;
              while (getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
              return [e.tagName + '.' + e.className, getComputedStyle(e).color, getComputedStyle(back).backgroundColor];
            })""")
            self.assertGreater(len(pairs), 60)
            for name, front, back in pairs:
                self.assertGreaterEqual(contrast(rgb(front), rgb(back)), 4.5, f"{name} {front} on {back}, dark {dark}")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

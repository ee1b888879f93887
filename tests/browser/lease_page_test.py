#!/usr/bin/env python3
"""Who has the bench, on the live pages of two people in a real browser: shown, given back, taken over, and free when a page goes.

lease_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]
"""

import pathlib
import shutil
import sys
import unittest

from chromium import Chromium

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

HOLDER = "document.getElementById('holder').textContent"


class LeasePage(unittest.TestCase):
    def setUp(self):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, speed=2, config='http = "127.0.0.1:0"\ntoken_file = "token"\n[test]\nbegins = "command"\n')
        token = (self.daemon.folder / "token").read_text().strip()
        self.address = f"http://{self.daemon.port_line()}/#token={token}"
        self.browser = self.enterContext(Chromium(CHROMIUM, BUILD))  # Of its own: what it keeps goes with it.

    def open(self):
        page = self.browser.open(self.address)
        page.until("document.querySelectorAll('#health dd').length > 5 && Scope.data.scan.length > 20")
        return page

    def press(self, page, name):
        page.value(f"document.getElementById('{name}').focus()")
        self.assertEqual(page.value("document.activeElement.id"), name)
        page.press("Enter")

    def holder(self):
        return self.daemon.ask("GET", "/v1/controller")[1]["controller"]

    def call_me(self, page, name):
        page.value("document.getElementById('operator').focus(); document.getElementById('operator').select()")
        page.type(name)
        page.press("Enter")
        page.until(f"localStorage.getItem('operator') === '{name}'")

    def arm(self, page):
        page.value("document.querySelector('[data-command=arm]').focus()")
        page.press("Enter")
        page.until_said("arm: test")

    def test_a_page_shows_who_has_the_bench_gives_it_back_and_takes_it_over_once_asked(self):
        page = self.open()
        self.assertEqual(page.value(HOLDER), "nobody commands")
        self.assertTrue(page.value("['give-back', 'take-over'].every(id => document.getElementById(id).hidden)"))
        self.arm(page)
        page.until(f"{HOLDER} === 'this page commands'")
        self.press(page, "give-back")
        page.until(f"{HOLDER} === 'nobody commands'")
        self.assertIsNone(self.holder())
        # Somebody else has it: the page learns of it by itself, with the name.
        self.assertEqual(self.daemon.ask("PUT", "/v1/controller", {"seconds": 3600}, who="bob")[0], 200)
        page.until(f"{HOLDER} === 'bob commands'")
        # From the frames that it receives anyhow: it never asks.
        self.assertEqual(sum(url.endswith("/v1/controller") for url in page.requests()), 1, "the DELETE alone")
        self.press(page, "take-over")
        self.assertIn("bob has the bench", page.value("document.getElementById('confirm-text').textContent"))
        self.assertEqual(page.value("document.getElementById('confirm-yes').textContent"), "Take it from bob")
        self.press(page, "confirm-no")
        self.assertEqual(self.holder(), "bob")
        self.press(page, "take-over")
        # By now another one has it: nothing is taken from her.
        self.assertEqual(self.daemon.ask("PUT", "/v1/controller", {"seconds": 3600, "from": "bob"}, who="eve")[0], 200)
        self.press(page, "confirm-yes")
        page.until_said("eve has the bench")
        page.until(f"{HOLDER} === 'eve commands'")
        self.press(page, "take-over")
        self.press(page, "confirm-yes")
        page.until(f"{HOLDER} === 'this page commands'")
        self.assertIn("has the bench", self.daemon.ask("POST", "/v1/arm", who="eve")[1]["error"])
        self.assertEqual(page.complaints(), ["Failed to load resource: the server responded with a status of 409 (Conflict)"])

    def test_an_operators_name_is_kept_and_shown_to_others(self):
        page = self.open()
        self.call_me(page, "Jürgen Łoś")  # No header of a browser takes this as it is.
        self.arm(page)
        page.until(f"{HOLDER} === 'Jürgen Łoś, you, commands'")
        self.assertEqual(self.holder(), "Jürgen Łoś")
        # What was taken under one name is given back before another one is used.
        self.call_me(page, "Ada")
        page.until(f"{HOLDER} === 'nobody commands'")
        self.arm(page)
        self.assertEqual(self.holder(), "Ada")
        page.reload()
        page.until(f"{HOLDER} === 'Ada, you, commands'")
        self.assertEqual(page.value("document.getElementById('operator').value"), "Ada")
        self.assertIn("Ada has the bench", self.daemon.ask("POST", "/v1/arm", who="bob")[1]["error"])

    def test_the_bench_is_free_when_the_page_that_has_it_goes(self):
        page, other = self.open(), self.open()
        self.arm(page)
        name = self.holder()
        other.until(f"{HOLDER} === '{name} commands'")
        page.leave()
        other.until(f"{HOLDER} === 'nobody commands'")
        # One that has not commanded takes nothing with it.
        self.assertEqual(self.daemon.ask("PUT", "/v1/controller", {"seconds": 3600}, who="bob")[0], 200)
        third = self.open()
        self.call_me(third, "bob")  # As bob's own script or other tab.
        third.leave()
        self.open()  # Meanwhile what third sent has come.
        self.assertEqual(self.holder(), "bob")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

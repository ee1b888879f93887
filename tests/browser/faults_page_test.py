#!/usr/bin/env python3
"""The live page in a real browser while things go wrong: a disk that is full for real, a board that is not there, a
daemon that goes away and comes back.

faults_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

The disk is a small file system in memory; without the permission to mount one that test is skipped, and says so.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import h5py

from chromium import Chromium
from contrast import contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402
from small_disk import fill, leave, mount, own_mounts  # noqa: E402
import uncertain  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

ROOM_MIB = 48  # Enough for the ballast, which is kept where there are 16 MiB.
TROUBLE = "document.getElementById('trouble').textContent"
RECORDS = "[...document.querySelectorAll('#tests tbody td:last-child')].map(cell => cell.textContent)"
NO_BOARD = '[board]\ndriver = "comedi"\n[board.comedi]\ndevice = "/dev/comedi-that-is-not-there"\n[tester]\nload_cell_gain = "2 N/V"\nsled_mass = "2331 g"\n'


no_mounts = None  # Why there are none here.


class FaultsPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, port=0, **options):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, config=f'http = "127.0.0.1:{port}"\ntoken_file = "token"\n', **options)
        self.address = f"http://{self.daemon.port_line()}/"
        token = (self.daemon.folder / "token").read_text().strip()
        self.page = self.browser.open(f"{self.address}#token={token}")
        self.page.until("document.querySelectorAll('#health dd').length > 5")

    def mounted(self, folder):
        self.records = folder / "records"
        self.records.mkdir()
        mount(self.records, ROOM_MIB)
        self.addCleanup(subprocess.run, ["umount", "--lazy", str(self.records)], check=False)

    def press(self, command):
        self.page.value(f"document.querySelector('[data-command={command}]').focus()")
        self.page.press("Enter")

    def can_be_read(self):
        front, back = self.page.value("(() => { const s = getComputedStyle(document.getElementById('trouble')); return [s.color, s.backgroundColor]; })()")
        self.assertGreaterEqual(contrast(rgb(front), rgb(back)), 4.5)

    def test_a_full_disk_is_told_as_long_as_it_lasts_and_no_test_is_lost(self):
        if no_mounts:
            self.skipTest(no_mounts)
        self.open(prepare=self.mounted)
        self.page.until(f"{RECORDS}.some(text => text.endsWith('.h5'))")
        self.assertTrue(self.page.value("document.getElementById('trouble').hidden"))
        # Eight MiB are room for 7 min of tests, and short; tests go on, and none can be asked for.
        leave(self.records, 8 << 20)
        self.page.until(f"{TROUBLE}.startsWith('storage short: room for ')")
        self.assertIn("move records from records to another disk", self.page.value(TROUBLE))
        self.assertEqual(self.page.value("document.getElementById('trouble').getAttribute('role')"), "alert")
        self.can_be_read()
        self.assertEqual(self.page.value("document.querySelector('#health dd').textContent"), "storage short")
        self.press("start")
        self.page.until_said("storage short: room for ")
        # What the ballast gives back is filled too.
        while not self.page.value(f"{TROUBLE}.startsWith('storage waiting: ')"):
            fill(self.records)
            self.page.settle()
        self.assertIn("No space left on device", self.page.value(TROUBLE))
        self.can_be_read()
        # Two tests begin and end meanwhile; their numbers are there, and their records to come.
        ended = self.page.value("document.querySelectorAll('#tests tbody tr').length")
        self.page.until(f"document.querySelectorAll('#tests tbody tr').length >= {ended + 2}")
        waiting = self.page.value("[...document.querySelectorAll('#tests tbody tr')].slice(0, 2).map(r => [...r.cells].map(c => c.textContent))")
        for row in waiting:
            self.assertFalse(row[-1].endswith(".h5"), row)
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            self.page.screenshot(pathlib.Path(folder) / "full-disk.png")
        (self.records / "filler").unlink()
        self.page.until("document.getElementById('trouble').hidden")
        numbers = [row[0] for row in waiting]
        self.page.until(f"[...document.querySelectorAll('#tests tbody tr')].filter(r => {numbers}.includes(r.cells[0].textContent) && r.cells[r.cells.length - 1].textContent.endsWith('.h5')).length === 2")
        for row in waiting:
            with h5py.File(self.daemon.record(int(row[0]))) as record:
                self.assertEqual(record["entry/process/status"].asstr()[()], "complete")
                for cell, name in zip(row[2:5], ("delta_mu", "mu_s", "mu_k")):
                    self.assertEqual(cell, uncertain.of(record, name), name)
        self.assertEqual(self.daemon.end()[0], 0)

    def test_a_board_that_is_not_there_is_told_and_commands_are_refused(self):
        self.open(board=NO_BOARD)
        self.page.until(f"{TROUBLE}.startsWith('board missing: ')")
        self.assertIn("/dev/comedi-that-is-not-there", self.page.value(TROUBLE))
        self.can_be_read()
        self.assertEqual(self.page.value("document.getElementById('bench-word').textContent"), "degraded")
        self.press("start")
        self.page.until_said("no scans come from the board")

    def test_a_daemon_that_comes_back_is_found_again(self):
        self.open()
        self.page.until("Scope.data.scan.length > 100")
        first = self.address
        self.daemon.end()
        self.page.until(f"{TROUBLE}.startsWith('the daemon does not answer')")
        self.assertEqual(self.page.value("document.getElementById('bench-word').textContent"), "not connected")
        config = self.daemon.folder / "d.toml"
        port = first.rsplit(":", 1)[1].rstrip("/")
        config.write_text(config.read_text(encoding="utf-8").replace("127.0.0.1:0", f"127.0.0.1:{port}"), encoding="utf-8")
        self.daemon.start()
        self.page.until("document.getElementById('trouble').hidden && document.getElementById('bench-word').textContent !== 'not connected'")
        # The scope begins anew with each stream, and may be empty again after it was not: one question for both.
        self.page.until("(window.firstScan ??= Scope.data.scan.at(-1)) !== undefined && Scope.data.scan.length > 0"
                        " && Scope.data.scan.at(-1) !== window.firstScan")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    if no_mounts := own_mounts(needed=False):
        print(f"the test of the full disk is skipped: {no_mounts}")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

"""The package in a whole Debian 12: installed, its user and groups, a board that goes and returns, an orderly end,
removal."""

import json
import pathlib
import re
import tempfile
import unittest

import codes
import debian
import guest
import kernel
import support
import verdict

SCENE = "stick-slip-at-12-in-per-min"


def lines(path):
    return path.read_text().splitlines()


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        found = kernel.find_kernel()
        disk = support.or_skip(debian.disk_image, found, [support.DAEMON, support.CLI])
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            # A pull longer than the guest looks at it.
            played = codes.write_codes(folder, codes.simulate(folder, SCENE, "--duration", "5 min"))
            [package] = support.PACKAGE.glob("*.deb")
            files = {"run.sh": support.HERE / "guest" / "service.sh", "unit.sh": support.HERE / "guest" / "unit.sh", "stickslip.deb": package,
                     "stickslip_tester.ko": support.tester_module(found), "codes.bin": played,
                     "freeze_thread": support.FREEZE_THREAD}
            cls.results = debian.run_full_guest(guest.folder_for(support.FOLDER, "service"), found, disk, files)

    def status(self, when):
        return support.status(self.results, ".", when)

    def test_installed_without_a_board_it_waits(self):
        self.assertEqual(self.status("installed")["state"], "board missing")

    def test_the_board_has_a_link_by_its_place(self):
        self.assertEqual((self.results / "link").read_text(), "/dev/comedi0\n")

    def test_the_demo_needs_no_privilege(self):
        # The legend has the word without numbers.
        self.assertEqual(len(re.findall(r"(?m)^truth  .*\d", (self.results / "demo.txt").read_text(encoding="utf-8"))), 10)

    def test_it_acquires_from_the_board_of_the_kernel(self):
        self.assertEqual(self.status("test-board")["state"], "acquiring")

    def test_the_service_has_little_to_lose(self):
        [line] = [line for line in lines(self.results / "security.txt") if "Overall exposure level" in line]
        self.assertLessEqual(float(line.split(":")[1].split()[0]), 2.0, line)

    def test_the_board_belongs_to_group_iocard(self):
        self.assertEqual(lines(self.results / "device"), ["660 root iocard"])

    def test_the_daemon_runs_as_its_own_user_in_group_iocard_without_privilege(self):
        process = dict(line.split(":", 1) for line in lines(self.results / "process"))
        [user] = lines(self.results / "user")
        self.assertNotEqual(user, "0")
        self.assertEqual(set(process["Uid"].split()), {user})
        self.assertIn(lines(self.results / "iocard")[0], process["Groups"].split())
        self.assertEqual(int(process["CapEff"], 16), 0)
        self.assertEqual(process["NoNewPrivs"].strip(), "1")

    def test_it_acquires_in_real_time(self):
        status = self.status("started")
        self.assertEqual(status["state"], "acquiring")
        self.assertTrue(status["scheduling"].startswith("SCHED_FIFO"), status["scheduling"])

    def test_it_survives_removal_and_return(self):
        self.assertEqual(self.status("gone")["state"], "board missing")
        self.assertIn("board missing", (self.results / "text-gone").read_text())
        self.assertEqual(self.status("returned")["state"], "acquiring")
        self.assertIn("acquiring", (self.results / "text-returned").read_text())

    def test_it_stops_in_order(self):
        self.assertEqual(lines(self.results / "end"),
                         ["ActiveState=inactive", "Result=success", "ExecMainStatus=0", "NRestarts=0"])

        # In the guest, whose processor is translated.
        self.assertLess(int(lines(self.results / "stop-seconds")[0]), 10)

    def test_every_scan_is_in_records_of_its_user(self):
        files = lines(self.results / "files")
        # The test that the removal ended, and the one that the end of the daemon ended.
        self.assertEqual(len(files), 2, files)
        for file in files:
            self.assertRegex(file, r"^640 stickslip stickslip /.*\.h5$")
        for path in sorted((self.results / "records").glob("*.h5")):
            verdict.judge(path)

    def test_the_journal_has_fields_to_filter_by(self):
        def events(file, event):
            return [entry for entry in map(json.loads, lines(self.results / file)) if entry.get("STICKSLIP_EVENT") == event]
        self.assertIn("board missing", {entry["STICKSLIP_STATE"] for entry in events("journal.json", "board-unavailable")})
        [began, *_] = events("journal.json", "test-began")
        self.assertEqual((began["STICKSLIP_TEST"], began["PRIORITY"], began["SYSLOG_IDENTIFIER"]), ("1", "6", "stickslipd"))
        self.assertIn("test 1 began", began["MESSAGE"])
        # Its daemon lived on: the board went.
        ended = {entry["STICKSLIP_TEST"]: entry["STICKSLIP_CAUSE"] for entry in events("journal.json", "test-ended")}
        self.assertEqual(ended["1"], "board-missing")
        finished = {entry["STICKSLIP_TEST"]: entry["STICKSLIP_RECORD"] for entry in events("journal.json", "record-finished")}
        self.assertRegex(finished["1"], r"^/var/lib/stickslip/records/.*\.h5$")
        # By the field alone, as an administrator asks.
        [gap, *_] = [gap for gap in events("gaps.json", "gap") if gap["STICKSLIP_CAUSE"] == "board-missing"]
        self.assertEqual(gap["PRIORITY"], "4")
        self.assertGreater(int(gap["STICKSLIP_SCAN_COUNT"]), 0)
        self.assertNotIn("STICKSLIP_TEST", gap)

    def test_a_reload_is_no_new_start(self):
        self.assertEqual(self.status("reloaded")["state"], "board missing")

    def test_each_thread_that_hangs_has_the_daemon_started_again(self):
        log = (self.results / "watchdog.txt").read_text()
        self.assertEqual(log.count("Watchdog timeout"), 4, log)
        for part in ("acquisition", "detector", "disk"):
            self.assertRegex(log, f"watchdog: not moving: .*{part}")
        for thread in ("acquisition", "processing", "disk", "stickslipd"):
            self.assertEqual(self.status(f"after-{thread}")["state"], "acquiring")

    def test_who_asks_by_the_socket_starts_the_daemon(self):
        self.assertIn('"state"', (self.results / "activated.json").read_text())

    def test_a_purge_leaves_nothing_but_the_data(self):
        left = [path for path in lines(self.results / "left") if path != "/var/lib/stickslip"]
        self.assertEqual(left, ["/usr/lib/firmware/stickslip-codes.bin"])
        self.assertEqual((self.results / "audit").read_text(), "")


if __name__ == "__main__":
    unittest.main()

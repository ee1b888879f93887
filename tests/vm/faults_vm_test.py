"""Overrun, removal and return, a rival, a board without permission: what the daemon says, and what its records do.

The codes that the virtual tester plays tell which scan is which, so an estimated gap is judged by what was really
lost.
"""

import json
import pathlib
import re
import tempfile
import unittest

import numpy

import codes
import support
import verdict

SCENE = "stick-slip-at-12-in-per-min"
# What the scene says; a test of ten seconds measures it to 0.001 and better.
SCENE_MU_S, SCENE_MU_K = 0.35, 0.30
# Three tests, each with noise of its own.
SEEDS = (101, 102, 103)
TEST_DURATION_S = 14
OVERRUN_SCANS = 700
# Of an index found by the clock: the last read may have come one scan late, and so may the restart.
INDEX_TOLERANCE = 2


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            cls.codes = numpy.concatenate([codes.simulate(folder, SCENE, "--duration", f"{TEST_DURATION_S} s", "--seed",
                                                          str(seed)) for seed in SEEDS])
            lost = folder / "lost"
            lost.write_text(f"{OVERRUN_SCANS}\n")
            people = folder / "passwd"
            people.write_text("root:x:0:0::/:/bin/sh\nstickslip:x:1000:1000::/:/bin/sh\n")
            groups = folder / "group"
            groups.write_text("root:x:0:\niocard:x:999:\nstickslip:x:1000:\n")
            cls.results = support.small_guest("faults", {
                "/lib/firmware/stickslip-codes.bin": codes.write_codes(folder, cls.codes),
                "/faults/overrun_scans": lost, "/etc/passwd": people, "/etc/group": groups})

    def judged(self, daemon):
        return [verdict.judge(path) for path in support.records(self.results, daemon)]

    def status(self, daemon, when):
        return support.status(self.results, daemon, when)

    def place(self, scan, counts):
        """By how many scans the index is ahead of the code played."""
        return int(scan[0]) - verdict.played_from(self.codes, counts)

    def test_an_overrun_is_a_gap_as_long_as_what_was_lost(self):
        # The pulls that follow are none of its business.
        record = self.judged("overrun")[0]
        [gap] = record.gaps
        self.assertEqual((gap.cause, gap.estimated), ("overrun", True))
        before = record.scan < gap.first
        self.assertEqual(self.place(record.scan[before], record.counts[before]), 0)
        ahead = self.place(record.scan[~before], record.counts[~before])
        print(f"\ngap of {gap.count} scans, {gap.count - ahead} were lost")
        self.assertLessEqual(abs(ahead), INDEX_TOLERANCE)
        self.assertGreaterEqual(gap.count - ahead, OVERRUN_SCANS)
        status = self.status("overrun", "after")
        self.assertEqual((status["overrun_count"], status["gap_count"], status["dropped_scan_count"]), (1, 1, 0))
        # Stick and slip went on, and the test came to its own end: the gap cost the cycles that it touched.
        self.assertEqual((record.status, record.reasons), ("complete", []))
        self.assertEqual(record.results["regime"], "stick-slip")
        self.assertAlmostEqual(record.results["mu_s"], SCENE_MU_S, delta=0.005)
        self.assertAlmostEqual(record.results["mu_k"], SCENE_MU_K, delta=0.005)
        self.assertEqual(record.results["lost_scan_count"], gap.count)

    def test_a_removal_ends_the_test_as_incomplete(self):
        first = self.judged("removal")[0]
        self.assertEqual(first.status, "incomplete")
        self.assertIn("the board went away", " ".join(first.reasons))
        self.assertEqual(first.end_cause, "board-missing")
        self.assertEqual(first.gaps, [])
        self.assertEqual(self.place(first.scan, first.counts), 0)
        gone = self.status("removal", "gone")
        self.assertEqual(gone["state"], "board missing")
        # The device node may outlive its board for a moment, so either answer is the kernel's truth.
        self.assertRegex(gone["detail"], r"(no such device; plug the board in|no board behind this device; plug it in)")

    def test_a_returned_board_measures_on_and_the_index_tells_the_time(self):
        first, *others = self.judged("removal")
        self.assertEqual(self.status("removal", "returned")["state"], "acquiring")
        self.assertGreaterEqual(len(others), 2)
        self.assertIn("complete", [record.status for record in others])
        for record in others:
            self.assertEqual(record.gaps, [])
            self.assertGreater(record.scan[0], first.scan[-1])
            ahead = self.place(record.scan, record.counts)
            print(f"\n{record.status} from scan {record.scan[0]}: index ahead by {ahead}")
            self.assertLessEqual(abs(ahead), INDEX_TOLERANCE)
        after = self.status("removal", "after")
        self.assertEqual((after["board_loss_count"], after["overrun_count"]), (1, 0))

    def test_the_gap_between_the_tests_has_its_cause(self):
        first, second, *_ = self.judged("removal")
        log = (self.results / "removal" / "daemon.log").read_text()
        [(count, start, cause)] = re.findall(r"gap: about (\d+) scans missing from scan (\d+): (\S+)", log)
        self.assertEqual((int(start), cause), (int(first.scan[-1]) + 1, "board-missing"))
        after = self.status("removal", "after")
        self.assertEqual((after["gap_count"], after["lost_scan_count"]), (1, int(count)))
        # By the codes: what the board played in between, and what the pre-trigger time left out behind it.
        lost = verdict.played_from(self.codes, second.counts) - verdict.played_from(self.codes, first.counts) \
            - len(first.counts)
        unrecorded = int(second.scan[0]) - int(start) - int(count)
        self.assertGreaterEqual(unrecorded, 0)
        self.assertLessEqual(abs(int(count) + unrecorded - lost), INDEX_TOLERANCE)

    def test_a_board_that_returns_under_another_device_file_is_followed(self):
        gone = self.status("renamed", "gone")["detail"]
        self.assertIn('no board with serial "01A2B3C4"', gone)
        self.assertIn("there is /dev/comedi0: comedi_test (comedi_test)", gone)
        board = self.status("renamed", "returned")["board"]
        self.assertEqual((board["device"], board["serial"], board["bus_path"]),
                         ("/dev/comedi1", "01A2B3C4", "platform-stickslip_tester"))
        first, *others = self.judged("renamed")
        self.assertEqual((first.status, first.end_cause), ("incomplete", "board-missing"))
        self.assertGreaterEqual(len(others), 1)
        for record in others:
            self.assertLessEqual(abs(self.place(record.scan, record.counts)), INDEX_TOLERANCE)

    def test_another_board_behind_the_configured_device_file_is_told_and_not_taken(self):
        gone = self.status("taken", "gone")["detail"]
        self.assertIn("/dev/comedi0: another board has this device file now: comedi_test (comedi_test)", gone)
        self.assertIn("not stickslip_tester (stickslip_tester) as before", gone)
        self.assertIn('there is /dev/comedi1: stickslip_tester (stickslip_tester), serial "01A2B3C4"', gone)
        self.assertIn("another board has this device file now", (self.results / "taken" / "doctor.json").read_text())
        self.assertIn("another board has this device file now", (self.results / "taken" / "daemon.log").read_text())
        [test_board, tester] = json.loads((self.results / "taken" / "boards.json").read_text())["boards"]
        self.assertEqual((test_board["board"], test_board["serial"]), ("comedi_test", None))
        self.assertEqual((tester["device"], tester["serial"]), ("/dev/comedi1", "01A2B3C4"))
        self.assertIn('serial = "01A2B3C4"', tester["configuration"])
        self.assertEqual(self.status("taken", "returned")["board"]["device"], "/dev/comedi0")

    def test_a_rival_is_waited_for(self):
        waiting = self.status("second", "waiting")
        self.assertEqual(waiting["state"], "board busy")
        self.assertIn("another program is using it", waiting["detail"])
        self.assertEqual(self.status("second", "after")["state"], "acquiring")

    def test_a_rival_that_comes_later_harms_nothing(self):
        refused = self.status("rival", "refused")
        self.assertEqual(refused["state"], "board busy")
        self.assertIn("another program is using it", refused["detail"])
        record = self.judged("second")[0]
        self.assertEqual((record.gaps, record.status), ([], "complete"))
        verdict.played_from(self.codes, record.counts)

    def test_a_board_without_permission_is_named_and_waited_for(self):
        for when in ("no-group", "refused"):
            self.assertEqual(self.status("permission", when)["state"], "no permission")
            self.assertIn("permission denied", self.status("permission", when)["detail"])
        # What has to be done depends on the mode and the group of the node: of root alone, then of a group.
        self.assertIn("no group may use it (mode 0600)", self.status("permission", "no-group")["detail"])
        refused = self.status("permission", "refused")["detail"]
        self.assertIn("it is for group iocard: add the user (\"sudo adduser stickslip iocard\")", refused)
        log = (self.results / "permission" / "daemon.log").read_text()
        self.assertIn("warning: no permission: /dev/comedi0: permission denied", log)
        record = self.judged("permission")[0]
        self.assertEqual((record.gaps, record.status), ([], "complete"))
        self.assertEqual(self.place(record.scan, record.counts), 0)

    def test_a_stop_inside_a_test_interrupts_it(self):
        [record] = self.judged("stopped")
        self.assertEqual((record.status, record.end_cause), ("interrupted", "stopped"))
        self.assertEqual(record.gaps, [])


if __name__ == "__main__":
    unittest.main()

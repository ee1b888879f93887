#!/usr/bin/env python3
"""stickslip doctor in installations that are broken on purpose: each fault is found, under its name, with what is to be
done, and the exit status says so.

doctor_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import small_disk
from running_daemon import RunningDaemon

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SCENE = SOURCE / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
TIMEOUT_S = 120
# Nothing but a right to write is missing then; only root can become somebody else.
NOBODY = 65534

SIMULATED = f'[board]\ndriver = "simulated"\nclock_speed = 50\n[board.simulated]\nscenes = ["{SCENE}"]\n'
COMEDI = '[board]\ndriver = "comedi"\n[board.comedi]\ndevice = "{device}"\n[tester]\nsled_mass = "2331 g"\nload_cell_gain = "2 N/V"\n'


class Doctor(unittest.TestCase):
    def setUp(self):
        # Not below a folder that nobody else may enter.
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-", dir="/tmp")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.folder.chmod(0o755)

    def examine(self, text=None, folder=None, user=None, before=()):
        """({check: finding}, exit status); before: words of a command that runs the one given to it."""
        folder = folder or self.folder
        if text is not None:
            (folder / "d.toml").write_text(text, encoding="utf-8")
        done = subprocess.run([*before, str(self.program(user)), "doctor", "--config", "d.toml", "--json"], cwd=folder, capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False, **({"user": user, "group": user, "extra_groups": []} if user else {}))
        self.assertEqual(done.stderr, "")
        found = json.loads(done.stdout)
        self.assertEqual(found["exit_status"], done.returncode)
        for finding in found["findings"]:
            self.assertEqual(finding["to_do"] is None, finding["verdict"] == "good", finding)
            self.assertNotIn("\n", finding["what"])
        return {finding["check"]: finding for finding in found["findings"]}, done.returncode

    def program(self, user):
        """Where that user may run it: a build folder may be somebody's own."""
        if user is None:
            return CLI
        copy = self.folder / "stickslip"
        if not copy.exists():
            shutil.copy(CLI, copy)
            copy.chmod(0o755)
        return copy

    def expect(self, finding, verdict, what, to_do="."):
        self.assertEqual(finding["verdict"], verdict, finding)
        self.assertRegex(finding["what"], what)
        if verdict != "good":
            self.assertRegex(finding["to_do"], to_do)

    def test_a_running_daemon_in_order_has_nothing_bad(self):
        daemon = RunningDaemon(self, BUILD, SOURCE)
        found, status = self.examine(folder=daemon.folder)
        self.assertIn(status, (0, 3))
        self.assertEqual([f for f in found.values() if f["verdict"] in ("bad", "unknown")], [])
        self.expect(found["daemon"], "good", "acquiring at 350.0 Hz")
        self.expect(found["board"], "good", "in use by the daemon")
        self.expect(found["calibration"], "warning", "none", "stickslip calibrate")
        self.assertEqual(set(found), {"config", "daemon", "board", "rate", "calibration", "records", "filesystem", "disk", "realtime", "clock", "trend"})
        # The same for people: a line for each, and no colours in a pipe.
        text = subprocess.run([str(CLI), "doctor", "--config", "d.toml"], cwd=daemon.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(text.returncode, status)
        self.assertNotIn("\033", text.stdout)
        for check, finding in found.items():
            self.assertRegex(text.stdout, rf"(?m)^{finding['verdict']} +{check} ")

    def test_no_configuration_and_a_wrong_one(self):
        found, status = self.examine()
        self.assertEqual(status, 1)
        self.expect(found["config"], "bad", "d.toml.*there is no such file", "stickslip doctor --config FILE")
        self.assertEqual({check for check, finding in found.items() if finding["verdict"] == "unknown"},
                         {"daemon", "board", "calibration", "records", "filesystem", "disk", "realtime", "trend"})
        found, status = self.examine(SIMULATED + "[record]\nfolders = 1\n")
        self.expect(found["config"], "bad", r"d.toml:\d+: record.folders")
        found, status = self.examine(SIMULATED.replace("stick-slip-at", "no-such"))
        self.expect(found["config"], "bad", "no-such-12-in-per-min.toml")

    def test_no_daemon_and_what_it_left_behind(self):
        (self.folder / "records").mkdir()
        (self.folder / "records" / "20261122T101500Z-0001.journal").write_bytes(b"")
        found, status = self.examine(SIMULATED + '[control]\nsocket = "c.sock"\n')
        self.assertEqual(status, 1)
        self.expect(found["daemon"], "bad", "c.sock: nobody answers", "systemctl enable --now stickslipd")
        self.expect(found["board"], "good", "simulated tester")
        self.expect(found["records"], "warning", "1 journals of tests that a stop interrupted", "stickslip recover")
        self.expect(self.examine(SIMULATED)[0]["daemon"], "warning", "no control socket", r"\[control\] socket")

    def test_a_board_that_is_not_there(self):
        found, status = self.examine(COMEDI.format(device="/dev/comedi-nowhere"))
        self.assertEqual(status, 1)
        self.expect(found["board"], "bad", "/dev/comedi-nowhere", "stickslip boards")
        self.assertNotIn("rate", found)

    def test_scans_that_come_too_seldom(self):
        # A coupling of 37 N/mm with a sled of 2331 g oscillates at 20 Hz.
        for rate, verdict, what in (("40 Hz", "bad", "slips cannot be seen"), ("150 Hz", "warning", "peaks are missed"), ("2 kHz", "good", "2000 Hz")):
            with self.subTest(rate=rate):
                found, status = self.examine(SIMULATED.replace("clock_speed = 50", f'clock_speed = 50\nscan_rate = "{rate}"')
                                             + '[tester]\nsled_mass = "2331 g"\nstiffness = "37 N/mm"\n')
                self.expect(found["rate"], verdict, what, "scan_rate")
        self.expect(self.examine(SIMULATED)[0]["rate"], "warning", "not verifiable", "stickslip characterise")

    def test_a_calibration_that_is_over_or_soon_will_be(self):
        for days, verdict, what in ((0, "warning", "expire"), (20, "warning", "expires on"), (300, "good", "of 20")):
            with self.subTest(days=days):
                calibrations = self.folder / f"calibrations-{days}"
                subprocess.run([str(CLI), "calibrate", "--points", str(SOURCE / "config" / "calibration-readings.toml"), "--folder", str(calibrations),
                                "--valid-days", str(max(days, 1))], check=True, capture_output=True, timeout=TIMEOUT_S)
                if days == 0:
                    [file] = calibrations.glob("*.toml")
                    text = file.read_text(encoding="utf-8")
                    year = text.split('expires = "')[1][:4]
                    file.write_text(text.replace(f'expires = "{year}', f'expires = "{int(year) - 1}'), encoding="utf-8")
                self.expect(self.examine(SIMULATED + f'[tester]\ncalibration = "{calibrations}"\n')[0]["calibration"], verdict, what, "calibrate")

    def test_a_folder_of_records_that_is_none(self):
        (self.folder / "records").write_text("", encoding="ascii")
        found, status = self.examine(SIMULATED)
        self.assertEqual(status, 1)
        self.expect(found["records"], "bad", "records is no folder", r"\[record\] folder")

    def test_a_disk_for_reading_only(self):
        if (why := small_disk.why_none()) is not None:
            self.skipTest(f"no file system may be mounted here: {why}")
        (self.folder / "records").mkdir()
        mount = [*small_disk.namespace(), "sh", "-c", 'mount -t tmpfs -o ro tmpfs records && exec "$@"', "sh"]
        found, status = self.examine(SIMULATED, before=mount)
        self.assertEqual(status, 1)
        self.expect(found["records"], "bad", "mounted for reading only", "remount,rw")

    def test_a_broker_without_a_secret(self):
        (self.folder / "password").write_text("open sesame\n", encoding="ascii")
        (self.folder / "password").chmod(0o644)
        found, status = self.examine(SIMULATED + '[fleet]\nbroker = "mqtts://b"\ntester = "t"\nuser = "u"\npassword_file = "password"\n')
        self.assertEqual(status, 1)
        self.expect(found["fleet"], "bad", "everybody may read", "rights")

    @unittest.skipUnless(os.geteuid() == 0, "only root can become somebody who may not")
    def test_rights_that_are_missing(self):
        daemon = RunningDaemon(self, BUILD, SOURCE)
        daemon.folder.chmod(0o755)
        found, status = self.examine(folder=daemon.folder, user=NOBODY)
        self.assertEqual(status, 1)
        self.expect(found["daemon"], "bad", "c.sock: this user may not ask it", "usermod -aG stickslip")
        self.expect(found["records"], "bad", "may not write there", "chown stickslip")
        device = self.folder / "comedi0"
        device.write_bytes(b"")
        device.chmod(0)
        found, status = self.examine(COMEDI.format(device=device), user=NOBODY)
        self.expect(found["board"], "bad", "comedi0", "usermod -aG iocard")
        # Limits of real time: without a right to any.
        done = subprocess.run(["prlimit", "--rtprio=0:0", "--memlock=65536:65536", str(self.program(NOBODY)), "doctor", "--config", "d.toml", "--json"],
                              cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False, user=NOBODY, group=NOBODY, extra_groups=[])
        [realtime] = [f for f in json.loads(done.stdout)["findings"] if f["check"] == "realtime"]
        self.expect(realtime, "warning", "SCHED_FIFO 50 is wanted, 0 is allowed; 64 kB of memory may be locked", "LimitRTPRIO")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""The daemon as a service: its watchdog is fed while all parts move, SIGHUP has the configuration read again, and a
control socket may have been opened before it.

service_test.py BUILD_DIR SOURCE_DIR [unittest arguments]

Nothing here sleeps: each step waits for a notification, a line of the log or an answer.
"""

import pathlib
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

from service_manager import TIMEOUT_S, Manager

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
DAEMON = BUILD / "bin" / "stickslipd"
CLI = BUILD / "bin" / "stickslip"
FREEZE = BUILD / "tests" / "system" / "freeze_thread"
# Short, so that what hangs is soon seen: a part is looked at four times in it.
WATCHDOG_S = 2


class Service(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.file = self.folder / "service.toml"
        self.log = queue.Queue()

    def configure(self, scene="stick-slip-at-12-in-per-min", speed=20, more=""):
        self.file.write_text(f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["{SOURCE / 'config' / 'scenes' / scene}.toml"]
repeats = 0
[record]
folder = "records"
[control]
socket = "control.sock"
{more}""", encoding="utf-8")

    def start(self, **options):
        self.manager = Manager(self, self.folder)
        self.process = self.manager.start(DAEMON, self.file, self.folder, **options)
        self.addCleanup(self.end)
        self.reader = threading.Thread(target=lambda: [self.log.put(line) for line in self.process.stderr])
        self.reader.start()
        self.manager.wait_for(lambda text: text == "READY=1")
        # Notifications that nobody reads are left out, but for those that the daemon waits with.
        self.notified = queue.Queue()
        self.listener = threading.Thread(target=self.listen, daemon=True)
        self.listener.start()

    def listen(self):
        try:
            while True:
                self.notified.put(self.manager.socket.recv(4096).decode())
        except OSError:
            return

    def end(self):
        self.process.kill()
        self.process.wait(TIMEOUT_S)
        self.reader.join()
        self.process.stderr.close()
        self.process.stdout.close()

    def told(self, *wanted):
        while True:
            text = self.notified.get(timeout=TIMEOUT_S)
            if all(part in text for part in wanted):
                return text

    def logged(self, *wanted):
        while True:
            line = self.log.get(timeout=TIMEOUT_S)
            if all(part in line for part in wanted):
                return line

    def status(self):
        return subprocess.run([str(CLI), "status", "--socket", str(self.folder / "control.sock")], capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False)

    def frozen(self, thread):
        process = subprocess.Popen([str(FREEZE), str(self.process.pid), thread], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        if process.stdout.readline() != "frozen\n":
            self.skipTest(f"no thread can be stopped here: {process.communicate()[1]}")
        return process

    def hangs(self, thread, part):
        """The watchdog is fed no more, which the log and the state say, until the thread goes on."""
        # At a pace that leaves each thread time to wait, with a sanitizer too: it is stopped while it does.
        self.configure(speed=2)
        self.start(WATCHDOG_USEC=str(WATCHDOG_S * 1_000_000))
        self.told("WATCHDOG=1")
        process = self.frozen(thread)
        # On a busy machine others may stand still for a moment as well.
        self.logged("watchdog: not moving: ", part)
        self.told("does not move: ", part)
        # What was notified before is read; from now on there is no feed, until it moves again.
        self.assertNotIn("WATCHDOG=1", list(self.notified.queue))
        process.communicate()
        self.logged("watchdog: all parts move again")
        self.told("WATCHDOG=1")

    def test_a_board_that_hangs_is_not_covered_up(self):
        self.hangs("acquisition", "acquisition")

    def test_a_detector_that_hangs_is_not_covered_up(self):
        self.hangs("processing", "detector")

    def test_a_storage_that_hangs_is_not_covered_up(self):
        self.hangs("storage", "storage")

    def test_a_disk_that_hangs_is_not_covered_up(self):
        self.hangs("disk", "disk")

    def test_without_a_watchdog_none_is_fed(self):
        self.configure()
        self.start()
        self.logged("test 2 began")
        self.assertNotIn("WATCHDOG=1", list(self.notified.queue))

    def test_a_good_configuration_is_used_between_two_tests(self):
        self.configure(speed=10)
        self.start()
        self.logged("test 1 began")
        self.configure(speed=10, scene="ring-down-at-12-in-per-min")
        self.process.send_signal(signal.SIGHUP)
        self.logged("the configuration is good; used between two tests")
        self.assertIn("test 1 ended", self.logged("test 1 "))
        whole = self.folder / self.logged("test 1: ").split()[-1]
        self.told("RELOADING=1")
        self.told("READY=1")
        self.assertIn("ring-down-at-12-in-per-min", self.logged("info: board "))
        self.assertEqual(self.status().returncode, 0)
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(TIMEOUT_S), 0)
        verdict = subprocess.run([str(CLI), "verify", str(whole)], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual((verdict.returncode, verdict.stdout[:8]), (0, "complete"), verdict.stdout)

    def test_a_wrong_configuration_changes_nothing(self):
        self.configure()
        self.start()
        self.configure(more='[test]\nbegins = "sometimes"\n')
        self.process.send_signal(signal.SIGHUP)
        self.assertIn("begins", self.logged("reload: the configuration stays as it was"))
        self.logged(" began")
        self.assertEqual(self.status().returncode, 0)
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(TIMEOUT_S), 0)

    def test_a_stop_that_comes_while_a_reload_waits_is_a_stop(self):
        self.configure(speed=1)
        self.start()
        self.logged("test 1 began")
        self.process.send_signal(signal.SIGHUP)
        self.logged("used between two tests")
        self.process.send_signal(signal.SIGTERM)
        self.told("STOPPING=1")
        self.assertEqual(self.process.wait(TIMEOUT_S), 0)

    def test_who_connects_before_the_daemon_is_there_is_answered(self):
        path = self.folder / "control.sock"
        with socket.socket(socket.AF_UNIX) as listening, socket.socket(socket.AF_UNIX) as early:
            listening.bind(str(path))
            listening.listen()
            early.connect(str(path))
            early.settimeout(TIMEOUT_S)
            early.sendall(b"GET /v1/status HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            self.configure()
            self.start(listening=listening)
            self.assertTrue(early.recv(4096).startswith(b"HTTP/1.1 200"))
            # The same socket after a reload, and there still when the daemon has gone.
            self.process.send_signal(signal.SIGHUP)
            self.told("READY=1")
            self.assertEqual(self.status().returncode, 0)
            self.process.send_signal(signal.SIGTERM)
            self.assertEqual(self.process.wait(TIMEOUT_S), 0)
            self.assertTrue(path.is_socket())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

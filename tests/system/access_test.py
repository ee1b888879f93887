#!/usr/bin/env python3
"""What others of the machine can do to a running daemon: idle connections, a second daemon, stray signals.

access_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import http.client
import pathlib
import re
import signal
import socket
import subprocess
import sys
import unittest

from running_daemon import TIMEOUT_S, RunningDaemon, UnixConnection

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


class Access(unittest.TestCase):
    def daemon(self, config=""):
        return RunningDaemon(self, BUILD, SOURCE, config)

    def second(self, daemon, socket_name="d.sock"):
        """What a second daemon with the same record folder says and ends with."""
        config = (daemon.folder / "d.toml").read_text(encoding="utf-8").replace('"c.sock"', f'"{socket_name}"')
        (daemon.folder / "e.toml").write_text(config, encoding="utf-8")
        return subprocess.run([str(BUILD / "bin" / "stickslipd"), "--config", "e.toml"], cwd=daemon.folder, capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False)

    def test_who_has_the_token_is_answered_while_others_keep_connections(self):
        daemon = self.daemon('http = "127.0.0.1:0"\ntoken_file = "token"\n')
        host, port = daemon.port_line().split(":")
        token = (daemon.folder / "token").read_text(encoding="ascii").strip()
        idle = [socket.create_connection((host, port), TIMEOUT_S) for _ in range(40)]
        for half_said in idle[::2]:
            half_said.sendall(b"GET / HTTP/1.1\r\n")
        for _ in range(15):
            one = http.client.HTTPConnection(host, int(port), timeout=TIMEOUT_S)
            one.request("GET", "/v1/status", headers={"Authorization": f"Bearer {token}"})
            self.assertEqual(one.getresponse().status, 200)
            one.close()
        # Those that are left are let go within a second or so, answered or not.
        for one in idle:
            one.settimeout(TIMEOUT_S)
            try:
                while one.recv(4096):
                    pass
            except ConnectionResetError:
                pass
            one.close()

    def test_a_second_daemon_on_the_record_folder_is_refused_and_harms_nothing(self):
        daemon = self.daemon()
        refused = self.second(daemon)
        self.assertEqual(refused.returncode, 1)
        [line] = refused.stderr.splitlines()
        self.assertRegex(line, r"^stickslipd: record folder .*records: another stickslipd.* records into it: stop that one, or give this one a folder")
        locks = pathlib.Path("/proc/locks").read_text(encoding="ascii")
        if re.search(rf"FLOCK .* {daemon.process.pid} ", locks):
            self.assertIn(f"(process {daemon.process.pid})", line)
        self.assertEqual(daemon.ask("GET", "/v1/status")[0], 200)
        # A kill gives the folder back.
        daemon.kill()
        daemon.start()

    def test_a_second_daemon_on_the_socket_leaves_it_and_one_that_stops_leaves_anothers(self):
        daemon = self.daemon()
        other = self.daemon()
        there = daemon.socket
        config = (other.folder / "d.toml").read_text(encoding="utf-8").replace('"c.sock"', f'"{there}"')
        (other.folder / "d.toml").write_text(config, encoding="utf-8")
        other.end()
        refused = subprocess.run(other.command, cwd=other.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("another process is listening there", refused.stderr)
        there.unlink()
        other.start()
        self.assertEqual(daemon.end()[0], 0)
        other.socket = there
        self.assertEqual(other.ask("GET", "/v1/status")[0], 200)

    def test_signals_without_a_meaning_end_nothing(self):
        daemon = self.daemon()
        stray = [signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF, signal.SIGPIPE, signal.SIGIO, signal.SIGPWR,
                 signal.SIGSTKFLT, *range(signal.SIGRTMIN, signal.SIGRTMAX + 1)]
        for number in stray:
            daemon.process.send_signal(number)
        self.assertEqual(daemon.ask("GET", "/v1/status")[0], 200)
        code, log = daemon.end()
        self.assertEqual(code, 0, log)
        # The account closes: no thread was disturbed.
        self.assertRegex(log, r"scans: \d+ indices = \d+ in records \+ \d+ between tests \+ 0 in gaps")

    def test_a_listener_too_many_is_told_so_by_the_command_line(self):
        daemon = self.daemon()
        held = []
        for _ in range(24):
            one = UnixConnection(daemon.socket)
            one.request("GET", "/v1/live", headers={"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
                                                    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="})
            self.assertEqual(one.getresponse().status, 101)
            held.append(one)
        while daemon.ask("GET", "/v1/status")[1]["live_clients"]["count"] < 24:
            pass
        refused = daemon.run("watch")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("24 clients read the live stream", refused.stderr)
        for one in held:
            one.close()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

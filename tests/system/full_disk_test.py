#!/usr/bin/env python3
"""The real daemon on a disk that is full for real: a small file system in memory, in a mount namespace of its own.

full_disk_test.py BUILD_DIR SOURCE_DIR

Without the permission to mount it is skipped, and says so. Nothing sleeps: each step waits for what the daemon tells.
"""

import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile

from small_disk import fill, leave, mount, own_mounts

TIMEOUT_S = 240
ROOM_MIB = 48  # Enough for the ballast, which is kept where there are 16 MiB.


class Daemon:
    def __init__(self, build, source, folder):
        self.folder = folder
        config = folder / "test.toml"
        scene = source / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
        config.write_text(f"""
[board]
driver = "simulated"
clock_speed = 20
[board.simulated]
scenes = ["{scene}"]
repeats = 0
[record]
folder = "records"
[control]
socket = "c.sock"
[log]
level = "warning"
""", encoding="utf-8")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(folder / "notify"))
        self.process = subprocess.Popen([str(build / "bin" / "stickslipd"), "--config", str(config)], cwd=folder,
                                        env=dict(os.environ, NOTIFY_SOCKET=str(folder / "notify")),
                                        stderr=subprocess.PIPE, text=True)

    def told(self, timeout):
        self.socket.settimeout(timeout)
        try:
            return self.socket.recv(4096).decode()
        except TimeoutError:
            assert self.process.poll() is None, self.process.stderr.read()
            return ""

    def wait_for(self, wanted, meanwhile=lambda: None):
        for _ in range(TIMEOUT_S * 20):
            meanwhile()
            if wanted(text := self.told(0.05)):
                return text
        raise AssertionError("the daemon does not tell what it should")


def number_in(text):
    found = re.search(r"test (\d+) running", text)
    return int(found[1]) if found else 0


def main():
    build, source = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    with tempfile.TemporaryDirectory(prefix="stickslip-", ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        records = folder / "records"
        records.mkdir()
        mount(records, ROOM_MIB)
        daemon = Daemon(build, source, folder)
        try:
            daemon.wait_for(lambda text: number_in(text) >= 2)
            # Eight MiB are room for 7 min of tests, and short; tests go on.
            leave(records, 8 << 20)
            text = daemon.wait_for(lambda text: "storage short" in text)
            asked = subprocess.run([str(build / "bin" / "stickslip"), "status", "--json", "--socket", str(folder / "c.sock")],
                                   capture_output=True, text=True, check=True, timeout=TIMEOUT_S)
            status = json.loads(asked.stdout)
            assert status["state"] == "storage short" and status["storage"]["state"] == "short", status
            assert 0.0 < status["storage"]["room_h"] < 1.0 and str(records.name) in status["storage"]["to_do"], status
            # What the ballast gives back is filled too.
            text = daemon.wait_for(lambda text: "the disk refuses" in text, lambda: fill(records))
            assert "No space left on device" in text, text
            began = daemon.wait_for(lambda text: number_in(text) > 0 and "the disk refuses" in text)
            # Two tests begin and end meanwhile.
            daemon.wait_for(lambda text: number_in(text) >= number_in(began) + 2 and "the disk refuses" in text)
            (records / "filler").unlink()
            text = daemon.wait_for(lambda text: "STATUS=" in text and "the disk refuses" not in text)
            last = daemon.wait_for(lambda text: number_in(text) >= number_in(began) + 3)
            daemon.process.send_signal(signal.SIGTERM)
            errors = daemon.process.communicate(timeout=TIMEOUT_S)[1]
            assert daemon.process.returncode == 0, errors
            assert "the disk refuses" in errors and "the disk takes again" in errors, errors
            assert "storage short: room for" in errors and "there is room for tests again" in errors, errors
        finally:
            if daemon.process.poll() is None:
                daemon.process.kill()
                daemon.process.communicate()
        files = sorted(records.glob("*.h5"))
        numbers = sorted(int(file.stem.split("-")[1]) for file in files)
        assert numbers == list(range(1, len(files) + 1)) and len(files) >= number_in(last), numbers
        assert {file.name for file in records.iterdir()} - {"tester-history.jsonl"} == {file.name for file in files}, list(records.iterdir())
        judged = subprocess.run([str(build / "bin" / "stickslip"), "verify", "--json", *map(str, files)],
                                capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
        verdicts = json.loads(judged.stdout)["files"]
        for verdict in verdicts:
            # The last one was running when the daemon was told to stop.
            stopped = verdict is verdicts[-1] and [f["place"] for f in verdict["findings"]] == ["process/status"]
            assert verdict["judgement"] == "complete" or stopped, verdict
        scans = sum(verdict["scans_present"] for verdict in verdicts)
        print(f"{len(files)} tests with {scans} scans, {number_in(last) - number_in(began)} of them begun while or after the "
              "disk was full: all complete")
        subprocess.run(["umount", str(records)], check=False)
    return 0


if __name__ == "__main__":
    own_mounts()
    sys.exit(main())

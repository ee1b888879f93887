#!/usr/bin/env python3
"""Kills stickslipd with SIGKILL at random moments and looks at what is left.

torture.py BUILD_DIR SOURCE_DIR [--kills N] [--seed N] [--real-time N]

Simulated tests run one after the other, 25 times as fast as on a bench. The daemon is killed while it runs,
while a finaliser works (the daemon alone, the finaliser alone, both), and while it recovers from the kill before.
Before it is started again the journals are read by the reader below, which shares nothing with the program. Then:

- every journal has become a record that h5py opens, with exactly the scans of the journal;
- `stickslip verify` calls finished tests complete; interrupted ones are incomplete for that reason alone;
- no finished test is lost: of every run of the daemon the tests 1, 2, 3 … have a file each;
- an interrupted test has the results that `stickslip analyze` finds in its scans, to the last bit;
- records that were there before are the same bytes; nothing else lies about.

With the clock of the bench (--real-time) the daemon is asked how many scans there were, just before it is killed: at most one
second of them may be missing.
"""

import argparse
import collections
import contextlib
import hashlib
import json
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

from running_daemon import children
from stored import stored as stored_in
from stored import told

TIMEOUT_S = 240
SCAN_RATE_HZ = 350
SPEED = 25
LONGEST_LOSS_S = 1.0
HEAD = struct.Struct("<4sHHIIqq")
HEADER, SCANS, END = 1, 2, 8


class Failure(Exception):
    """A promise that was not kept."""


def expect(truth, what):
    if not truth:
        raise Failure(what)


def crc32c_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte >> 1) ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


CRC_TABLE = crc32c_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = CRC_TABLE[(crc ^ byte) & 0xFF] ^ (crc >> 8)
    return crc ^ 0xFFFFFFFF


Journal = collections.namedtuple("Journal", "scans counts has_header has_end")


def read_journal(path):
    """What stands in whole entries, by docs/record-file.md."""
    data = path.read_bytes()
    scans, counts, has_header, has_end = [], [], False, False
    at = 0
    while at + HEAD.size <= len(data):
        magic, kind, encoding, size, crc, first, stamp = HEAD.unpack_from(data, at)
        payload = data[at + HEAD.size:at + HEAD.size + size]
        head = HEAD.pack(magic, kind, encoding, size, 0, first, stamp)
        if magic != b"SSJ1" or len(payload) < size or crc32c(head + payload) != crc:
            break
        if kind == HEADER:
            has_header = True
        elif kind == SCANS:
            values = numpy.frombuffer(payload, {1: "<u2", 2: "<u4", 3: "<f8"}[encoding])
            counts.append(values)
            scans.append(numpy.arange(first, first + len(values)))
        elif kind == END:
            has_end = True
        at += HEAD.size + size
    join = lambda parts: numpy.concatenate(parts) if parts else numpy.array([], dtype=int)
    return Journal(join(scans), join(counts), has_header, has_end)


def kill(pid):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def wait_until_gone(pid):
    """An orphan has no parent here that could wait for it."""
    deadline = time.monotonic() + TIMEOUT_S
    while pathlib.Path(f"/proc/{pid}").exists():
        with contextlib.suppress(OSError):
            if pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z":
                return
        expect(time.monotonic() < deadline, f"process {pid} does not end")
        time.sleep(0.001)


class Torture:
    def __init__(self, build, source, folder, seed):
        self.daemon = build / "bin" / "stickslipd"
        self.cli = build / "bin" / "stickslip"
        self.scene = source / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
        self.folder = folder
        self.records = folder / "records"
        self.random = random.Random(seed)
        self.counts = collections.Counter()
        self.known = {}          # Checked records: path -> SHA-256.
        self.longest_loss_s = 0.0
        self.longest_queue_s = 0.0
        self.interrupted_scans = []
        self.process = None
        self.socket = None

    # ---- the daemon ---------------------------------------------------------------------

    def start(self, speed=SPEED):
        config = self.folder / "torture.toml"
        config.write_text(f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["{self.scene}"]
repeats = 0
[record]
folder = "records"
[control]
socket = "control.sock"
[log]
level = "warning"
""", encoding="utf-8")
        path = self.folder / "notify"
        path.unlink(missing_ok=True)
        if self.socket:
            self.socket.close()
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(path))
        self.socket.settimeout(1.0)
        # ThreadSanitizer and the like write their findings to the log.
        self.log = (self.folder / "log").open("ab")
        self.process = subprocess.Popen([str(self.daemon), "--config", str(config)], cwd=self.folder,
                                        env=dict(os.environ, NOTIFY_SOCKET=str(path)), stdout=self.log, stderr=self.log)
        self.log.close()

    def wait_for(self, wanted):
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            try:
                message = self.socket.recv(4096).decode()
            except TimeoutError:
                expect(self.process.poll() is None, f"the daemon ended by itself with {self.process.returncode}")
                expect(time.monotonic() < deadline, "the daemon says nothing")
                continue
            if wanted(message):
                return

    def status(self):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as control:
            control.settimeout(TIMEOUT_S)
            control.connect(str(self.folder / "control.sock"))
            control.sendall(b"GET /v1/status HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            answer = b""
            while part := control.recv(65536):
                answer += part
        return json.loads(answer.split(b"\r\n\r\n", 1)[1])

    def end(self, with_children=True):
        """Kills the daemon; its finalisers die with it or live on, as under an out-of-memory killer."""
        finalisers = children(self.process.pid)
        self.process.kill()
        self.process.wait(timeout=TIMEOUT_S)
        if not with_children:
            return
        for child in finalisers:
            kill(child)
        for child in finalisers:
            wait_until_gone(child)

    # ---- kills ----------------------------------------------------------------------------

    def kill_anywhere(self):
        time.sleep(self.random.uniform(0.0, 0.5))
        self.counts["with a finaliser at work"] += bool(children(self.process.pid))
        self.end()

    def kill_in_finaliser(self):
        """Waits for a finaliser, then for some of the time that it takes."""
        deadline = time.monotonic() + TIMEOUT_S
        while not (found := children(self.process.pid)):
            expect(time.monotonic() < deadline and self.process.poll() is None, "no finaliser comes")
        time.sleep(self.random.uniform(0.0, 0.03))
        what = self.random.choice(["both", "daemon alone", "finaliser first"])
        self.counts[f"in a finaliser, {what}"] += 1
        if what == "finaliser first":
            for child in found:
                kill(child)
            time.sleep(self.random.uniform(0.0, 0.02))
        self.end(with_children=what != "daemon alone")

    def kill_in_recovery(self):
        """Again, before the daemon has told that it is ready."""
        before = len(list(self.records.rglob("*.journal")))
        self.start()
        time.sleep(self.random.uniform(0.0, 0.12))
        self.end(with_children=self.random.random() < 0.7)
        self.counts["in recovery" if before else "at the start"] += 1

    # ---- what is left ------------------------------------------------------------------------

    def journals(self):
        found = {}
        for path in self.records.rglob("*.journal"):
            # A finaliser that lives on may be about to finish it.
            with contextlib.suppress(FileNotFoundError):
                found[path] = read_journal(path)
        return found

    def verify(self, files):
        if not files:
            return {}
        done = subprocess.run([str(self.cli), "verify", "--json", *map(str, files)], capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False)
        expect(done.returncode in (0, 1), f"verify ended with {done.returncode}: {done.stdout}{done.stderr}")
        return {verdict["file"]: verdict for verdict in json.loads(done.stdout)["files"]}

    def check_results(self, file):
        done = subprocess.run([str(self.cli), "analyze", "--json", str(file)], capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False)
        expect(done.returncode == 0, f"{file}: {done.stderr}")
        again = told(json.loads(done.stdout)["tests"][0])
        with h5py.File(file) as record:
            for name, stored in stored_in(record).items():
                if name in again and stored.dtype.kind == "f" and stored.shape == ():
                    if again[name] is None:
                        expect("reason" in stored.attrs, f"{file}: {name} has no value and no reason")
                    elif name != "scan_rate_measured":
                        expect(float(stored[()]) == again[name], f"{file}: {name} is {stored[()]}, not {again[name]}")

    def check_record(self, file, verdict, journal):
        with h5py.File(file) as record:
            scan, counts = record["entry/raw/scan"][()], record["entry/raw/counts"][()]
            status = record["entry/process/status"].asstr()[()]
        if journal is not None:
            expect(numpy.array_equal(scan, journal.scans) and numpy.array_equal(counts, journal.counts),
                   f"{file}: {len(scan)} scans, {len(journal.scans)} stood in the journal")
            wanted = "complete" if journal.has_end else "interrupted"
            expect(status == wanted, f"{file}: {status}, not {wanted}")
        if status == "complete":
            expect(verdict["judgement"] == "complete", f"{file}: {verdict}")
            self.counts["finished tests"] += 1
        else:
            expect(status == "interrupted" and verdict["judgement"] == "incomplete" and
                   [finding["place"] for finding in verdict["findings"]] == ["process/status"], f"{file}: {verdict}")
            self.counts["interrupted tests"] += 1
            self.interrupted_scans.append(len(scan))
            self.check_results(file)

    def check(self, journals):
        """After the daemon has recovered. `journals` stood there before it was started."""
        for path, journal in journals.items():
            expect(not path.exists(), f"{path} is still there")
            if journal.has_header:
                expect(path.with_suffix(".h5").exists(), f"{path} did not become a record")
            else:
                self.counts["journals without a header"] += 1
        for path, digest in self.known.items():
            expect(hashlib.sha256(path.read_bytes()).hexdigest() == digest, f"{path} was changed")
        running = set(self.records.rglob("*.journal"))
        new = sorted(set(self.records.rglob("*.h5")) - set(self.known))
        verdicts = self.verify(new)
        for file in new:
            self.check_record(file, verdicts[str(file)], journals.get(file.with_suffix(".journal")))
            self.known[file] = hashlib.sha256(file.read_bytes()).hexdigest()
        strangers = [path.name for path in self.records.rglob("*") if path.is_file() and path not in self.known and
                     path not in running and path.suffix not in (".h5", ".journal", ".part") and path.name != "tester-history.jsonl" and
                     not path.name.startswith(".")]
        expect(not strangers, f"left behind: {strangers}")

    def check_numbers(self, numbers):
        """Tests that one run of the daemon began: none is missing."""
        expect(sorted(numbers) == list(range(1, len(numbers) + 1)), f"tests {sorted(numbers)} of one run")

    def number_of(self, path):
        return int(path.stem.split("-")[1])

    def forget_old(self):
        """What was checked often enough goes away, or the folder grows."""
        for path in sorted(self.known)[:-5]:
            path.unlink()
            del self.known[path]

    # ---- rounds -----------------------------------------------------------------------------

    def round(self):
        """One kill at the usual speed, with those in recovery that follow it. \\return kills."""
        kills = 1
        self.start()
        self.wait_for(lambda text: text == "READY=1")
        before = set(self.records.rglob("*.h5"))
        self.check(self.left)
        if self.random.random() < 0.5:
            self.kill_in_finaliser()
        else:
            self.kill_anywhere()
        self.left = self.journals()
        names = {path.with_suffix(".h5") for path in self.left if self.left[path].has_header}
        self.check_numbers([self.number_of(path) for path in
                            (set(self.records.rglob("*.h5")) | names) - before - self.recovered_names()])
        while self.random.random() < 0.35:
            kept = dict(self.left)
            self.kill_in_recovery()
            kills += 1
            # What the killed recovery has finished already is not there any more; what it began itself is new.
            self.left = {**{path: journal for path, journal in kept.items()
                            if path.exists() or path.with_suffix(".h5").exists() or not journal.has_header},
                         **self.journals()}
            for path, journal in kept.items():
                expect(path in self.left, f"{path} is gone and left no record")
        self.forget_old()
        return kills

    def recovered_names(self):
        return set(self.known)

    def real_time_round(self):
        """Asked just before it is killed, at the pace of a bench."""
        self.start(speed=1)
        self.wait_for(lambda text: text == "READY=1")
        self.check(self.left)
        self.wait_for(lambda text: "running" in text)
        time.sleep(self.random.uniform(0.2, 3.0))
        asked = self.status()["scan_count"]
        self.end()
        self.left = self.journals()
        [journal] = [journal for journal in self.left.values() if not journal.has_end]
        lost_s = max(0, asked - 1 - int(journal.scans[-1])) / SCAN_RATE_HZ
        expect(lost_s <= LONGEST_LOSS_S, f"{lost_s:.3f} s are missing")
        self.longest_loss_s = max(self.longest_loss_s, lost_s)
        self.counts["at the pace of a bench"] += 1

    def run(self, kills, real_time):
        self.left = {}
        done = 0
        began = time.monotonic()
        told = began
        while done < kills:
            if self.counts["at the pace of a bench"] * kills < real_time * (done + 1):
                self.real_time_round()
                done += 1
            else:
                done += self.round()
            if time.monotonic() - told > 10:
                told = time.monotonic()
                print(f"{done} of {kills} kills, {told - began:.0f} s, {dict(self.counts)}", flush=True)
        self.start()
        self.wait_for(lambda text: text == "READY=1")
        self.check(self.left)
        self.process.send_signal(signal.SIGTERM)
        expect(self.process.wait(timeout=TIMEOUT_S) == 0, "the daemon did not end well")
        self.check({})
        expect(not list(self.records.rglob("*.part")), "a .part is left")
        print(f"{done} kills in {time.monotonic() - began:.0f} s: no scan that was committed is lost, every file is whole")
        for name, count in sorted(self.counts.items()):
            print(f"  {count:6d} {name}")
        print(f"  scans in interrupted tests: {min(self.interrupted_scans, default=0)} to "
              f"{max(self.interrupted_scans, default=0)}")
        if self.counts["at the pace of a bench"]:
            print(f"  longest loss at the pace of a bench: {self.longest_loss_s:.3f} s of {LONGEST_LOSS_S:g} s allowed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=30, help="a fifth of them under sanitizers")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--real-time", type=int, help="kills at the pace of a bench; else one in 25")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(2**32)
    real_time = options.real_time if options.real_time is not None else max(1, options.kills // 25)
    if options.build.resolve().name in ("asan", "tsan"):
        options.kills = max(1, options.kills // 5)
    print(f"torture: {options.kills} kills, --seed {seed}", flush=True)
    with tempfile.TemporaryDirectory(prefix="stickslip-torture-") as name:
        torture = Torture(options.build.resolve(), options.source.resolve(), pathlib.Path(name), seed)
        try:
            torture.run(options.kills, real_time)
        except Failure as failure:
            print(f"FAILED with --seed {seed}: {failure}", flush=True)
            print((torture.folder / "log").read_text(encoding="utf-8", errors="replace")[-4000:])
            return 1
        finally:
            if torture.process and torture.process.poll() is None:
                torture.end()
    return 0


if __name__ == "__main__":
    sys.exit(main())

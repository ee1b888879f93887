#!/usr/bin/env python3
"""Days of virtual time through the whole daemon, with troubles at random: nothing may be unaccounted for, nothing may grow.

soak.py BUILD_DIR SOURCE_DIR [--days N] [--seed N] [--speed N]

A simulated tester pulls one paper after the other, faster than a bench, and its scan index passes 2^32 on the first day. The
simulated board loses scans and is pulled out, its date is put right now and then ([board.simulated.faults]), its zero drifts by several
per cent of the sled's weight; from outside the disk is filled, the daemon is stopped for 10 to 70 s of its time, the file system has no
locks for a while, the journal of the running test or the whole folder of records is removed, the broker goes and comes, clients connect
and never read. In the first fifth of the time the daemon is killed as well; after it memory and file handles are watched.

Each record is read with h5py as soon as it is there, then removed. At the end of a life the daemon says what became of each index
that its boards gave: in records, between tests, in gaps. Here the same is counted from the records, and the gaps once more from the log and
from the records' tables of gaps; it must be the same. Of a daemon that was killed at most the last second is missing, and what waited for a full disk.
"""

import argparse
import collections
import contextlib
import itertools
import math
import os
import pathlib
import queue
import random
import re
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

import h5py

import broker
import small_disk
from running_daemon import RunningDaemon, children, scene_with
from service_manager import TIMEOUT_S

SCAN_RATE_HZ = 350
DAY_S = 86_400
WRAP = 1 << 32
#: A record takes a processor 0.08 s and a test 60 s of virtual time: a busy machine may fall behind by all tests of a day, 0.1 MiB each.
DISK_MIB = 256
#: So large a part of the memory may come or go between two quarters of the watched time.
FLAT = 0.01
#: A minute with the stop of 1 s and the return of 0.5 s: 21000 scans; 2^32 is scan 5296 of one, in the pull.
TIMES = {"idle": "13 s", "pull": "8 s", "rest": "37.5 s"}
PERIOD_S = 60
PERIOD = PERIOD_S * SCAN_RATE_HZ
PULL = 8 * SCAN_RATE_HZ
#: A removed journal is missed within a second and written anew; who kills the daemon before that has destroyed the test himself.
MISSED_S = 3
#: kMaxTests of daemon/types/test_log.hpp.
REMEMBERED_TESTS = 1000


#: A zero that creeps: 1/f noise slower than a test, of this standard deviation, as a coefficient. Three of them are 0.045.
DRIFT = """
[effects.drift_noise]
sd = 0.015
lowest_frequency = "1e-6 Hz"
highest_frequency = "1e-3 Hz"
"""
#: A stop of the daemon, in seconds of its time.
STALL_S = (10, 70)

#: A line of the log about a gap. What a full disk lost is no such line: it stands in the record alone.
GAP = re.compile(r"gap: (?:about )?(\d+) scans missing from scan (\d+): ")


class Failure(Exception):
    """A promise that was not kept."""


def expect(truth, what):
    if not truth:
        raise Failure(what)


class DeafClient:
    """Asks for the live stream and never reads it."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(str(path))
        self.socket.sendall(b"GET /v1/live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n")

    def close(self):
        self.socket.close()


def memory_kB(pid):
    found = re.search(r"VmRSS:\s+(\d+) kB", pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii"))
    return int(found[1])


def handle_count(pid):
    """Open handles but those of journals that are there: they wait for their records, and stop() sees to it that all are made."""
    count = 0
    for handle in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):
            count += not os.readlink(handle).endswith(".journal")
    return count


class Soak:
    def __init__(self, stack, build, source, days, seed, speed, disk_may_be_full):
        self.random = random.Random(seed)
        self.days, self.speed, self.disk_may_be_full = days, speed, disk_may_be_full
        self.addCleanup = stack.callback
        self.counts = collections.Counter()
        # In the records of this life of the daemon: scans; what a full disk lost; all other gaps, as (first, count).
        self.rows = self.refused = 0
        self.gaps = set()
        self.begins = []
        self.virtual_s = 0.0
        self.began = time.monotonic()
        self.deaf = None
        self.full_until = self.unlocked_until = None
        self.lost_at = -math.inf
        self.watched = []
        self.broker_folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="stickslip-soak-")))
        self.broker = broker.Broker(self, self.broker_folder)

        def prepare(folder):
            (folder / "disk").mkdir()
            if disk_may_be_full:
                small_disk.mount(folder / "disk", DISK_MIB)
                self.addCleanup(lambda: subprocess.run(["umount", "-l", str(folder / "disk")], check=False))
            (folder / "scene.toml").write_text(scene_with(source, TIMES) + DRIFT, encoding="utf-8")

        first_scan = WRAP - int(0.1 * DAY_S * SCAN_RATE_HZ)
        board = f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["scene.toml"]
repeats = 0
first_scan = {first_scan}
[board.simulated.faults]
overruns_every = "1 h"
losses_every = "6 h"
clock_steps_every = "1 h"
seed = {seed}
"""
        config = f'[fleet]\nbroker = "mqtt://127.0.0.1:{self.broker.port}"\ntester = "soak"\n'
        self.no_locks = self.broker_folder / "no-locks"
        environment = {"LD_PRELOAD": str(build / "tests/system/libno_locks.so"), "STICKSLIP_NO_LOCKS": str(self.no_locks)}
        self.daemon = RunningDaemon(self, build, source, config=config, board=board, prepare=prepare, records="disk/records",
                                    environment=environment)
        self.disk = self.daemon.folder / "disk"
        self.records = self.disk / "records"

    def status(self):
        return self.daemon.ask("GET", "/v1/status")[1]

    def stems(self):
        return {path.stem for path in self.records.rglob("2*.*")}

    def take_records(self, of=None):
        """Each record that is there, or of these names: its rows are counted, then it goes."""
        for path in sorted(self.records.rglob("*.h5")):
            if of is not None and path.stem not in of:
                continue
            with h5py.File(path) as file:
                entry = file["entry"]
                scans = entry["raw/scan"][:]
                table = entry["gaps"] if "gaps" in entry else None
                gaps = [] if table is None else [(int(first), int(count), cause.decode()) for first, count, cause in
                                                 zip(table["first_scan"], table["scan_count"], table["cause"])]
                stretches = [(first, first + count) for first, count, _ in gaps]
                lost = sum(count for _, count, _ in gaps)
                # A full disk may have taken the first or the last scans of a test, or all of them.
                edges = [*(int(scan) for scan in scans[:1]), *(int(scan) + 1 for scan in scans[-1:]), *itertools.chain(*stretches)]
                expect(len(scans) > 0 or any(cause == "storage-full" for *_, cause in gaps), f"{path.name}: no scan, and no full disk in {gaps}")
                begin, end = min(edges), max(edges)
                expect(end - begin == len(scans) + lost,
                       f"{path.name}: {len(scans)} scans and {lost} in gaps are not the {end - begin} indices from {begin} on")
                self.counts["across 2^32"] += int(len(scans) > 0 and scans[0] < WRAP <= scans[-1])
                self.counts["without a scan"] += int(len(scans) == 0)
            self.begins.append(begin)
            self.rows += len(scans)
            self.refused += sum(count for _, count, cause in gaps if cause == "storage-full")
            self.gaps |= {(first, count) for first, count, cause in gaps if cause != "storage-full"}
            self.counts["records"] += 1
            path.unlink()

    def free(self):
        (self.disk / "filler").unlink(missing_ok=True)
        self.full_until = None

    def stop_for(self, virtual_s, meanwhile=lambda: None):
        """The daemon stands still for so long of its time: a suspend, a debugger."""
        self.daemon.process.send_signal(signal.SIGSTOP)
        try:
            os.waitid(os.P_PID, self.daemon.process.pid, os.WSTOPPED)
            meanwhile()
            time.sleep(virtual_s / self.speed)
        finally:
            self.daemon.process.send_signal(signal.SIGCONT)

    def lose_journal(self):
        """While the daemon stands still: removes the journal of the running test, or the whole folder, if that journal is all that is in it
        and no finaliser, which goes on meanwhile, can put a record there."""
        if children(self.daemon.process.pid):
            return
        files = [path for path in self.records.rglob("2*") if path.is_file()]
        handles = pathlib.Path(f"/proc/{self.daemon.process.pid}/fd")
        if len(files) != 1 or files[0].suffix != ".journal" or not any(os.path.realpath(handle) == str(files[0].resolve()) for handle in handles.iterdir()):
            return
        self.lost_at = time.monotonic()
        if self.random.random() < 0.5:
            files[0].unlink()
            self.counts["journals removed"] += 1
        else:
            shutil.rmtree(self.records)
            self.counts["folders removed"] += 1

    def trouble(self, test):
        """At the end of a test; of each kind a few a day."""
        if self.full_until is not None:
            if test >= self.full_until:
                self.free()
        elif self.random.random() < 1 / 300 and self.disk_may_be_full:
            small_disk.fill(self.disk)
            # 60 tests of 10 s are what the daemon keeps in memory; beyond that, gaps.
            self.full_until = test + self.random.randint(1, 80)
            self.counts["full disks"] += 1
        if self.random.random() < 1 / 100:
            self.stop_for(self.random.uniform(*STALL_S))
            self.counts["stalls"] += 1
        if self.full_until is None and self.random.random() < 1 / 20:
            self.stop_for(0, self.lose_journal)
        if self.unlocked_until is not None:
            if test >= self.unlocked_until:
                self.no_locks.unlink()
                self.unlocked_until = None
        elif self.random.random() < 1 / 300:
            self.no_locks.touch()
            self.unlocked_until = test + self.random.randint(1, 20)
            self.counts["times without locks"] += 1
        if self.random.random() < 1 / 400:
            self.broker.stop()
            self.broker.start()
            self.counts["broker restarts"] += 1
        if self.random.random() < 1 / 200:
            if self.deaf:
                self.deaf.close()
            self.deaf = DeafClient(self.daemon.socket)
            self.counts["clients that do not read"] += 1

    def kill(self):
        status = self.status()
        before = status["scans"]
        disk_was_full = self.full_until is not None or status["storage"]["waiting_size"] > 0
        self.daemon.kill()
        self.counts["kills"] += 1
        self.free()
        left = self.stems()
        told = self.told_gaps()
        self.daemon.start()  # Makes records of the journals before it is ready.
        self.take_records(left)
        missing = before["issued"] - before["idle"] - before["in_gaps"] - self.rows
        # A second of wall time is on its way to the disk, a part of it as the beginning of a test to come; a full disk keeps 600 s in memory.
        allowed = (self.speed * 1.0 + (600 if disk_was_full else 0)) * SCAN_RATE_HZ
        expect(missing <= allowed, f"killed{' while the disk was full' if disk_was_full else ''}: {missing} scans of {before} are in no record, {allowed:.0f} may be")
        kind = "at kills while the disk was full" if disk_was_full else "at kills"
        self.counts[f"most scans under way {kind}"] = max(missing, self.counts[f"most scans under way {kind}"])
        self.end_life(before["issued"], told)

    def judge_pulls(self, begins, told):
        """Each pull of a life has its record, unless a gap that was told took some of it: a board that comes back in mid-pull sees no begin."""
        # The simulated tester goes on by the clock, whatever the daemon and its board do.
        phase = statistics.mode(begin % PERIOD for begin in begins)
        for one, other in zip(begins, begins[1:]):
            pull = phase + PERIOD * (round((one - phase) / PERIOD) + 1)
            while pull + PERIOD / 2 < other:
                expect(any(first < pull + PULL and pull < first + count for first, count in told),
                       f"a pull without a record: at scan {pull}, between the tests at {one} and {other}")
                self.counts["pulls in gaps"] += 1
                pull += PERIOD

    def told_gaps(self):
        return {(int(first), int(count)) for count, first in GAP.findall("".join(self.daemon.log))}

    def end_life(self, issued, told):
        self.rows = self.refused = 0
        self.gaps = set()
        begins = sorted(self.begins)
        self.begins = []
        self.judge_pulls(begins, told)
        self.virtual_s += issued / SCAN_RATE_HZ
        self.counts["indices"] += issued
        self.deaf = None

    def run(self):
        total_s = self.days * DAY_S
        tests = of_this_life = 0
        while True:
            line = self.daemon.unread.get(timeout=TIMEOUT_S)
            if "unaccounted" in line or "defect" in line:
                raise Failure(line)
            if not re.search(r"test \d+ ended at scan", line):
                continue
            tests += 1
            of_this_life += 1
            self.take_records()
            status = self.status()
            now_s = self.virtual_s + status["scans"]["issued"] / SCAN_RATE_HZ
            self.progress(now_s, total_s, tests)
            if now_s >= total_s:
                break
            self.trouble(tests)
            first_kill_is_due = self.counts["kills"] == 0 and now_s >= total_s / 10
            whole = time.monotonic() - self.lost_at > MISSED_S
            if whole and now_s < total_s / 5 and (first_kill_is_due or self.random.random() < 1 / 300):
                self.kill()
                of_this_life = 0
            # The daemon remembers so many tests; then its memory is as large as it gets.
            watching = now_s >= total_s / 5 and of_this_life > REMEMBERED_TESTS
            # Scans that wait for a full disk are in memory, as they should be.
            if watching and self.full_until is None and status["storage"]["waiting_size"] == 0:
                self.watched.append((memory_kB(self.daemon.process.pid), handle_count(self.daemon.process.pid)))
        self.counts["tests"] = tests
        self.stop()
        expect(self.counts["across 2^32"] > 0, "no record crosses index 2^32")
        self.judge_growth()

    def stop(self):
        self.free()
        status = self.status()
        self.counts["gaps of the last life"] = status["gap_count"]
        self.counts["boards lost in the last life"] = status["board_loss_count"]
        code, log = self.daemon.end()
        expect(code == 0, f"the daemon ended with {code}: {log[-2000:]}")
        self.take_records()
        journals = [path.name for path in self.records.rglob("*.journal")]
        expect(not journals, f"not made into records: {journals}")
        found = re.findall(r"scans: (\d+) indices = (\d+) in records \+ (\d+) between tests \+ (\d+) in gaps", log)
        expect(found, log[-2000:])
        issued, recorded, idle, in_gaps = (int(n) for n in found[-1])
        expect(issued == recorded + idle + in_gaps, f"unaccounted for: {found[-1]}")
        expect(recorded == self.rows, f"the daemon says {recorded} scans in records; h5py finds {self.rows}")
        told = self.told_gaps()
        expect(self.gaps <= told, f"in records, but not in the log: gaps {sorted(self.gaps - told)}")
        found_in_gaps = sum(count for _, count in told) + self.refused
        expect(in_gaps == found_in_gaps, f"the daemon says {in_gaps} scans in gaps; log and records have {found_in_gaps}, {self.refused} of them of a full disk")
        self.counts.update({"idle of the last life": idle, "in gaps of the last life": in_gaps, "recorded in the last life": recorded})
        print(f"\nthe last life: {issued} indices = {recorded} in records + {idle} between tests + {in_gaps} in gaps")
        self.end_life(issued, told)

    def judge_growth(self):
        expect(len(self.watched) >= 8, f"watched only {len(self.watched)} times")
        quarter = len(self.watched) // 4
        early, late = self.watched[quarter:2 * quarter], self.watched[-quarter:]
        memory = [statistics.median(kB for kB, _ in some) for some in (early, late)]
        # A handle that leaked is in each later count, so in the fewest. Those of the broker, clients and finalisers come
        # and go: they are in the middle of the earlier counts, but not in all.
        handles = [statistics.median(count for _, count in early), min(count for _, count in late)]
        print(f"memory {memory[0]:.0f} kB in the second quarter of the watched time, {memory[1]:.0f} kB in the last; handles {handles[0]:.0f} usually, then at least {handles[1]}")
        expect(abs(memory[1] - memory[0]) <= FLAT * memory[0], f"memory is not flat: {memory} kB")
        expect(handles[1] <= handles[0], f"file handles grow: {handles}")

    def progress(self, now_s, total_s, tests):
        if sys.stdout.isatty():
            wall_s = time.monotonic() - self.began
            print(f"\r{now_s / DAY_S:7.2f} of {total_s / DAY_S:g} days, {tests} tests, {now_s / wall_s:.0f} times real time ", end="", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--days", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--speed", type=float, default=500.0)
    arguments = parser.parse_args()
    no_disk = small_disk.why_none()
    if no_disk is None:
        small_disk.own_mounts()
    else:
        print(f"soak: the disk is never full, for no small one may be mounted here: {no_disk}")
    seed = arguments.seed if arguments.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"soak: {arguments.days:g} days, --seed {seed}", flush=True)
    with contextlib.ExitStack() as stack:
        soak = Soak(stack, arguments.build.resolve(), arguments.source.resolve(), arguments.days, seed, arguments.speed, no_disk is None)
        try:
            soak.run()
        except (Failure, queue.Empty) as failure:
            print(f"\nFAILED: {failure!r}\n{''.join(soak.daemon.log[-40:])}", file=sys.stderr)
            return 1
        finally:
            for what, count in sorted(soak.counts.items()):
                print(f"  {count:>12} {what}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

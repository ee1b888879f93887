#!/usr/bin/env python3
"""How long a scan takes from the board's read to a sink of the daemon, and to a program that listens to the live stream.

    bench/live_latency.py BUILD_DIR [SECONDS [CLIENTS [ROUNDS]]]

Runs the daemon at 350 scans/s on the simulated board. A `stickslip watch --json` listens for so long (10 s) in each of these
companies in turn, of so many clients (20) that listen already, and so often (12 times), because a virtual machine is not as fast in
one minute as in the next:

    alone
    20 connections    WebSocket clients of this daemon, all in one program that reads and forgets: what they cost the daemon
    20 programs       clients of this daemon, each a `stickslip watch --json`: that, and their own use of the processors
    20 elsewhere      the same programs at a daemon of their own: their use of the processors, and nothing of this daemon

Of each frame: the time at which the event came to the sink that made it (`sink_time`), and the time at which its line is read
here, less the time at which read() had come back in the daemon (`read_time`). The way to the sink goes through the ring and the
detector; the way to the listener goes on through the feed, the main thread, the socket, and the listener's own program and
pipe. Beside them, at the same time, how late a program wakes up that does nothing but sleep 4 ms: what the machine itself
takes, which no program can be faster than. What a company changes is told by the ratios of its rounds' medians to those alone:
their geometric mean and its standard error.
"""

import contextlib
import json
import math
import multiprocessing
import pathlib
import selectors
import socket
import statistics
import subprocess
import sys
import tempfile
import time

SLEEP_S = 4e-3
KINDS = [(kind, to) for kind in ("scans", "cycle") for to in ("sink", "listener")]
SCENE = pathlib.Path(__file__).resolve().parent.parent / "config/scenes/stick-slip-at-12-in-per-min.toml"
CONFIG = f"""
[board]
driver = "simulated"
[board.simulated]
scenes = ["{SCENE}"]
repeats = 0
[record]
folder = "records"
[control]
socket = "c.sock"
[log]
level = "warning"
"""
# RFC 6455, section 1.2; the key is the one of its example.
UPGRADE = (b"GET /v1/live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
           b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n")


class Daemon:
    """stickslipd in a folder of its own."""

    def __init__(self, programs, folder):
        folder.mkdir()
        (folder / "latency.toml").write_text(CONFIG, encoding="utf-8")
        self.folder = folder
        self.socket = folder / "c.sock"
        self.watch = [programs / "stickslip", "watch", "--json", "--socket", self.socket]
        self.process = subprocess.Popen([programs / "stickslipd", "--config", "latency.toml"], cwd=folder)
        while not self.socket.exists():
            time.sleep(0.05)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()

    @contextlib.contextmanager
    def listening_programs(self, count):
        """While it lasts, so many programs listen, each of which has heard something."""
        heard = [self.folder / f"heard-{i}" for i in range(count)]
        programs = []
        for path in heard:
            with path.open("w", encoding="utf-8") as file:
                programs.append(subprocess.Popen(self.watch, stdout=file))
        while not all(path.stat().st_size for path in heard):
            time.sleep(0.05)
        yield
        for program in programs:
            program.kill()
            program.wait()

    @contextlib.contextmanager
    def listening_connections(self, count):
        """While it lasts, so many WebSocket connections of one program are read."""
        all_heard, end = multiprocessing.Event(), multiprocessing.Event()
        reader = multiprocessing.Process(target=read_and_forget, args=(str(self.socket), count, all_heard, end), daemon=True)
        reader.start()
        all_heard.wait()
        yield
        end.set()
        reader.join()


def read_and_forget(path, count, all_heard, end):
    """So many connections to the live stream of a daemon, until `end`; `all_heard` once each has been sent something."""
    waiting = selectors.DefaultSelector()
    for _ in range(count):
        connection = socket.socket(socket.AF_UNIX)
        connection.connect(path)
        connection.sendall(UPGRADE)
        waiting.register(connection, selectors.EVENT_READ)
    heard = set()
    while not end.is_set():
        for key, _ in waiting.select(0.1):
            if not key.fileobj.recv(65536):
                raise SystemExit("the daemon has closed a connection")
            heard.add(key.fd)
        if len(heard) == count:
            all_heard.set()


def sleeper(end, late_ms):
    """Sends how late it woke up, again and again until `end` is set, as one list."""
    late = []
    while not end.is_set():
        begun = time.monotonic()
        time.sleep(SLEEP_S)
        late.append(1e3 * (time.monotonic() - begun - SLEEP_S))
    late_ms.send(late)


def latencies_ms(command, seconds):
    """{(kind of frame, how far): latencies in ms}"""
    found = {key: [] for key in KINDS}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
        end = time.monotonic() + seconds
        for line in listener.stdout:
            now = time.time()
            frame = json.loads(line)
            if frame["type"] in ("scans", "cycle") and frame.get("read_time"):
                found[frame["type"], "sink"].append(1e3 * (frame["sink_time"] - frame["read_time"]))
                found[frame["type"], "listener"].append(1e3 * (now - frame["read_time"]))
            if time.monotonic() > end:
                listener.kill()
                break
    return found


def one_round(daemon, seconds):
    """({(kind of frame, how far): latencies in ms}, how late the sleeper was)"""
    end, (received, sent) = multiprocessing.Event(), multiprocessing.Pipe(duplex=False)
    sleeping = multiprocessing.Process(target=sleeper, args=(end, sent), daemon=True)
    sleeping.start()
    found = latencies_ms(daemon.watch, seconds)
    end.set()
    late = received.recv()
    sleeping.join()
    return found, late


def part(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def tell(what, company, values):
    print(f"{what:<26} {company:<15} {len(values):>6} times   median {part(values, 0.5):6.3f} ms"
          f"   99 % {part(values, 0.99):6.2f} ms   largest {max(values):6.2f} ms")


def ratio_of_medians(rounds, alone):
    """(geometric mean of the ratios, its standard error)"""
    logs = [math.log(part(one, 0.5) / part(other, 0.5)) for one, other in zip(rounds, alone)]
    ratio = math.exp(statistics.mean(logs))
    return ratio, ratio * statistics.stdev(logs) / math.sqrt(len(logs))


def main(build, seconds="10", clients="20", rounds="12"):
    programs = pathlib.Path(build).resolve() / "daemon"
    count = int(clients)
    with tempfile.TemporaryDirectory(prefix="stickslip-latency-") as folder, \
            Daemon(programs, pathlib.Path(folder) / "watched") as daemon:
        @contextlib.contextmanager
        def elsewhere():
            with Daemon(programs, pathlib.Path(tempfile.mkdtemp(dir=folder)) / "other") as other:
                with other.listening_programs(count):
                    yield

        companies = {"alone": contextlib.nullcontext,
                     f"{count} connections": lambda: daemon.listening_connections(count),
                     f"{count} programs": lambda: daemon.listening_programs(count),
                     f"{count} elsewhere": elsewhere}
        found = {company: [] for company in companies}
        for _ in range(int(rounds)):
            for company, there in companies.items():
                with there():
                    found[company].append(one_round(daemon, float(seconds)))
        for company, parts in found.items():
            tell("a program that only sleeps", company, [value for _, late in parts for value in late])
        for kind, to in KINDS:
            for company, parts in found.items():
                tell(f"{kind} to the {to}", company, [value for times, _ in parts for value in times[kind, to]])
        alone = found.pop("alone")
        for key in KINDS:
            for company, parts in found.items():
                ratio, error = ratio_of_medians([times[key] for times, _ in parts], [times[key] for times, _ in alone])
                print(f"median of {' to the '.join(key)}, with {company} over that alone: {ratio:.2f} ± {error:.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])

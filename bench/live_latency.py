#!/usr/bin/env python3
"""How long a scan takes from the board's read to a sink of the daemon, and to a program that listens to the live stream.

    bench/live_latency.py BUILD_DIR [SECONDS [CLIENTS]]

Runs the daemon at 350 scans/s on the simulated board and listens for so long (60 s) alone, then beside so many others
(20), each a `stickslip watch --json` of its own, and again: two rounds. Of each frame: the time at which the event came to
the sink that made it (`sink_time`), and the time at which its line is read here, less the time at which read() had come
back in the daemon (`read_time`). The way to the sink goes through the ring and the detector; the way to the listener goes on
through the feed, the main thread, the socket, and the listener's own program and pipe. Beside them, at the same time, how late
a program wakes up that does nothing but sleep 4 ms: what the machine itself takes, which no program can be faster than.
"""

import json
import multiprocessing
import pathlib
import subprocess
import sys
import tempfile
import time

ROUNDS = 2
SLEEP_S = 4e-3
SCENE = pathlib.Path(__file__).resolve().parent.parent / "config/scenes/stick-slip-at-12-in-per-min.toml"


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
    found = {(kind, to): [] for kind in ("scans", "cycle") for to in ("sink", "listener")}
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


def part(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def main(build, seconds="60", clients="20"):
    programs = pathlib.Path(build).resolve() / "daemon"
    with tempfile.TemporaryDirectory(prefix="stickslip-latency-") as folder:
        config = pathlib.Path(folder) / "latency.toml"
        config.write_text(f"""
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
""", encoding="utf-8")
        watch = [programs / "stickslip", "watch", "--json", "--socket", pathlib.Path(folder) / "c.sock"]
        with subprocess.Popen([programs / "stickslipd", "--config", config], cwd=folder) as daemon:
            try:
                while not (pathlib.Path(folder) / "c.sock").exists():
                    time.sleep(0.05)
                found = {}
                late = {}
                for others in (0, int(clients)) * ROUNDS:
                    beside = [subprocess.Popen(watch, stdout=subprocess.DEVNULL) for _ in range(others)]
                    end, (received, sent) = multiprocessing.Event(), multiprocessing.Pipe(duplex=False)
                    sleeping = multiprocessing.Process(target=sleeper, args=(end, sent), daemon=True)
                    sleeping.start()
                    for (kind, to), values in latencies_ms(watch, float(seconds)).items():
                        found.setdefault((kind, to, others), []).extend(values)
                    end.set()
                    late.setdefault(others, []).extend(received.recv())
                    sleeping.join()
                    for other in beside:
                        other.kill()
                        other.wait()
                for others, values in late.items():
                    print(f"a program that only sleeps {others:>3} others {len(values):>5} times    median {part(values, 0.5):6.3f} ms"
                          f"   99 % {part(values, 0.99):6.2f} ms   largest {max(values):6.2f} ms")
                for (kind, to, others), values in found.items():
                    print(f"{kind:<6} to the {to:<9} {others:>3} others {len(values):>6} frames   median {part(values, 0.5):6.3f} ms"
                          f"   99 % {part(values, 0.99):6.2f} ms   largest {max(values):6.2f} ms")
                for kind, to in sorted({key[:2] for key in found}):
                    ratio = part(found[kind, to, int(clients)], 0.5) / part(found[kind, to, 0], 0.5)
                    print(f"median of {kind} to the {to}, with {clients} others over that without: {ratio:.2f}")
            finally:
                daemon.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])

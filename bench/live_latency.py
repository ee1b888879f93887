#!/usr/bin/env python3
"""How long a scan takes from the board's read to a program that listens to the live stream, with few listeners and many.

    bench/live_latency.py BUILD_DIR [SECONDS [CLIENTS]]

Runs the daemon at 350 scans/s on the simulated board and listens for so long (60 s) alone, then beside so many others
(20), each a `stickslip watch --json` of its own. Of each frame of scans: the time at which its line is read here less the
time at which read() had come back in the daemon (`read_time`). The way to the listener goes through the ring, the
detector, the feed, the main thread, the socket, and the listener's own program and pipe.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

SCENE = pathlib.Path(__file__).resolve().parent.parent / "config/scenes/stick-slip-at-12-in-per-min.toml"


def latencies_ms(command, seconds):
    found = {"scans": [], "cycle": []}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
        end = time.monotonic() + seconds
        for line in listener.stdout:
            now = time.time()
            frame = json.loads(line)
            if frame["type"] in found and frame.get("read_time"):
                found[frame["type"]].append(1e3 * (now - frame["read_time"]))
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
                medians = {}
                for others in (0, int(clients)):
                    beside = [subprocess.Popen(watch, stdout=subprocess.DEVNULL) for _ in range(others)]
                    found = latencies_ms(watch, float(seconds))
                    for other in beside:
                        other.kill()
                        other.wait()
                    for kind, values in found.items():
                        medians[kind, others] = part(values, 0.5)
                        print(f"{others:>3} others  {kind:<6} {len(values):>6} frames   median {part(values, 0.5):6.2f} ms   99 % {part(values, 0.99):6.2f} ms"
                              f"   largest {max(values):6.2f} ms")
                for kind in ("scans", "cycle"):
                    print(f"median of {kind} with {clients} others over that without: {medians[kind, int(clients)] / medians[kind, 0]:.2f}")
            finally:
                daemon.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])

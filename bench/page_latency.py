#!/usr/bin/env python3
"""How long a scan takes from the board's read to the pixels of the live page.

    bench/page_latency.py BUILD_DIR [SECONDS [CHROMIUM]]

Runs the daemon at 350 scans/s on the simulated board, tests one after the other, with the live page in Debian's Chromium
without a window and without a graphics card, for so long (60 s). Of each frame of scans in a test: the time at which the
browser has painted it less the time at which read() had come back in the daemon (`read_time`). A message that is posted
in an animation frame arrives behind the painting of that frame. bench/live_latency.py measures the same way as far as
a program that listens.
"""

import contextlib
import pathlib
import shutil
import sys
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
for folder in ("tests/browser", "tests/system"):
    sys.path.insert(0, str(SOURCE / folder))
from chromium import Chromium  # noqa: E402
from running_daemon import RunningDaemon  # noqa: E402

# Times in ms since 1970 by the clock of this machine, as the daemon's.
WATCH = """(() => {
  window.seen = [];
  const now = () => performance.timeOrigin + performance.now(), drawn = [], show = Scope.scans;
  const channel = new MessageChannel();
  channel.port1.onmessage = () => { const painted = now(); for (const frame of drawn.splice(0)) window.seen.push({...frame, painted}); };
  Scope.scans = frame => {
    const arrived = now();
    show(frame);
    if (frame.read_time == null) return;
    // The charts asked for the next animation frame before this does, and so draw before it.
    requestAnimationFrame(() => {
      drawn.push({read: 1000 * frame.read_time, arrived});
      channel.port2.postMessage(0);
    });
  };
})()"""


class Stack:
    """What RunningDaemon asks of a test."""

    def __init__(self, stack):
        self.addCleanup = stack.callback


def part(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def main(build, seconds="60", chromium="chromium"):
    with contextlib.ExitStack() as stack:
        browser = stack.enter_context(Chromium(shutil.which(chromium), build))
        daemon = RunningDaemon(Stack(stack), pathlib.Path(build).resolve(), SOURCE, speed=1,
                               config='http = "127.0.0.1:0"\ntoken_file = "token"\n')
        address = f"http://{daemon.port_line()}/"
        page = browser.open(f"{address}#token={(daemon.folder / 'token').read_text(encoding='ascii').strip()}")
        page.value(WATCH)
        time.sleep(float(seconds))
        seen = page.value("window.seen")
    print(f"{len(seen)} frames in tests of {float(seconds):.0f} s")
    for name in ("arrived", "painted"):
        ages_ms = [frame[name] - frame["read"] for frame in seen]
        print(f"{name:<8} median {part(ages_ms, 0.5):6.1f} ms   99 % {part(ages_ms, 0.99):6.1f} ms   largest {max(ages_ms):6.1f} ms")
    in_time = sum(frame["painted"] - frame["read"] <= 100 for frame in seen)
    print(f"painted within 100 ms: {100 * in_time / len(seen):.2f} %")


if __name__ == "__main__":
    main(*sys.argv[1:])

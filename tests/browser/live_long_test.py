#!/usr/bin/env python3
"""The live page of a bench that makes 8 tests a minute for a day: what it keeps does not grow. It is fed the frames that a running daemon
sends of one test, again and again, with their scans and numbers moved on, as fast as it takes them.

live_long_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]
STICKSLIP_PAGE_DAYS=7: a week.
"""

import collections
import json
import math
import os
import pathlib
import shutil
import sys
import unittest

from chromium import Chromium

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

TESTS = int(os.environ.get("STICKSLIP_PAGE_DAYS", "1")) * 24 * 60 * 8
PARTS = 8
LISTED = 1000  # Tests that the daemon lists.
MOST = {"scans": 1, "fall": 1, "cycle": 1, "bench": 1}  # Frames of a kind of each test: more would take hours, and leave nothing else behind.
MOST_BYTES = 150e6
# Of what lives at the end of a part: the tables differ by the digits of their numbers.
SAME_BYTES, SAME_NODES, SAME_LISTENERS = 0.2e6, 500, 20

# The live stream is the test's, and once it has begun so are the answers to what the page asks for again and again; all else is the daemon's.
BEFORE = """
window.WebSocket = class extends EventTarget {
  static CLOSING = 2;
  readyState = 1;
  constructor() { super(); window.stream = this; }
};
window.answers = {};
const own = window.fetch;
window.fetch = (path, options) => (path in window.answers ? Promise.resolve(new Response(window.answers[path]())) : own(path, options));
"""

# One test after the other, as the stream carries them: as text. A turn of the page's own loop after each 500, health each minute.
FEED = """
(async (frames, told, batch, listed) => {
  const scans = ["first_scan", "trigger_scan", "peak_scan", "seen_scan", "test_first_scan", "end_scan"];
  const begin = Math.min(...frames.filter(frame => frame.first_scan != null).map(frame => frame.first_scan));
  const length = 60 / 8 * frames.find(frame => frame.scan_rate != null).scan_rate;
  const send = frame => window.stream.dispatchEvent(new MessageEvent("message", {data: JSON.stringify(frame)}));
  let latest = 0;
  window.answers["/v1/batch"] = () => batch;
  window.answers["/v1/tests"] = () => JSON.stringify({...told, tests: Array.from({length: Math.min(listed, latest)}, (_, k) => ({...told.tests[0], number: latest - Math.min(listed, latest) + 1 + k}))});
  window.feed = async (first, end) => {
    for (let test = first; test < end; ++test) {
      for (const recorded of frames) {
        if (recorded.type === "health" && test % 8 !== 0) continue;
        const frame = {...recorded};
        for (const name of scans) if (frame[name] != null) frame[name] += test * length - begin;
        if (frame.test != null) frame.test = test;
        if (frame.spikes) frame.spikes = frame.spikes.map(scan => scan + test * length - begin);
        if (frame.type === "test-ended") latest = test;
        send(frame);
      }
      if (test % 500 === 0) await new Promise(done => { const channel = new MessageChannel(); channel.port1.onmessage = done; channel.port2.postMessage(0); });
    }
  };
})"""


class LongLife(unittest.TestCase):
    def recorded(self, daemon):
        """The frames of one test and of the health meanwhile."""
        process, frames = daemon.watch()
        try:
            kept, health, count = [], None, collections.Counter()
            for frame in frames:
                if frame["type"] == "health":
                    if health is None:
                        self.assertEqual(daemon.ask("POST", "/v1/start")[0], 200)
                    health = frame
                elif frame["type"] == "test-began":
                    kept, count = [frame], collections.Counter()
                elif kept:
                    count[frame["type"]] += 1
                    if count[frame["type"]] <= MOST.get(frame["type"], math.inf):
                        kept.append(frame)
                    if frame["type"] == "test-ended":
                        if all(count[kind] >= most for kind, most in MOST.items()):
                            return [*kept, health]
                        # It began where the scene's belt stands.
                        self.assertEqual(daemon.ask("POST", "/v1/start")[0], 200)
        finally:
            process.kill()
            process.wait()
            process.stdout.close()

    def test_what_it_keeps_does_not_grow(self):
        daemon = RunningDaemon(self, BUILD, SOURCE, config='http = "127.0.0.1:0"\ntoken_file = "token"\n[test]\nbegins = "command"\n')
        address = f"http://{daemon.port_line()}/#token={(daemon.folder / 'token').read_text().strip()}"
        frames = self.recorded(daemon)
        daemon.record(frames[0]["test"])
        told = daemon.ask("GET", "/v1/tests")[1]
        told["tests"] = told["tests"][-1:]
        batch = json.dumps(daemon.ask("GET", "/v1/batch")[1])
        browser = self.enterContext(Chromium(CHROMIUM, BUILD))
        page = browser.open(address, before=BEFORE)
        page.until("window.stream")
        page.value(f"{FEED}({json.dumps(frames)}, {json.dumps(told)}, {json.dumps(batch)}, {LISTED})")
        living = []
        for part in range(PARTS):
            page.value(f"window.feed({1 + part * TESTS // PARTS}, {1 + (part + 1) * TESTS // PARTS})")
            page.until(f"document.getElementById('trace-{(part + 1) * TESTS // PARTS}')")
            living.append(page.living())
        self.assertEqual(page.value("document.querySelectorAll('#tests tbody tr').length"), 200)
        self.assertEqual(page.complaints(), [])
        self.assertLess(max(one["bytes"] for one in living), MOST_BYTES)
        second, last = living[PARTS // 4:PARTS // 2], living[-PARTS // 4:]
        for what, same in (("bytes", SAME_BYTES), ("nodes", SAME_NODES), ("listeners", SAME_LISTENERS)):
            grown = min(one[what] for one in last) - min(one[what] for one in second)
            self.assertLess(grown, same, f"{what}: {[one[what] for one in living]}")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

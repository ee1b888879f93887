// The zero of the load cell, step by step: unload it, wait until it is quiet, tare. Whether it may be done, the daemon says.
"use strict";

const Tare = (() => {
  const kLooked = 5;           // s of scans that are looked at: the most that a tare takes the mean of.
  const kNow = 1;              // s of them that are what it reads now.
  const kMostScatter = 0.005;  // Of the weight: limit of the daemon's own check before a test.
  const kMostDrift = 0.0025;   // Between the halves: what that check allows a zero.
  const part = id => document.getElementById(`tare-${id}`);
  const dialog = part("dialog");
  let ask = null, changed = null, bench = "", doing = false, tared = false;
  let parts = [];     // {scan, lowest, highest}, one after the other without a gap, between tests.
  let heard = false;  // Scans, since the latest health: else what they said is the past.
  let granted = 0;    // Scans a second.

  const volts = value => `${value.toFixed(6)} V`;
  const digits = value => value.toFixed(4).replace("-0.0000", "0.0000");
  const say = (said, good) => { part("message").textContent = said; part("message").className = good ? "message good" : "message"; };
  const latest = seconds => parts.filter(({scan}) => scan > parts.at(-1).scan - seconds * granted);
  // Told once, not with each frame.
  const tell = (id, text) => { if (part(id).textContent !== text) part(id).textContent = text; };

  /// {mean} of the latest second, {scatter, drift} of all that are looked at; null without a whole second. Where a part has
  /// many scans its lowest and its highest stand for them: the scatter is then not told too small.
  function reading() {
    if (parts.length < 4 || parts.at(-1).scan - parts[0].scan < 0.9 * kNow * granted) return null;
    const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length;
    const both = some => some.flatMap(({lowest, highest}) => [lowest, highest]), all = both(parts), level = mean(all), half = parts.length >> 1;
    return {mean: mean(both(latest(kNow))), scatter: Math.sqrt(mean(all.map(value => (value - level) ** 2))),
      drift: mean(both(parts.slice(half))) - mean(both(parts.slice(0, half)))};
  }
  const quiet = now => now.scatter <= kMostScatter && Math.abs(now.drift) <= kMostDrift;
  function step(now) {
    if (doing) return "Taring …";
    if (["loading", "running", "finishing"].includes(bench)) return "A test is under way: let it end, or stop it.";
    if (now == null) return "Waiting for a second of scans …";
    if (tared) return "✓ Done. Put the sled back on.";
    if (!quiet(now)) return "Step 1 of 2: take the sled off the load cell, so that nothing pulls, and leave it alone for 5 s. ✗ Not quiet yet.";
    return "Step 2 of 2: ✓ quiet. If the sled is off and nothing pulls, tare.";
  }
  function render() {
    if (!dialog.open) return;
    const now = reading(), against = (value, limit) => `${digits(value)}, ${Math.abs(value) <= limit ? "✓ at most" : "✗ above"} ${limit}`;
    tell("reading", now == null ? "–" : digits(now.mean));
    tell("scatter", now == null ? "–" : against(now.scatter, kMostScatter));
    tell("drift", now == null ? "–" : against(now.drift, kMostDrift));
    tell("step", step(now));
    dialog.setAttribute("aria-busy", String(doing));
  }
  async function zero() { return (await ask("GET", "/v1/calibration")).in_use.zero; }

  part("open").addEventListener("click", async () => {
    say("");
    tared = false;
    part("done").hidden = true;
    part("zero").textContent = "–";
    dialog.showModal();
    part("do").focus();
    render();
    try { part("zero").textContent = volts(await zero()); } catch (error) { say(error.message); }
  });
  part("do").addEventListener("click", async () => {
    if (doing) return;
    doing = true;
    tared = false;
    say("");
    part("done").hidden = true;
    render();
    try {
      const before = await zero(), done = await ask("POST", "/v1/tare");
      part("before").textContent = volts(before);
      part("after").textContent = `${volts(done.zero)} ± ${done.zero_standard_error.toPrecision(2)} V`;
      part("zero").textContent = volts(done.zero);
      part("moved").textContent = `${done.moved_force.toPrecision(3)} N`;
      part("scans").textContent = String(done.scan_count);
      part("done").hidden = false;
      tared = true;
      parts = [];  // The next reading is by the new zero alone.
      say(`the zero is ${volts(done.zero)} from scan ${done.scan} on`, true);
      part("close").focus();
      await changed();
    } catch (error) {
      say(error.message);
    }
    doing = false;
    render();
  });
  part("close").addEventListener("click", () => dialog.close());

  return {
    /// \param asking  (method, path, body) → JSON. \param changing  what else shows the bench.
    connect(asking, changing) { ask = asking; changed = changing; },
    health(status) {
      bench = status.bench;
      if (!heard) parts = [];
      heard = false;
      render();
    },
    bench(state) { bench = state; render(); },
    gone() { parts = []; render(); },
    scans(frame) {
      granted = frame.scan_rate;
      heard = true;
      // As the daemon has it: neither a test nor a gap is in the mean.
      if (frame.test != null || (parts.length > 0 && frame.first_scan !== parts.at(-1).scan + frame.scans_in_part)) parts = [];
      if (frame.test == null) frame.lowest.forEach((lowest, k) => { if (lowest != null) parts.push({scan: frame.first_scan + k * frame.scans_in_part, lowest, highest: frame.highest[k]}); });
      parts = latest(kLooked);
      render();
    },
  };
})();

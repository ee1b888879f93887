// The live charts. Times are scan index over scan rate: no clock of the browser has a say in them.
"use strict";

const Scope = (() => {
  const kWindows = [0.5, 1, 2, 5, 10, 20, 40];  // s, of the world's clock
  const kTurn = 50;  // Of a wheel, for one step: a touchpad sends many small ones.
  const kHeight = 0.18;  // Of the window: the first result stands above the fold.
  const kForceHeight = 0.22;  // Below these there is one line of text, not three.
  const kMostParts = 20000;
  const kMostSlips = 2000;
  const forceBox = document.getElementById("force");
  const slopeBox = document.getElementById("slope");
  const deltaBox = document.getElementById("delta");

  // Columns of the scope: time, lowest, highest, derivative of the middle.
  const data = {time: [], lowest: [], highest: [], slope: [], scan: []};
  const slips = [];   // {onset, capture, peak_time, peak, captured}
  const spikes = [];  // {scan, time, value}
  const cycles = {number: [], delta: [], amplitude: []};
  let falling = null;  // {time, peak} of the latest fall; its ring goes when its cycle closes
  let levels = null;   // {S, K} of the running or last test, drawn as lines
  let paused = null;   // {end: time at the right end, data} while the charts stand still.
  let zoomed = kWindows.indexOf(10), moved = false;
  let rate = 0, speed = 1, step = 1, dirty = false, newCycles = true;

  const latest = () => (data.time.length ? data.time[data.time.length - 1] : kWindows[zoomed]);
  const window_s = () => kWindows[zoomed] * speed;
  const xRange = () => { const end = paused?.end ?? latest(); return [end - window_s(), end]; };

  function marks(u) {
    const [from, end] = xRange(), ctx = u.ctx, size = 4 * devicePixelRatio;
    Chart.peaks(u, slips);
    Chart.lines(u, [["S", levels?.S, "--static"], ["K", levels?.K, "--kinetic"]]);
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    // A slip seen as it begins: a ring, until it is known what it was.
    if (falling && falling.time >= from && falling.time <= end && falling.time > (slips.at(-1)?.peak_time ?? -Infinity) + 1 / rate) {
      ctx.beginPath();
      ctx.arc(u.valToPos(falling.time, "x", true), u.valToPos(falling.peak, "y", true), 1.5 * size, 0, 2 * Math.PI);
      ctx.strokeStyle = Chart.colour("--mark");
      ctx.stroke();
    }
    ctx.strokeStyle = Chart.colour("--spike");
    for (const spike of spikes) {
      if (spike.time < from || spike.time > end) continue;
      const x = u.valToPos(spike.time, "x", true), y = u.valToPos(spike.value, "y", true);
      ctx.beginPath();
      ctx.moveTo(x - size, y - size); ctx.lineTo(x + size, y + size); ctx.moveTo(x + size, y - size); ctx.lineTo(x - size, y + size);
      ctx.stroke();
    }
    ctx.restore();
  }

  const {height, number} = Chart;
  const force = Chart.make(forceBox, height(kForceHeight), [Chart.line("--force"), Chart.line("--force")], xRange, {bands: [Chart.bands(1, 2)],
    hooks: {drawClear: [u => Chart.shade(u, slips)], draw: [marks], setCursor: [u => Chart.tell("force-at", u, k => `${u.data[0][k].toFixed(2)} s: ${Chart.range(u.data[1][k], u.data[2][k])} · `)]}});
  const slope = Chart.make(slopeBox, height(kForceHeight), [Chart.line("--force")], xRange,
    {hooks: {setCursor: [u => Chart.tell("slope-at", u, k => `${u.data[0][k].toFixed(2)} s: ${number(u.data[1][k], 2)} 1/s`)]}});
  const points = (name, size) => Chart.line(name, {width: 0, points: {show: true, size, fill: Chart.paint(name)}});
  const strip = Chart.make(deltaBox, height(kHeight), [points("--delta", 6), points("--amplitude", 5)], null, {
    scales: {x: {time: false}, y: {range: (u, low, high) => [0, Math.max(0.01, high * 1.1 || 0)]}},
    hooks: {setCursor: [u => Chart.tell("delta-at", u, k => `cycle ${cycles.number[k]}: S − K ${number(cycles.delta[k], 4)}, amplitude ${number(cycles.amplitude[k], 4)}`)]}});

  function draw() {
    requestAnimationFrame(draw);
    if (!dirty || (paused != null && !moved)) return;
    dirty = moved = false;
    const {time, lowest, highest, slope: rates} = paused?.data ?? data;
    const shown = `${Number(window_s().toPrecision(3))} s`, said = document.getElementById("window");
    if (said.textContent !== shown) said.textContent = shown;  // Told once, not with each frame.
    // Where each part is one scan, lowest and highest are one line.
    if (force.series[2].show !== step > 1) force.setSeries(2, {show: step > 1});
    force.setData([time, lowest, highest]);
    slope.setData([time, rates]);
    if (!newCycles || paused != null) return;
    newCycles = false;
    strip.setData([cycles.number, cycles.delta, cycles.amplitude]);
  }
  requestAnimationFrame(draw);

  function scans(frame) {
    rate = frame.scan_rate;
    speed = Math.max(1, frame.clock_speed);
    step = frame.scans_in_part;
    frame.lowest.forEach((low, k) => {
      const scan = frame.first_scan + k * step, middle = (low + frame.highest[k]) / 2, at = data.scan.length - 1;
      const follows = at >= 0 && scan - data.scan[at] === step && data.lowest[at] != null;
      if (at >= 0 && !follows) {  // A gap is a gap in the line.
        data.scan.push(scan - 1); data.time.push((scan - 1) / rate); data.lowest.push(null); data.highest.push(null); data.slope.push(null);
      }
      data.slope.push(follows ? (middle - (data.lowest[at] + data.highest[at]) / 2) * rate / step : null);
      data.scan.push(scan); data.time.push(scan / rate); data.lowest.push(low); data.highest.push(frame.highest[k]);
    });
    const old = data.time.findIndex(t => t >= latest() - kWindows.at(-1) * speed - 1);
    const cut = Math.max(old, data.time.length - kMostParts);
    if (cut > 500) for (const column of Object.values(data)) column.splice(0, cut);
    dirty = true;
  }
  const began = () => { for (const column of Object.values(cycles)) column.length = 0; dirty = newCycles = true; };
  function fall(frame) {
    falling = {time: frame.peak_scan / frame.scan_rate, peak: frame.peak};
    dirty = true;
  }
  function cycle(frame) {
    const at = t => (t == null ? null : frame.test_first_scan / frame.scan_rate + t);
    if (frame.peak_time != null) slips.push({test: frame.test, onset: at(frame.onset_time), capture: at(frame.capture_time), peak_time: at(frame.peak_time), peak: frame.peak, captured: frame.captured});
    if (slips.length > kMostSlips) slips.shift();
    cycles.number.push(frame.number); cycles.delta.push(frame.delta_mu); cycles.amplitude.push(frame.force_drop == null ? null : frame.force_drop / 2);
    dirty = newCycles = true;
  }
  function ended(frame) {
    falling = null;
    frame.spikes.forEach((scan, k) => spikes.push({scan, time: scan / frame.scan_rate, value: frame.spike_coefficients[k]}));
    if (spikes.length > 500) spikes.splice(0, spikes.length - 500);
    dirty = true;
  }
  /// A stream begins: perhaps of a daemon that counts its scans from 0 again.
  function clear() {
    for (const column of [...Object.values(data), ...Object.values(cycles), slips, spikes]) column.length = 0;
    falling = null;
    dirty = newCycles = true;
  }
  const resize = () => {
    force.setSize({width: forceBox.clientWidth, height: height(kForceHeight)});
    slope.setSize({width: slopeBox.clientWidth, height: height(kForceHeight)});
    strip.setSize({width: deltaBox.clientWidth, height: height(kHeight)});
  };
  window.addEventListener("resize", resize);

  /// \param own  {S, K}, or null.
  function level(own) {
    if (own?.S === levels?.S && own?.K === levels?.K) return;
    levels = own;
    dirty = true;
  }
  document.getElementById("pause").addEventListener("click", event => {
    paused = paused == null ? {end: latest(), data: Object.fromEntries(Object.entries(data).map(([name, column]) => [name, [...column]]))} : null;
    moved = true;  // Drawn once more, of what no scan changes.
    event.target.setAttribute("aria-pressed", String(paused != null));
    event.target.textContent = paused == null ? "Pause" : "Go on";
    dirty = true;
  });

  /// \param steps  above 0: a shorter time. \param at  stays where it is while the charts stand still; else the latest scan does.
  function zoom(steps, at) {
    const before = window_s(), next = Math.min(Math.max(zoomed - steps, 0), kWindows.length - 1);
    if (next === zoomed) return;
    zoomed = next;
    if (paused != null) {
      const [from, end] = [paused.end - before, paused.end], kept = at ?? (from + end) / 2;
      paused.end = Math.min(kept + (end - kept) * window_s() / before, paused.data.time.at(-1) ?? end);
    }
    dirty = moved = true;
  }
  for (const [id, steps] of [["zoom-in", 1], ["zoom-out", -1]]) document.getElementById(id).addEventListener("click", () => zoom(steps));
  document.getElementById("scope").addEventListener("keydown", event => {
    const steps = {"+": 1, "=": 1, "-": -1}[event.key];
    if (steps == null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    zoom(steps);
  });
  let turned = 0;
  for (const [box, u] of [[forceBox, force], [slopeBox, slope]]) box.addEventListener("wheel", event => {
    if (event.ctrlKey || (event.deltaY < 0 ? zoomed === 0 : zoomed === kWindows.length - 1)) return;  // The page's own zoom; the end: the page scrolls.
    event.preventDefault();
    turned = turned * event.deltaY < 0 ? event.deltaY : turned + event.deltaY;
    if (Math.abs(turned) < kTurn) return;
    zoom(-Math.sign(turned), u.posToVal(event.clientX - u.over.getBoundingClientRect().left, "x"));
    turned = 0;
  }, {passive: false});

  return {level, levels: () => levels, scans, began, fall, cycle, ended, clear, data, slips, spikes, cycles, force, slope};
})();

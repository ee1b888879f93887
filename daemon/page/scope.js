// The live charts. Times are scan index over scan rate: no clock of the browser has a say in them.
"use strict";

const Scope = (() => {
  const kWindow = 10;  // s
  const kHeight = 0.18;  // Of the window: the first result stands above the fold.
  const kForceHeight = 0.22;  // Below these there is one line of text, not three.
  const kMostParts = 20000;
  // One pixel of the screen: without a graphics card wider lines are drawn much more slowly.
  const kLine = 1 / devicePixelRatio;
  // Asked for at each drawing, read once: again where the reader's liking for dark or light changes.
  const colours = new Map();
  const colour = name => {
    if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
    return colours.get(name);
  };
  const paint = name => () => colour(name);
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
  let paused = null;   // The time at the right end while the charts stand still.
  let rate = 0, speed = 1, step = 1, dirty = false, newCycles = true;

  const height = part => Math.round(Math.max(90, window.innerHeight * part));
  const axes = label => [{stroke: paint("--soft"), grid: {stroke: paint("--line")}, ticks: {stroke: paint("--line")}, size: 28},
    {stroke: paint("--soft"), grid: {stroke: paint("--line")}, ticks: {stroke: paint("--line")}, size: 58, label, labelSize: 0}];
  const latest = () => (data.time.length ? data.time[data.time.length - 1] : kWindow);
  const window_s = () => kWindow * speed;
  const xRange = () => { const end = paused ?? latest(); return [end - window_s(), end]; };

  function shade(u) {
    const [from, to] = xRange(), ctx = u.ctx;
    ctx.save();
    let before = null, test = null;  // Where one test's last slip ends, no stick of the next begins.
    for (const slip of slips) {
      if (slip.peak_time < from - 1 || slip.onset == null) continue;
      const x = t => u.valToPos(Math.min(Math.max(t, from), to), "x", true);
      if (before != null && slip.test === test && slip.onset > before) {
        ctx.fillStyle = colour("--stick");
        ctx.fillRect(x(before), u.bbox.top, x(slip.onset) - x(before), u.bbox.height);
      }
      if (slip.capture != null) {
        ctx.fillStyle = colour("--slip");
        ctx.fillRect(x(slip.onset), u.bbox.top, x(slip.capture) - x(slip.onset), u.bbox.height);
      }
      before = slip.capture;
      test = slip.test;
    }
    ctx.restore();
  }

  function marks(u) {
    const [from] = xRange(), ctx = u.ctx, size = 4 * devicePixelRatio;
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    for (const slip of slips) {
      if (slip.peak_time < from) continue;
      ctx.beginPath();
      ctx.arc(u.valToPos(slip.peak_time, "x", true), u.valToPos(slip.peak, "y", true), size, 0, 2 * Math.PI);
      ctx.fillStyle = ctx.strokeStyle = colour("--mark");
      if (slip.captured) ctx.fill(); else ctx.stroke();
    }
    // A slip seen as it begins: a ring, until it is known what it was.
    if (falling && falling.time >= from && falling.time > (slips.at(-1)?.peak_time ?? -Infinity) + 1 / rate) {
      ctx.beginPath();
      ctx.arc(u.valToPos(falling.time, "x", true), u.valToPos(falling.peak, "y", true), 1.5 * size, 0, 2 * Math.PI);
      ctx.strokeStyle = colour("--mark");
      ctx.stroke();
    }
    ctx.save();
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.strokeStyle = ctx.fillStyle = colour("--accent");
    ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textBaseline = "bottom";
    for (const [name, level] of Object.entries(levels ?? {})) {
      if (level == null) continue;
      const y = u.valToPos(level, "y", true);
      ctx.beginPath();
      ctx.moveTo(u.bbox.left, y); ctx.lineTo(u.bbox.left + u.bbox.width, y);
      ctx.stroke();
      ctx.fillText(name, u.bbox.left + 2 * devicePixelRatio, y);
    }
    ctx.restore();
    ctx.strokeStyle = colour("--spike");
    for (const spike of spikes) {
      if (spike.time < from) continue;
      const x = u.valToPos(spike.time, "x", true), y = u.valToPos(spike.value, "y", true);
      ctx.beginPath();
      ctx.moveTo(x - size, y - size); ctx.lineTo(x + size, y + size); ctx.moveTo(x + size, y - size); ctx.lineTo(x - size, y + size);
      ctx.stroke();
    }
    ctx.restore();
  }

  // What stands under the cursor; empty: it is elsewhere.
  const at = (id, u, text) => { const k = u.cursor.idx; document.getElementById(id).textContent = k == null || u.cursor.left < 0 || u.data[0][k] == null ? "" : text(k); };
  const number = (value, decimals) => (value == null ? "–" : value.toFixed(decimals));
  const range = (low, high) => (low === high ? number(low, 4) : `${number(low, 4)} … ${number(high, 4)}`);
  const options = (box, part, series, more) => ({width: box.clientWidth || 600, height: height(part), legend: {show: false}, cursor: {y: false, drag: {x: false, y: false}, points: {show: false}},
    scales: {x: {time: false, range: xRange}}, axes: axes(), series: [{}, ...series], ...more});
  const force = new uPlot(options(forceBox, kForceHeight, [{stroke: paint("--force"), width: kLine, points: {show: false}},
    {stroke: paint("--force"), width: kLine, points: {show: false}}], {bands: [{series: [2, 1], fill: paint("--band")}], hooks: {drawClear: [shade], draw: [marks], setCursor: [u => at("force-at", u, k => `${data.time[k].toFixed(2)} s: ${range(data.lowest[k], data.highest[k])} · `)]}}), [[], [], []], forceBox);
  const slope = new uPlot(options(slopeBox, kForceHeight, [{stroke: paint("--force"), width: kLine, points: {show: false}}], {hooks: {setCursor: [u => at("slope-at", u, k => `${data.time[k].toFixed(2)} s: ${number(data.slope[k], 2)} 1/s`)]}}), [[], []], slopeBox);
  const strip = new uPlot({...options(deltaBox, kHeight, [{stroke: paint("--delta"), width: 0, points: {show: true, size: 6, fill: paint("--delta")}},
    {stroke: paint("--amplitude"), width: 0, points: {show: true, size: 5, fill: paint("--amplitude")}}], {hooks: {setCursor: [u => at("delta-at", u, k => `cycle ${cycles.number[k]}: S − K ${number(cycles.delta[k], 4)}, amplitude ${number(cycles.amplitude[k], 4)}`)]}}),
    scales: {x: {time: false}, y: {range: (u, low, high) => [0, Math.max(0.01, high * 1.1 || 0)]}}}, [[], [], []], deltaBox);

  function draw() {
    requestAnimationFrame(draw);
    if (!dirty || paused != null) return;
    dirty = false;
    // Where each part is one scan, lowest and highest are one line.
    if (force.series[2].show !== step > 1) force.setSeries(2, {show: step > 1});
    force.setData([data.time, data.lowest, data.highest]);
    slope.setData([data.time, data.slope]);
    if (!newCycles) return;
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
    const old = data.time.findIndex(t => t >= latest() - window_s() - 1);
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
    if (slips.length > 500) slips.shift();
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
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colours.clear();
    for (const chart of [force, slope, strip]) chart.redraw(false);
  });

  /// \param own  {S, K}, or null.
  function level(own) {
    if (own?.S === levels?.S && own?.K === levels?.K) return;
    levels = own;
    dirty = true;
  }
  document.getElementById("pause").addEventListener("click", event => {
    paused = paused == null ? latest() : null;
    event.target.setAttribute("aria-pressed", String(paused != null));
    event.target.textContent = paused == null ? "Pause" : "Go on";
    dirty = true;
  });

  return {level, levels: () => levels, scans, began, fall, cycle, ended, clear, data, slips, spikes, cycles, force};
})();

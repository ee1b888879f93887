// What all charts of the live page share: colours, axes, and how slips, peaks and levels are drawn over the force.
"use strict";

const Chart = (() => {
  // One pixel of the screen: without a graphics card wider lines are drawn much more slowly.
  const kLine = 1 / devicePixelRatio;
  // Asked for at each drawing, read once: again where the reader's liking for dark or light changes.
  const colours = new Map();
  const colour = name => {
    if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
    return colours.get(name);
  };
  const paint = name => () => colour(name);
  const drawn = [];
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colours.clear();
    for (const chart of drawn) chart.redraw(false);
  });

  const axis = size => ({stroke: paint("--soft"), grid: {stroke: paint("--line")}, ticks: {stroke: paint("--line")}, size});
  const line = (name, more) => ({stroke: paint(name), width: kLine, points: {show: false}, ...more});
  /// A chart without legend. \param xRange  the part of x in view, asked at each drawing. \param more  options of uPlot in the place of these.
  function make(box, height, series, xRange, more) {
    const u = new uPlot({width: box.clientWidth || 600, height, legend: {show: false}, cursor: {y: false, drag: {x: false, y: false}, points: {show: false}},
      scales: {x: {time: false, range: xRange}}, axes: [axis(28), axis(58)], series: [{}, ...series], ...more}, [[], ...series.map(() => [])], box);
    drawn.push(u);
    return u;
  }
  const bands = (one, other) => ({series: [other, one], fill: paint("--band")});

  /// Shades slips, and sticks between them. \param slips  [{test, onset, capture, peak_time, peak, captured}], times in those of the chart.
  function shade(u, slips) {
    const {min: from, max: to} = u.scales.x, ctx = u.ctx;
    ctx.save();
    let before = null, slides = null, test = null;  // Where one test's last slip ends, no stick of the next begins.
    for (const slip of slips) {
      const onset = slip.onset ?? slip.peak_time;  // The peak is near it.
      if ((slip.capture ?? onset) >= from - 1 && (before ?? slides ?? onset) <= to) {
        const x = t => u.valToPos(Math.min(Math.max(t, from), to), "x", true);
        const fill = (name, begin, end) => { ctx.fillStyle = colour(name); ctx.fillRect(x(begin), u.bbox.top, x(end) - x(begin), u.bbox.height); };
        if (before != null && slip.test === test && onset > before) fill("--stick", before, onset);
        // A slip that slides on lasts until the next begins.
        if (slip.capture != null) fill("--slip", onset, slip.capture);
        else if (slides != null && slip.test === test) fill("--slip", slides, onset);
      }
      before = slip.capture;
      slides = slip.capture == null && !slip.captured ? onset : null;
      test = slip.test;
    }
    ctx.restore();
  }

  /// Marks peaks: a disc where the sled sticks again, a ring where it slides on.
  function peaks(u, slips) {
    const {min: from, max: to} = u.scales.x, ctx = u.ctx;
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.fillStyle = colour("--mark");
    ctx.strokeStyle = colour("--free");
    for (const slip of slips) {
      if (slip.peak_time < from || slip.peak_time > to || slip.peak < u.scales.y.min || slip.peak > u.scales.y.max) continue;
      ctx.beginPath();
      ctx.arc(u.valToPos(slip.peak_time, "x", true), u.valToPos(slip.peak, "y", true), 4 * devicePixelRatio, 0, 2 * Math.PI);
      if (slip.captured) ctx.fill(); else ctx.stroke();
    }
    ctx.restore();
  }

  /// Draws levels as dashed lines with their names. \param levels  [[name, value or null, colour, where its name stands: "left" unless "right"], …].
  function lines(u, levels) {
    const ctx = u.ctx;
    ctx.save();
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textBaseline = "bottom";
    for (const [name, level, of, side] of levels) {
      if (level == null || level < u.scales.y.min || level > u.scales.y.max) continue;
      ctx.strokeStyle = ctx.fillStyle = colour(of);
      const y = Math.round(u.valToPos(level, "y", true)) + ctx.lineWidth % 2 / 2;  // On whole pixels: else it is pale.
      ctx.beginPath();
      ctx.moveTo(u.bbox.left, y); ctx.lineTo(u.bbox.left + u.bbox.width, y);
      ctx.stroke();
      ctx.textAlign = side ?? "left";
      ctx.fillText(name, u.bbox.left + (side === "right" ? u.bbox.width - 2 * devicePixelRatio : 2 * devicePixelRatio), y);
    }
    ctx.restore();
  }

  /// Writes what stands under the cursor; nothing if it is elsewhere. \param text  index → text.
  function tell(id, u, text) {
    const k = u.cursor.idx;
    document.getElementById(id).textContent = k == null || u.cursor.left < 0 || u.data[0][k] == null ? "" : text(k);
  }
  const number = (value, decimals) => (value == null ? "–" : value.toFixed(decimals));
  const range = (low, high) => (low === high ? number(low, 4) : `${number(low, 4)} … ${number(high, 4)}`);
  const height = part => Math.round(Math.max(90, window.innerHeight * part));

  return {colour, paint, axis, line, make, bands, shade, peaks, lines, tell, number, range, height};
})();

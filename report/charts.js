// Charts of the report page, drawn by uPlot: coefficient against speed, and the trace viewer.
"use strict";

const Charts = (() => {
  const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  let paper = null;  // Width of a chart while it is printed, in pixels; null: that of its box.
  const width = box => paper ?? Math.max(280, box.clientWidth);
  const clean = number => (number == null ? "–" : String(Number(number.toPrecision(5))));

  const axis = (label, more) => ({
    label, stroke: colour("--soft"), grid: {stroke: colour("--line"), width: 1}, ticks: {stroke: colour("--line")},
    font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", ...more,
  });

  // ---- Fig. 1: coefficient against speed -------------------------------------------------------------
  // series: [{label, colour, dash, points: [{x, mean, low, high, values}]}]
  function againstSpeed(box, series, unit) {
    const xs = [...new Set(series.flatMap(s => s.points.map(p => p.x)))].sort((a, b) => a - b);
    const data = [xs, ...series.map(s => xs.map(x => (s.points.find(p => p.x === x) || {mean: null}).mean))];
    const all = series.flatMap(s => s.points.flatMap(p => [p.low ?? p.mean, p.high ?? p.mean, ...p.values]));
    const room = 0.06 * (Math.max(...all) - Math.min(...all)) || 0.01;
    const bars = u => {
      const pixel = devicePixelRatio;
      series.forEach((s, at) => {
        const drawn = u.series[at + 1];
        if (!drawn.show) return;
        // Beside each other, so that no interval hides another.
        const shift = (at - (series.length - 1) / 2) * 5 * pixel;
        u.ctx.save();
        u.ctx.strokeStyle = u.ctx.fillStyle = colour(s.colour);
        for (const p of s.points) {
          const x = u.valToPos(p.x, "x", true);
          if (p.low != null) {
            const [low, high] = [p.low, p.high].map(y => u.valToPos(y, "y", true));
            u.ctx.lineWidth = 1.5 * pixel;
            u.ctx.beginPath();
            u.ctx.moveTo(x + shift, low); u.ctx.lineTo(x + shift, high);
            for (const y of [low, high]) { u.ctx.moveTo(x + shift - 4 * pixel, y); u.ctx.lineTo(x + shift + 4 * pixel, y); }
            u.ctx.stroke();
          }
          u.ctx.globalAlpha = 0.75;  // Lighter than a mean, and yet at 3:1 on the ground.
          for (const value of p.values) {
            u.ctx.beginPath();
            u.ctx.arc(x + shift + 9 * pixel, u.valToPos(value, "y", true), 2 * pixel, 0, 2 * Math.PI);
            u.ctx.fill();
          }
          u.ctx.globalAlpha = 1;
        }
        u.ctx.restore();
      });
    };
    const span = xs[xs.length - 1] - xs[0] || xs[0] || 1;
    return new uPlot({
      width: width(box), height: 360, cursor: {drag: {x: false, y: false}},
      scales: {x: {time: false, range: [xs[0] - 0.12 * span, xs[xs.length - 1] + 0.12 * span]},
               y: {range: [Math.min(...all) - room, Math.max(...all) + room]}},
      axes: [axis(`pull speed (${unit})`), axis("coefficient of friction", {size: 62})],
      series: [{label: "speed", value: (u, v) => (v == null ? "–" : `${clean(v)} ${unit}`)},
               ...series.map(s => ({label: s.label, stroke: colour(s.colour), width: 2, dash: s.dash,
                                    points: {show: true, size: 8, fill: colour(s.colour)},
                                    value: (u, v) => (v == null ? "–" : v.toFixed(4))}))],
      hooks: {draw: [bars]},
    }, data, box);
  }

  // ---- A record: force with its cycles, and its derivative ------------------------------------------
  function shade(u, modes) {
    const {left, top, width: wide, height} = u.bbox;
    u.ctx.save();
    u.ctx.beginPath(); u.ctx.rect(left, top, wide, height); u.ctx.clip();
    for (const [from, to, mode] of modes) {
      if (to < u.scales.x.min || from > u.scales.x.max) continue;
      const [a, b] = [from, to].map(t => u.valToPos(t, "x", true));
      u.ctx.fillStyle = colour(mode === "stick" ? "--stick" : "--slip");
      u.ctx.fillRect(a, top, b - a, height);
    }
    u.ctx.restore();
  }

  function marks(u, cycles, drawn) {
    u.ctx.save();
    u.ctx.beginPath(); u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height); u.ctx.clip();
    u.ctx.lineWidth = 1.5 * devicePixelRatio;
    let count = 0;
    cycles.time.forEach((time, i) => {
      if (time < u.scales.x.min || time > u.scales.x.max) return;
      u.ctx.strokeStyle = u.ctx.fillStyle = colour(cycles.captured[i] ? "--mark" : "--free");
      u.ctx.beginPath();
      u.ctx.arc(u.valToPos(time, "x", true), u.valToPos(cycles.peak[i], "y", true), 3 * devicePixelRatio, 0, 2 * Math.PI);
      if (cycles.captured[i]) u.ctx.fill(); else u.ctx.stroke();
      ++count;
    });
    u.ctx.restore();
    drawn(count);
  }

  function line(u, value, name) {
    const y = Math.round(u.valToPos(value, "y", true));
    u.ctx.save();
    u.ctx.strokeStyle = u.ctx.fillStyle = colour(name);
    u.ctx.lineWidth = devicePixelRatio;
    u.ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    u.ctx.beginPath(); u.ctx.moveTo(u.bbox.left, y); u.ctx.lineTo(u.bbox.left + u.bbox.width, y); u.ctx.stroke();
    u.ctx.restore();
  }

  // drawn(count): how many cycles are marked in the part in view.
  function traces(box, trace, stroke, drawn) {
    const end = Math.max(trace.force.time[trace.force.time.length - 1] || 0, 1e-9);
    const charts = [];
    let moving = false;
    const follow = (u, key) => {
      if (key !== "x" || moving) return;
      moving = true;
      const {min, max} = u.scales.x;
      for (const other of charts) if (other !== u) other.setScale("x", {min, max});
      moving = false;
    };
    const chart = (height, label, part, digits, hooks, x) => new uPlot({
      width: width(box), height, cursor: {sync: {key: "trace" + trace.key, scales: ["x", null]}, drag: {x: true, y: false},
                                          points: {size: 6}},
      scales: {x: {time: false, range: (u, min, max) => [Math.max(0, min), Math.min(end, max)]}},
      axes: [axis(x, x ? {} : {size: 24}), axis(label, {size: 70})],
      series: [{label: "time", value: (u, v) => (v == null ? "–" : v.toFixed(4) + " s")},
               {label, stroke: colour(stroke), width: 1.25, spanGaps: false, points: {show: u => {
                 const {min, max} = u.scales.x;
                 return (max - min) * trace.rate < u.bbox.width / devicePixelRatio / 6;
               }, size: 4}, value: (u, v) => (v == null ? "–" : v.toFixed(digits))}],
      hooks: {drawClear: [u => shade(u, trace.modes)], setScale: [follow], ...hooks},
    }, [part.time, part.value], box);
    charts.push(chart(330, "force / weight", trace.force, 4, {draw: [u => {
      if (trace.transition != null) {
        const x = u.valToPos(trace.transition, "x", true);
        u.ctx.save(); u.ctx.strokeStyle = colour("--soft"); u.ctx.setLineDash([3, 3]);
        u.ctx.beginPath(); u.ctx.moveTo(x, u.bbox.top); u.ctx.lineTo(x, u.bbox.top + u.bbox.height); u.ctx.stroke();
        u.ctx.restore();
      }
      marks(u, trace.cycles, drawn);
    }]}, undefined));
    const slope = trace.slope.unit === "mm/s" ? "stretching (mm/s)" : "rate of force / weight (1/s)";
    charts.push(chart(240, slope, trace.slope, 3, {draw: [u => {
      if (trace.slope.limit != null) line(u, trace.slope.limit, "--limit");
    }]}, trace.second ? undefined : "time (s)"));
    if (trace.second) {
      const name = trace.second.name === "pull_speed" ? "pull speed" : "sled position";
      charts.push(chart(200, `${name} (${trace.second.unit})`, trace.second, 3, {}, "time (s)"));
    }

    const view = (from, to) => {
      const shortest = Math.min(end, 4 / trace.rate);
      const length = Math.min(end, Math.max(shortest, to - from));
      const start = Math.min(Math.max(0, from), end - length);
      charts[0].setScale("x", {min: start, max: start + length});
    };
    const inView = () => [charts[0].scales.x.min, charts[0].scales.x.max];
    return {
      charts, view, inView, whole: () => view(0, end),
      zoom: factor => { const [a, b] = inView(); const half = (b - a) * factor / 2; view((a + b) / 2 - half, (a + b) / 2 + half); },
      move: part => { const [a, b] = inView(); view(a + part * (b - a), b + part * (b - a)); },
      resize: () => charts.forEach(u => u.setSize({width: width(box), height: u.height})),
      destroy: () => charts.forEach(u => u.destroy()),
    };
  }

  return {againstSpeed, traces, width, onPaper(width_px) { paper = width_px; }};
})();

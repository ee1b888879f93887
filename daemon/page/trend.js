// Control charts of the tester as small multiples: the arms of each CUSUM against the test, where an alarm begins, and the state.
"use strict";

const Trend = (() => {
  const kHeight = 130, kRoom = 1.6;  // Height of a chart, px; its y goes so many decision intervals to each side.
  const titles = {reference: "reference paper", omega: "ω", damping: "γ/2ω", zero: "zero", noise: "noise", spikes: "spikes per scan", rate: "scan rate error"};
  const states = {off: ["ring", "--idle"], learning: ["diamond", "--armed"], "in control": ["circle", "--running"], alarm: ["cross", "--degraded"]};
  const box = document.getElementById("trend"), list = document.getElementById("trend-charts"), message = document.getElementById("trend-message");
  const drawn = new Map();  // Name of a chart → {u, chart}: uPlot's, and what it shows.
  let ask = null;
  let known = null;  // What the status said of the charts when they were asked for.
  let limit = 0;     // The decision interval, in standard deviations.

  const title = chart => `${titles[chart.chart] ?? chart.chart}${chart.unit === "1" ? "" : `, ${chart.unit}`}`;
  const number = value => (value == null ? "–" : String(Number(value.toPrecision(4))));
  const size = value => number(value == null ? null : Math.abs(value));
  function told(chart) {
    const values = `${chart.test_count} test${chart.test_count === 1 ? "" : "s"}, mean ${number(chart.mean)}, standard deviation ${number(chart.standard_deviation)}, latest ${number(chart.latest)}`;
    if (chart.alarm) return `${chart.alarm.rises ? "rose" : "fell"} by ${size(chart.alarm.shift)} with the test of ${Tables.minute(chart.alarm.since)}; ${values}`;
    return chart.test_count === 0 ? chart.reason ?? "no test yet" : values;
  }

  function element(kind, of, id) {
    const made = document.createElement(kind);
    if (of) made.className = of;
    if (id) made.id = id;
    return made;
  }
  /// A chart without data.
  function build(name) {
    const id = `trend-${name}`, figure = element("figure", "", `${id}-figure`), caption = element("figcaption"), heading = element("strong", "", `${id}-title`), state = element("span", "state", id);
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    svg.setAttribute("viewBox", "0 0 20 20");
    svg.setAttribute("aria-hidden", "true");
    path.id = `${id}-shape`;
    svg.append(path);
    state.append(svg, element("span", "", `${id}-word`));
    caption.append(heading, state);
    const place = element("div", "chart", `${id}-chart`);
    place.setAttribute("role", "img");
    figure.append(caption, place, element("p", "note at", `${id}-at`), element("p", "note", `${id}-told`));
    list.append(figure);
    const one = {chart: null, u: null};
    one.u = Chart.make(place, kHeight, [Chart.line("--force"), Chart.line("--delta")], null, {
      scales: {x: {time: false, range: (u, low, high) => (low == null ? [0, 1] : [low, Math.max(low + 1, high)])}, y: {range: () => [-kRoom * limit, kRoom * limit]}},
      axes: [Chart.axis(28), {...Chart.axis(34), splits: () => [-limit, 0, limit]}],
      hooks: {draw: [u => Chart.lines(u, [["alarm", limit, "--degraded"], ["", -limit, "--degraded"]])],
        setCursor: [u => Chart.tell(`${id}-at`, u, k => {
          const {points, unit} = one.chart;
          return `test ${u.data[0][k]}, ${Tables.minute(points.time[k])}: ${number(points.value[k])}${unit === "1" ? "" : ` ${unit}`}, arms ${points.upper[k].toFixed(1)} and ${points.lower[k].toFixed(1)}`;
        })]}});
    return one;
  }
  function show(trend) {
    limit = trend.decision_interval;
    for (const chart of trend.charts) {
      const id = `trend-${chart.chart}`, part = what => document.getElementById(`${id}-${what}`);
      if (!drawn.has(chart.chart)) drawn.set(chart.chart, build(chart.chart));
      const one = drawn.get(chart.chart), {upper, lower} = chart.points, first = chart.test_count - upper.length + 1;
      one.chart = chart;
      part("title").textContent = title(chart);
      Tables.badge(id, chart.verdict, ...(states[chart.verdict] ?? states.off));
      part("told").textContent = told(chart);
      part("chart").setAttribute("aria-label", `${title(chart)}: ${chart.verdict}; ${told(chart)}; its CUSUM is at ${chart.upper.toFixed(1)} up and ${chart.lower.toFixed(1)} down, an alarm above ${limit}`);
      one.u.setData([upper.map((_, k) => first + k), upper, lower.map(height => -height)]);
    }
  }

  function fit() {
    if (!box.open) return;  // A closed one has no width.
    for (const [name, {u}] of drawn) u.setSize({width: document.getElementById(`trend-${name}-chart`).clientWidth, height: kHeight});
  }

  let loads = 0;  // An answer counts until the next is asked for.
  async function load() {
    const own = ++loads;
    message.textContent = "";
    try {
      const trend = await ask("GET", "/v1/trend");
      if (own === loads) show(trend);
    } catch (error) {
      if (own !== loads) return;
      message.textContent = error.message;
      known = null;  // Once more with the next status.
    }
  }
  function summary(charts) {
    const of = verdict => charts.filter(chart => chart.verdict === verdict).map(chart => titles[chart.chart] ?? chart.chart);
    if (charts.length === 0) return "the history is being read";
    const count = verdict => (of(verdict).length > 0 ? [`${of(verdict).length} ${verdict}`] : []);
    return [of("alarm").length > 0 ? `alarm: ${of("alarm").join(", ")}` : "no alarm", ...count("in control"), ...count("learning"), ...count("off")].join("; ");
  }

  let latest = null;  // Of the status.
  function follow() {
    if (!box.open || latest == null) return;
    const now = JSON.stringify(latest);
    if (now === known) return;
    known = now;
    load();
  }
  box.addEventListener("toggle", () => {
    fit();
    follow();
  });
  window.addEventListener("resize", fit);

  return {
    /// \param asking  (method, path) → JSON.
    connect(asking) { ask = asking; },
    health(status) {
      latest = status.trend;
      const said = summary(latest.charts), place = document.getElementById("trend-said");
      if (place.textContent !== said) place.textContent = said;
      follow();
    },
    shown: () => drawn,
  };
})();

// Words, shapes and numbers of the live page. Texts go through textContent alone.
"use strict";

const Tables = (() => {
  const columns = [["mu_s", "S", 4], ["mu_k", "K", 4], ["delta_mu", "S − K", 4], ["static_coefficient", "static", 4],
    ["kinetic_coefficient", "kinetic", 4], ["amplitude", "amplitude", 4], ["oscillation_frequency", "Hz", 3], ["cycle_count", "cycles", 0]];
  const kRepeatability = 2.8;  // ISO 5725-6: r = 2.8 s_r
  const fixed = (value, decimals) => (value == null ? "–" : value.toFixed(decimals));
  const cell = (text, kind) => { const td = document.createElement(kind === "th" ? "th" : "td"); td.textContent = text; if (kind === "text") td.className = "text"; return td; };
  const row = cells => { const tr = document.createElement("tr"); tr.append(...cells); return tr; };

  // A word, a shape and a colour: any one of them tells.
  const shapes = {circle: "M10 2a8 8 0 1 0 .01 0z", ring: "M10 2a8 8 0 1 0 .01 0zM10 6a4 4 0 1 1-.01 0z", triangle: "M10 2 19 18H1z", square: "M2 2h16v16H2z",
    bars: "M3 2h5v16H3zM12 2h5v16h-5z", cross: "M4 1l6 6 6-6 3 3-6 6 6 6-3 3-6-6-6 6-3-3 6-6-6-6z", diamond: "M10 1l9 9-9 9-9-9z", wave: "M1 12 6 3l5 12 4-8 4 6v5l-4-5-5 8L6 8l-5 9z"};
  const benches = {idle: "ring", armed: "triangle", loading: "bars", running: "circle", finishing: "square", degraded: "cross"};
  const regimes = {"stick-slip": ["wave", "--running"], "ring-down": ["diamond", "--armed"], mixed: ["triangle", "--finishing"], "steady-sliding": ["bars", "--loading"]};
  function badge(id, word, shape, colour) {
    document.getElementById(`${id}-word`).textContent = word;
    document.getElementById(`${id}-shape`).setAttribute("d", shapes[shape]);
    document.getElementById(id).style.color = `var(${colour})`;
  }
  const bench = state => badge("bench", state, benches[state] || "cross", `--${benches[state] ? state : "degraded"}`);
  const regime = name => { const [shape, colour] = regimes[name] || ["ring", "--idle"]; badge("regime", name, shape, colour); };

  function tests(list) {
    const table = document.getElementById("tests");
    const head = ["test", "regime", ...columns.map(c => c[1]), "ended", "record"].map((text, k) => {
      const th = cell(text, "th"); th.scope = "col"; if (k === 1 || k > columns.length + 1) th.className = "text"; return th; });
    table.tHead.replaceChildren(row(head));
    table.tBodies[0].replaceChildren(...list.slice(-200).reverse().map(test => row([cell(String(test.number)), cell(test.results.regime, "text"),
      ...columns.map(([name, , digits]) => cell(fixed(test.results[name], digits))), cell(test.cause, "text"),
      cell(test.file ? test.file.split("/").pop() : test.file_error || "…", "text")])));
    const summary = (label, of) => row([cell(label), cell("", "text"), ...columns.map(([name, , digits]) => {
      const values = list.map(test => test.results[name]).filter(value => value != null);
      return cell(name === "cycle_count" ? "" : of(values, digits));
    }), cell("", "text"), cell("", "text")]);
    const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length;
    const scatter = values => Math.sqrt(values.reduce((sum, value) => sum + (value - mean(values)) ** 2, 0) / (values.length - 1));
    table.tFoot.replaceChildren(...(list.length < 2 ? [] : [
      summary("mean", (values, digits) => (values.length ? fixed(mean(values), digits) : "–")),
      summary("r = 2.8 s", (values, digits) => (values.length > 1 ? fixed(kRepeatability * scatter(values), digits) : "–")),
      summary("lowest", (values, digits) => (values.length ? fixed(Math.min(...values), digits) : "–")),
      summary("highest", (values, digits) => (values.length ? fixed(Math.max(...values), digits) : "–"))]));
  }

  function health(status) {
    const latency = status.read_latency;
    const facts = [["daemon", status.state], ["board", status.board ? status.board.name || status.board.driver : "–"],
      ["rate", status.board ? `${Number(status.board.scan_rate_granted.toPrecision(7))} Hz` : "–"],
      ["measured", status.scan_rate_measured ? `${status.scan_rate_measured.value.toFixed(4)} Hz` : "–"],
      ["scans", String(status.scan_count)], ["gaps", `${status.gap_count} (${status.lost_scan_count} scans)`],
      ["disk", status.storage.why != null ? `${status.storage.why}; ${status.storage.to_do}` : status.storage.room_h == null ? "–" : `${status.storage.room_h.toFixed(0)} h`],
      ["worst read", `${(1000 * latency.largest).toFixed(2)} ms`], ["tests", String(status.test_count)],
      ["readers", `${status.live_clients.count}, ${status.live_clients.dropped_frame_count} dropped`]];
    document.getElementById("health").replaceChildren(...facts.flatMap(([name, value]) => {
      const dt = document.createElement("dt"), dd = document.createElement("dd");
      dt.textContent = name; dd.textContent = value;
      return [dt, dd];
    }));
  }

  function cycle(frame) {
    document.getElementById("cycle").textContent = `cycle ${frame.number}: peak ${fixed(frame.peak, 4)}, S − K ${fixed(frame.delta_mu, 4)}`;
  }

  return {bench, regime, tests, health, cycle, columns};
})();

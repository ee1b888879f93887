// Words, shapes and numbers of the live page. Texts go through textContent alone.
"use strict";

const Tables = (() => {
  const columns = [["delta_mu", "S − K", 4], ["mu_s", "S", 4], ["mu_k", "K", 4], ["static_coefficient", "static", 4],
    ["kinetic_coefficient", "kinetic", 4], ["amplitude", "amplitude", 4], ["oscillation_frequency", "Hz", 3], ["cycle_count", "cycles", 0]];
  const withErrors = new Set(["delta_mu", "mu_s", "mu_k", "static_coefficient", "kinetic_coefficient"]);
  const fixed = (value, decimals) => (value == null ? "–" : value.toFixed(decimals));
  /// \param text  or several children of the cell.
  const cell = (text, kind) => { const td = document.createElement(kind === "th" ? "th" : "td"); td.append(...(Array.isArray(text) ? text : [text])); if (kind && kind !== "th") td.className = kind; return td; };
  const row = cells => { const tr = document.createElement("tr"); tr.append(...cells); return tr; };

  const terms = facts => facts.flatMap(([name, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name; dd.textContent = value;
    return [dt, dd];
  });

  const speed = value => `${Number((value * 1000).toPrecision(6))} mm/s`;

  /// By the clock of this browser.
  function minute(time) {
    if (!time) return "no date";
    const at = new Date(time), two = number => String(number).padStart(2, "0");
    return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${two(at.getHours())}:${two(at.getMinutes())}`;
  }

  // A word, a shape and a colour: any one of them tells.
  const shapes = {circle: "M10 2a8 8 0 1 0 .01 0z", ring: "M10 2a8 8 0 1 0 .01 0zM10 6a4 4 0 1 1-.01 0z", triangle: "M10 2 19 18H1z", square: "M2 2h16v16H2z",
    bars: "M3 2h5v16H3zM12 2h5v16h-5z", cross: "M4 1l6 6 6-6 3 3-6 6 6 6-3 3-6-6-6 6-3-3 6-6-6-6z", diamond: "M10 1l9 9-9 9-9-9z", lozenge: "M10 1l9 9-9 9-9-9zM10 6l-4 4 4 4 4-4z", wave: "M1 12 6 3l5 12 4-8 4 6v5l-4-5-5 8L6 8l-5 9z"};
  const benches = {idle: "ring", armed: "triangle", loading: "bars", running: "circle", finishing: "square", degraded: "cross"};
  const regimes = {"stick-slip": ["wave", "--running"], "ring-down": ["diamond", "--armed"], "inertial-oscillation": ["lozenge", "--armed"], mixed: ["triangle", "--finishing"], "steady-sliding": ["bars", "--loading"]};
  function badge(id, word, shape, colour) {
    document.getElementById(`${id}-word`).textContent = word;
    document.getElementById(`${id}-shape`).setAttribute("d", shapes[shape]);
    document.getElementById(id).style.color = `var(${colour})`;
  }
  const bench = state => badge("bench", state, benches[state] || "cross", `--${benches[state] ? state : "degraded"}`);
  const regime = name => { const [shape, colour] = regimes[name] || ["ring", "--idle"]; badge("regime", name, shape, colour); };

  // A link for the keyboard and the eye; what it does needs the token, which an address must not carry.
  function recordCell(test, download) {
    if (!test.file) return cell(test.file_error || "…", "text");
    return cell([recordLink(`record-${test.number}`, base(test.file), download)], "text");
  }
  const base = path => path.split("/").pop();
  const recordPath = record => `/v1/records/${record.split("/").map(encodeURIComponent).join("/")}`;
  function recordLink(id, record, download) {
    const link = document.createElement("a");
    link.textContent = base(record);
    link.id = id;
    link.href = recordPath(record);
    link.addEventListener("click", event => { event.preventDefault(); download(link.pathname, base(record)); });
    return link;
  }
  // By a click anywhere in the row but on what does something else, and by keyboard on its number.
  /// \param of  as Trace.open(). \param text  of the first cell, which becomes a button.
  function traced(of, text, tr) {
    const button = document.createElement("button");
    button.type = "button"; button.className = "link"; button.id = `trace-${of}`; button.textContent = text;
    button.setAttribute("aria-label", `trace of ${Trace.named(of)}`);
    button.setAttribute("aria-haspopup", "dialog");
    button.addEventListener("click", () => Trace.open(of));
    tr.cells[0].replaceChildren(button);
    tr.addEventListener("click", event => { if (event.target.closest("button, a, input") == null && getSelection().isCollapsed) Trace.open(of); });
  }
  const limitText = ({lowest, highest}, digits) => (lowest == null ? `≤ ${fixed(highest, digits)}` : highest == null ? `≥ ${fixed(lowest, digits)}` : `${fixed(lowest, digits)} … ${fixed(highest, digits)}`);

  /// Two fields for each result of the table: `mu_s.lowest`, `mu_s.highest`. \param withUnit  the result that is typed as text with its unit; absent: none.
  const ranges = withUnit => columns.map(([name, label]) => {
    const box = document.createElement("fieldset"), legend = document.createElement("legend");
    legend.textContent = label;
    box.append(legend, ...["lowest", "highest"].map(side => {
      const said = document.createElement("label"), field = document.createElement("input");
      said.textContent = name === withUnit ? `${side}, with unit` : side;
      if (name === withUnit) field.placeholder = "1 Hz"; else field.type = "number";
      field.step = "any";
      field.name = `${name}.${side}`;
      said.append(field);
      return said;
    }));
    return box;
  });

  const severities = ["fault", "warning", "note"];
  /// Of the latest test, below its answer; the most severe first.
  function findings(test) {
    const list = document.getElementById("findings"), rank = finding => severities.indexOf(finding.severity);
    const items = [...(test?.results.coded_findings ?? [])].sort((a, b) => rank(a) - rank(b)).map(finding => {
      const item = document.createElement("li"), strong = document.createElement("strong"), action = document.createElement("span");
      item.className = finding.severity;
      strong.textContent = `test ${test.number}, ${finding.severity}: ${finding.text}`;
      action.textContent = ` → ${finding.action} (${finding.code})`;
      item.append(strong, action);
      return item;
    });
    list.replaceChildren(...items);
    list.hidden = items.length === 0;
  }

  let lacking = false;
  let again = () => {};  // Writes the table once more, of the same tests.
  document.getElementById("only").addEventListener("change", () => again());
  /// Numbers of the foot are the daemon's (GET /v1/tests), as stickslip report computes them.
  /// \param made  how many tests of the batch count, by its journal: of those of before the daemon began the table learns by and by.
  /// \param voidCell  (id, body, what, voided) → a cell with the button of a test.
  /// \param placeOf  test → its place in the batch, or undefined.
  function tests(list, summary, made, download, voidCell, placeOf) {
    again = () => tests(list, summary, made, download, voidCell, placeOf);
    const leads = summary.batch != null, only = document.getElementById("only");
    document.getElementById("only-field").hidden = !leads;
    const places = leads ? [["sample", place => place.name], ["grade", place => place.grade ?? "–"], ["speed", place => (place.pull_speed == null ? "–" : speed(place.pull_speed))], ["replicate", place => String(place.replicate)]] : [];
    const kept = (leads && only.checked ? list.filter(placeOf) : list).slice(-200);
    const table = document.getElementById("tests");
    const head = ["test", ...places.map(([label]) => label), "regime", ...columns.map(c => c[1]), "ended", "", "record"].map((text, k) => {
      const th = cell(text, "th"); th.scope = "col"; if ((k > 0 && k <= places.length + 1) || k > places.length + columns.length + 1) th.className = "text"; return th; });
    const of = new Map(summary.quantities.map(quantity => [quantity.name, quantity]));
    const limits = new Map(summary.limits.map(limit => [limit.quantity, limit]));
    const errorsOf = (test, name) => (withErrors.has(name) ? test.results.uncertainties?.[name] : undefined);
    const value = (test, [name, , digits]) => {
      const missed = limits.get(name)?.outside.includes(test.number), far = of.get(name)?.outlier_test === test.number;
      const marks = `${missed ? " ✗" : ""}${far ? " !" : ""}`, own = test.results[name];
      return cell(Uncertain.lines(own, errorsOf(test, name), digits, marks), missed ? "outside" : far ? "far" : undefined);
    };
    findings(list.at(-1));
    const focused = document.activeElement?.id;
    table.tBodies[0].replaceChildren(...kept.reverse().map(test => {
      const place = leads ? placeOf(test) : undefined, regimeCell = cell(test.results.regime, "text");
      const tr = row([cell(String(test.number)), ...places.map(([, told]) => cell(place ? told(place) : "–", "text")), regimeCell, ...columns.map(column => value(test, column)),
        cell(test.voided ? `void: ${test.voided.reason}` : test.cause, "text plain"),
        test.file ? voidCell(`void-${test.number}`, {test: test.number}, `test ${test.number}`, test.voided) : cell(""), recordCell(test, download)]);
      for (const plain of [...tr.cells].slice(-2)) plain.classList.add("plain");
      const found = test.results.coded_findings;
      if (found.length > 0) regimeCell.append(` · ${found[0].code}${found.length > 1 ? ` + ${found.length - 1}` : ""}`);
      regimeCell.title = [`rung: ${test.results.rung}`, ...found.map(finding => finding.text)].join("\n");
      traced(test.number, String(test.number), tr);
      if (test.voided) tr.classList.add("void");
      if (place) tr.classList.add("own");
      return tr;
    }));
    const foot = (label, pick) => row([cell(label), ...places.map(() => cell("")), cell("", "text"), ...columns.map(([name, , digits]) => cell(of.has(name) ? pick(of.get(name), digits, name) : "")), cell("", "text"), cell(""), cell("", "text")]);
    const number = key => (quantity, digits) => fixed(quantity[key], digits);
    const pooled = summary.delta_mu_by_cycle;
    const byCycle = (quantity, digits, name) => (name !== "delta_mu" || pooled.value == null ? "" : Uncertain.lines(pooled.value, pooled, digits));
    const known = summary.tests.length;
    // Its n where that is another than the number of tests.
    const mean = (quantity, digits) => { const text = number("mean")(quantity, digits), few = document.createElement("span"); few.className = "errors"; few.textContent = `n = ${quantity.count}`; return quantity.count === known ? text : [`${text} `, few]; };
    const top = known < 2 ? [] : [foot(`mean, n = ${known}`, mean)];
    const rows = known < 2 ? [] : [foot("by cycle", byCycle), foot("r = 2.8 s", number("repeatability")), foot("95 % from", number("mean_low")),
      foot("95 % to", number("mean_high")), foot("lowest", number("lowest")), foot("highest", number("highest"))];
    if (summary.limits.length > 0 && summary.tests.length > 0) {
      const verdict = limit => `${limitText(limit, 4)} ${limit.passes ? "✓ kept" : "✗ missed"}`;
      top.push(row([cell("limits"), ...places.map(() => cell("")), cell("", "text"), ...columns.map(([name]) => cell(limits.has(name) ? verdict(limits.get(name)) : "", limits.get(name)?.passes === false ? "outside" : undefined)), cell("", "text"), cell(""), cell("", "text")]));
    }
    table.tHead.replaceChildren(row(head), ...top);
    table.tFoot.replaceChildren(...rows);
    if (/^(void|record|trace)-\d+$/.test(focused ?? "")) document.getElementById(focused)?.focus();
    const far = summary.quantities.some(quantity => quantity.outlier_test != null);
    lacking = known < made;
    const ofBatch = lacking ? `${known} of the ${made} tests made of batch ${summary.batch}: the records of the others have not been read` :
      `batch ${summary.batch}`;
    document.getElementById("errors").textContent = Uncertain.legend([[pooled.value, pooled],
      ...kept.flatMap(test => [...withErrors].map(name => [test.results[name], errorsOf(test, name)]))]);
    document.getElementById("counted").textContent = [leads ? `● mean and limits of ${ofBatch}` : "",
      far ? "! stands out (Grubbs' test, 5 %) and counts all the same" : ""].filter(text => text !== "").join(" · ");
  }

  const day = date => date.slice(0, 10);
  function loadCell(calibration) {
    if (calibration.under_way_by != null) return `${calibration.under_way_by} calibrates it`;
    if (calibration.date == null) return "as configured";
    const of = `calibrated ${day(calibration.date)}`;
    if (calibration.expires == null) return of;
    return calibration.expired ? `${of}, EXPIRED on ${day(calibration.expires)}` : `${of}, until ${day(calibration.expires)}`;
  }

  /// What somebody has to do something about, as long as it lasts; empty: nothing.
  function troubles(status) {
    const found = [];
    if (["board missing", "board busy", "no permission"].includes(status.state)) found.push(status.detail);
    if (status.bench_trouble != null) found.push(`bench ${status.bench}: ${status.bench_trouble}`);
    if (status.storage.why != null) found.push(`storage ${status.storage.state}: ${status.storage.why}; ${status.storage.to_do}`);
    if (status.trend.trouble != null) found.push(`history of the tester: ${status.trend.trouble}`);
    found.push(...status.coded_findings.map(finding => `${finding.text}; ${finding.action}`));
    return found.join(" · ");
  }
  function trouble(text) {
    const box = document.getElementById("trouble");
    if (box.textContent === text) return;  // Told once, not each second.
    box.textContent = text;
    box.hidden = text === "";
  }

  function health(status) {
    trouble(troubles(status));
    const latency = status.read_latency;
    const facts = [["daemon", status.state], ["board", status.board ? status.board.name || status.board.driver : "–"],
      ["rate", status.board ? `${Number(status.board.scan_rate_granted.toPrecision(7))} Hz` : "–"],
      ["measured", status.scan_rate_measured ? `${status.scan_rate_measured.value.toFixed(4)} Hz` : "–"],
      ["load cell", loadCell(status.calibration)], ["scans", String(status.scan_count)], ["gaps", `${status.gap_count} (${status.lost_scan_count} scans)`],
      ["disk", status.storage.why != null ? `${status.storage.why}; ${status.storage.to_do}` : status.storage.room_h == null ? "–" : `${status.storage.room_h.toFixed(0)} h`],
      ["worst read", `${(1000 * latency.largest).toFixed(2)} ms`], ["worst commit", `${(1000 * status.commit_time.largest).toFixed(1)} ms`],
      ["ring", status.ring ? `${(100 * status.ring.high_water_block_count / status.ring.capacity_block_count).toFixed(1)} % at most` : "–"], ["tests", String(status.test_count)],
      ["facts of the next test", Object.entries(status.next_facts).map(fact => fact.join(" ")).join(", ") || "–"],
      ["readers", `${status.live_clients.count}, ${status.live_clients.dropped_frame_count} dropped`]];
    document.getElementById("health").replaceChildren(...terms(facts));
    sled = status.coded_findings.find(finding => finding.code === "sled-mass")?.text ?? null;
  }

  function cycle(frame) {
    document.getElementById("cycle").textContent = `cycle ${frame.number}: peak ${fixed(frame.peak, 4)}, S − K ${fixed(frame.delta_mu, 4)}`;
  }

  /// Asks before something is done that is rarely meant. \param facts  [name, value] each. \return true: do it.
  function confirm(title, text, facts, yes) {
    const part = id => document.getElementById(`confirm-${id}`), box = part("dialog");
    part("title").textContent = title;
    part("text").textContent = text;
    part("yes").textContent = yes;
    part("facts").replaceChildren(...terms(facts));
    box.returnValue = "";
    box.showModal();
    part("no").focus();
    return new Promise(done => box.addEventListener("close", () => done(box.returnValue === "yes"), {once: true}));
  }
  for (const answer of ["no", "yes"]) document.getElementById(`confirm-${answer}`).addEventListener("click", () => document.getElementById("confirm-dialog").close(answer));
  let sled = null;
  /// Asks where the sled of the bench is outside what a tester has.
  const sledMeant = async doing => sled == null || confirm("Is this the sled?", `${sled}. Every coefficient is divided by its weight. Correct sled_mass under [tester] in the configuration, or go on.`, [], doing);

  return {confirm, sledMeant, terms, cell, row, speed, minute, base, recordPath, recordLink, traced, ranges, badge, bench, regime, trouble, tests, lacks: () => lacking, health, cycle, columns};
})();

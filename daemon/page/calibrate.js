// The calibration of the load cell, step by step: what the daemon says of it is all that is shown.
"use strict";

const Calibrate = (() => {
  const kFewest = 3;  // Different weights up, readings down: the daemon says so too, in words.
  const part = id => document.getElementById(`calibrate-${id}`);
  const dialog = part("dialog");
  let ask = null, bench = "", told = null;
  let doing = null;  // What an answer is waited for; null: nothing.

  const withUnit = (value, unit) => (value == null ? "–" : `${value} ${unit}`);
  const precise = (value, digits) => (value == null ? null : Number(value).toPrecision(digits));
  const plusMinus = (value, digits, error, unit) => `${precise(value, digits)}${error == null ? "" : ` ± ${precise(error, 2)}`} ${unit}`;
  const day = date => (date == null ? null : date.slice(0, 10));
  const show = (id, visible) => { part(id).hidden = !visible; };
  const say = (said, good) => { part("message").textContent = said; part("message").className = good ? "message good" : "message"; };

  function inUse(used) {
    const since = used.date == null ? "as the configuration says" : `of ${day(used.date)}, ${used.expires == null ? "valid for ever" : used.expired ? `EXPIRED on ${day(used.expires)}` : `valid until ${day(used.expires)}`}`;
    return `In use: gain ${plusMinus(used.gain, 8, used.gain_standard_error, "N/V")}, zero ${plusMinus(used.zero, 6, used.zero_standard_error, "V")}, ${since}`;
  }

  // Of the weights that count, as the daemon counts them.
  function course(points) {
    const masses = points.filter(point => point.refused === "").map(point => point.mass);
    const up = new Set(), heaviest = Math.max(0, ...masses);
    let down = 0;
    masses.forEach((mass, k) => {
      if (k > 0 && mass > masses[k - 1]) up.add(mass);
      if (k > 0 && mass < masses[k - 1]) ++down;
    });
    return {up: up.size, down, heaviest};
  }
  const readingOf = (mass, tare) => `Reading ${tare ? "the tare" : Number.isFinite(mass) ? `${mass} kg` : mass}: leave it alone …`;
  function instruction(weighing) {
    if (weighing == null) return "Step 1 of 4: the bench has to be idle. Turn the cell so that weights can hang on it, then begin.";
    if (weighing.mass_being_read != null) return readingOf(weighing.mass_being_read, weighing.points.length === 0);
    if (weighing.points.length === 0) return "Step 2 of 4: take everything off the load cell, hook and pan stay; then read the tare.";
    const {up, down, heaviest} = course(weighing.points);
    if (up < kFewest) return `Step 3 of 4, up: hang a weight heavier than ${heaviest} kg, let it come to rest, type its mass, read it (${up} of at least ${kFewest}).`;
    if (down < kFewest) return `Step 3 of 4, down: the same weights again, each lighter, to 0 for nothing (${down} of at least ${kFewest}); or go on up.`;
    return "Step 4 of 4: more weights if you like; then save.";
  }

  const cell = (text, kind) => { const td = document.createElement("td"); td.textContent = text; if (kind) td.className = kind; return td; };
  function rows(points) {
    return points.map((point, k) => {
      const tr = document.createElement("tr");
      tr.append(cell(k === 0 ? "tare" : String(k)), cell(`${point.mass} kg`), cell(`${precise(point.force, 6)} N`), cell(plusMinus(point.voltage, 8, point.standard_error, "V")),
        cell(point.residual == null ? "–" : `${(1000 * point.residual).toFixed(3)} mV`), cell(point.refused === "" ? "✓ counts" : `✗ ${point.refused}`, point.refused === "" ? "text" : "text refused"));
      return tr;
    });
  }
  function answer(weighing) {
    const parts = [["gain", plusMinus(weighing.gain, 8, weighing.gain_standard_error, "N/V")], ["zero", plusMinus(weighing.zero, 6, weighing.zero_standard_error, "V")],
      ["off the line", withUnit(precise(1000 * weighing.residual, 3), "mV")], ["hysteresis", withUnit(precise(1000 * weighing.hysteresis, 3), "mV")]];
    return Tables.terms(parts);
  }

  function render() {
    const weighing = told.weighing, reading = doing != null || (weighing != null && weighing.mass_being_read != null);
    part("in-use").textContent = inUse(told.in_use);
    part("step").textContent = doing ?? instruction(weighing);
    show("begin", weighing == null);
    show("weigh", weighing != null);
    show("mass-field", weighing != null && weighing.points.length > 0);
    show("save", weighing != null && weighing.missing == null);
    show("disarm", weighing == null && bench === "armed");
    show("points", weighing != null && weighing.points.length > 0);
    show("give-up", weighing != null);
    part("read").textContent = weighing != null && weighing.points.length === 0 ? "Read the tare" : "Read";
    part("rows").replaceChildren(...(weighing == null ? [] : rows(weighing.points)));
    part("fit").replaceChildren(...(weighing == null || weighing.missing != null ? [] : answer(weighing)));
    part("missing").textContent = weighing == null || weighing.points.length === 0 ? "" : weighing.missing ?? "";
    part("findings").textContent = weighing == null ? "" : weighing.findings.map(finding => `Look: ${finding}.`).join(" ");
    for (const button of dialog.querySelectorAll("button")) button.disabled = reading && !["calibrate-close", "calibrate-give-up"].includes(button.id);
    part("undo").disabled = reading || weighing == null || weighing.points.length === 0;
    dialog.setAttribute("aria-busy", String(reading));
  }
  const take = json => { told = json; render(); };

  // One step at a time; a refusal is told and changes nothing.
  async function act(what, method, path, body, done) {
    doing = what;
    say("");
    if (told) render();
    try {
      const json = await ask(method, `/v1/calibration${path}`, body);
      doing = null;
      if (json.in_use) take(json);
      done?.(json);
    } catch (error) {
      doing = null;
      say(error.message);
      await refresh();
    }
  }
  async function refresh() {
    if (!dialog.open || doing != null) return;
    try { take(await ask("GET", "/v1/calibration")); } catch (error) { say(error.message); }
  }
  const kUnits_kg = {kg: 1, g: 1e-3, mg: 1e-6, lb: 0.45359237};
  /// What the daemon will read, before it is sent; that decides.
  function understood() {
    const text = part("mass").value.trim(), [, number, unit] = /^(-?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(.*)$/.exec(text) ?? [];
    const kg = Number(number) * (Number(number) === 0 && unit === "" ? 1 : kUnits_kg[unit] ?? NaN);
    // The gravity of this tester, by a weight that was read before.
    const known = told?.weighing?.points.find(point => point.mass > 0), g = known ? known.force / known.mass : 9.80665;
    part("understood").textContent = text === "" ? "" : Number.isFinite(kg) ? `${text} = ${kg.toFixed(4)} kg = ${(kg * g).toPrecision(4)} N` :
      number != null && unit === "" ? `${text}: a mass needs its unit, such as "${number} g" or "${number} kg"` : `${text}: write a number and kg, g, mg or lb`;
  }
  part("mass").addEventListener("input", understood);

  part("begin").addEventListener("submit", event => {
    event.preventDefault();
    act("Beginning …", "POST", "", {settle: part("settle").value, reading: part("reading").value}, () => part("read").focus());
  });
  part("disarm").addEventListener("click", async () => {
    try { bench = (await ask("POST", "/v1/stop", {})).bench; say("the bench is idle; arm it again after the calibration", true); } catch (error) { say(error.message); }
    render();
    part("start").focus();
  });
  part("weigh").addEventListener("submit", event => {
    event.preventDefault();
    const tare = told.weighing.points.length === 0, mass = tare ? 0 : part("mass").value;
    act(readingOf(mass, tare), "POST", "/weight", {mass}, json => {
      const last = json.weighing.points[json.weighing.points.length - 1];
      say(last.refused === "" ? `${last.mass} kg reads ${precise(last.voltage, 8)} V` : `does not count: ${last.refused}`, last.refused === "");
      part("mass").value = "";
      understood();
      part("mass").focus();
    });
  });
  part("undo").addEventListener("click", () => act("Forgetting the latest …", "POST", "/undo", undefined, () => (part("mass-field").hidden ? part("read") : part("mass")).focus()));
  part("give-up").addEventListener("click", () => act("Giving up …", "DELETE", "", undefined, () => { say("given up; nothing was kept", true); part("start").focus(); }));
  part("save").addEventListener("submit", async event => {
    event.preventDefault();
    const change = told.weighing.gain_change;
    if (change != null && !await Tables.confirm("The gain has changed", `Look: ${change.text}.`, [["gain in use", `${precise(change.gain_in_use, 8)} N/V`],
      ["gain by these weights", `${precise(change.gain, 8)} N/V`], ["ratio", precise(change.ratio, 4)]], "Save the new gain")) return;
    act("Saving …", "POST", "/finish", {certificate: part("certificate").value, valid_days: Number(part("days").value), confirm: change != null}, json => {
      say(`kept in ${json.file} and in use from here on; turn the cell back, tare, and arm the bench`, true);
      part("close").focus();
    });
  });
  part("close").addEventListener("click", () => dialog.close());
  part("open").addEventListener("click", async () => {
    dialog.showModal();
    say("");
    await refresh();
    (dialog.querySelector("form:not([hidden]) input:not([hidden])") ?? part("close")).focus();
  });

  return {
    connect(asking) { ask = asking; },
    health(status) { bench = status.bench; refresh(); },
  };
})();

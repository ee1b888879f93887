// The band at the top: what the bench does, what its operator does next, and the answer of the running or last test.
"use strict";

const Answer = (() => {
  const kDigits = 4;
  const part = id => document.getElementById(id);
  let state = "not connected", calibrates = null;
  let running = null;  // {number, regime, deltas, step} of the test that runs; step: as its begin told, until the batch tells it.
  let ended = null;    // The latest test of the stream: {number, results}.
  let latest = null;   // The latest test of the table, which knows more: its record, whether it is void.
  let summary = null, batch = null;

  const same = (a, b) => a != null && b != null && a.pull_speed === b.pull_speed && a.replicate === b.replicate && a.slide === b.slide;
  const stepText = step => `${step.pull_speed == null ? "" : `${Tables.speed(step.pull_speed)}, `}sheet ${step.replicate}, slide ${step.slide}`;
  const onTheWay = number => batch?.under_way.find(one => one.test === number);
  const last = () => (ended != null && ended.number > (latest?.number ?? 0) ? ended : latest);
  const complete = () => batch != null && batch.next == null && batch.done === batch.planned;

  function now() {
    if (state === "not connected") return "the daemon does not answer";
    if (state === "degraded") return "no scans come from the board";
    if (calibrates != null) return `${calibrates} calibrates the load cell`;
    if (state === "loading" || state === "running") {
      const step = running && (onTheWay(running.number) ?? running.step);
      return `${running ? `test ${running.number}` : "a test"}${step ? `, ${stepText(step)}` : ""}: ${state === "loading" ? "loading, no slip yet" : "measuring"}`;
    }
    if (state === "finishing") return `${last() ? `test ${last().number}` : "the test"} is over, its force is still there`;
    if (complete()) return `the batch is finished, all ${batch.planned} test${batch.planned === 1 ? " is" : "s are"} made`;
    return state === "armed" ? "waiting for a pull" : "no test is armed";
  }

  /// What comes after the running test, with a word before it; empty: it is not known, or nothing.
  function then() {
    if (batch == null) return "";
    // The batch of before this test began: its next one is the test that runs.
    if (running && !onTheWay(running.number) && same(batch.next, running.step)) return "";
    if (batch.next) return `, then ${stepText(batch.next)}`;
    if (running && !onTheWay(running.number) && running.step == null) return "; the batch is finished, it is none of its tests";
    return batch.done + batch.under_way.length >= batch.planned ? "; it is the last of the batch" : "";
  }
  function next() {
    if (state === "not connected") return "start the daemon; this page comes back by itself";
    if (state === "degraded") return part("trouble").hidden ? "wait for the board" : "do what the red band says";
    if (calibrates != null) return "end the calibration";
    if (state === "loading" || state === "running") return `let it pull to its end${then()}`;
    if (state === "finishing") return `let the carriage go back${complete() ? "; the batch is finished" : batch?.next ? then() : ""}`;
    if (complete()) return "show the report, or end the batch";
    const writing = batch != null && batch.next == null ? batch.under_way.at(-1) : undefined;
    if (writing) return `wait, the record of test ${writing.test} is being written`;
    const step = batch?.next, lay = step && step.slide > 1 ? "leave the sheet on" : "lay on the sheet";
    return `${step ? `${stepText(step)}: ` : ""}${lay}${state === "armed" ? " and pull" : ", then Arm or Start"}`;
  }

  // As the daemon judged it, which it does once the record is there.
  function verdict(test) {
    if (test.voided) return [`void: ${test.voided.reason}`, "ring", "--idle"];
    if (summary == null || summary.limits.length === 0) return null;
    if (!summary.tests.includes(test.number)) return onTheWay(test.number) ? ["limits not judged yet", "ring", "--idle"] : null;
    const labels = key => summary.limits.filter(limit => limit[key].includes(test.number)).map(limit => Tables.columns.find(([name]) => name === limit.quantity)?.[1] ?? limit.quantity).join(", ");
    const outside = labels("outside"), absent = labels("absent");
    if (outside !== "") return [`outside limits: ${outside}`, "cross", "--degraded"];
    return absent !== "" ? [`not measured: ${absent}`, "cross", "--degraded"] : ["within limits", "circle", "--running"];
  }
  const values = results => [["mu_s", "S"], ["mu_k", "K"], ["static_coefficient", "static"], ["kinetic_coefficient", "kinetic"]]
    .map(([name, label]) => `${label} ${Uncertain.text(results[name], results.uncertainties?.[name], kDigits)}`).join(" · ");
  function show(title, value, errors, regime, judged, more) {
    part("answer-test").textContent = title;
    part("answer-value").textContent = value;
    part("answer-errors").textContent = errors;
    part("answer-more").textContent = more;
    Tables.regime(regime);
    part("verdict").hidden = judged == null;
    if (judged != null) Tables.badge("verdict", ...judged);
  }
  function answer() {
    if (running) {
      const known = running.deltas.filter(delta => delta != null), mean = known.reduce((sum, delta) => sum + delta, 0) / known.length;
      // The daemon's live regime is that of the moment: what slides on after a slip that was not caught is a ring-down that has died away.
      const regime = running.regime === "steady-sliding" ? "ring-down" : running.regime;
      show(`Test ${running.number}, preliminary:`, known.length === 0 ? "–" : mean.toFixed(kDigits), known.length === 0 ? "no cycle yet" : `mean of ${known.length} cycle${known.length === 1 ? "" : "s"}`,
        regime ?? "–", null, "The answer, with its errors, comes when the test has ended.");
      return;
    }
    const test = last();
    if (test == null) return show("No test yet:", "–", "", "–", null, "");
    const own = Uncertain.parts(test.results.delta_mu, test.results.uncertainties?.delta_mu, kDigits);
    show(`Test ${test.number}:`, [own.value, ...own.errors.slice(0, 1)].join(" "), own.errors.slice(1).join(" "), test.results.regime, verdict(test), values(test.results));
  }
  const set = (id, text) => { if (part(id).textContent !== text) part(id).textContent = text; };  // Told once, not with each frame.
  function write() {
    set("now", `Now: ${now()}`);
    set("next", `Next: ${next()}`);
    answer();
  }
  const test = number => { if (running?.number !== number) running = {number, regime: null, deltas: [], step: null}; };

  return {
    bench(name) { state = name; Tables.bench(name); write(); },
    health(status) {
      const cycle = status.live?.latest_cycle;
      if (cycle) Scope.level({S: cycle.mu_s, K: cycle.mu_k});
      calibrates = status.calibration.under_way_by; this.bench(status.bench);
    },
    /// \param told  the current batch as GET /v1/batch says it, or null.
    batch(told) { batch = told; write(); },
    /// \param list, told  of GET /v1/tests.
    tests(list, told) { latest = list.at(-1) ?? null; summary = told; write(); },
    began(frame) { test(frame.test); running.step = batch?.next; write(); },
    scans(frame) {
      if (frame.test == null || (running?.number === frame.test && running.regime === frame.regime)) return;
      test(frame.test);
      running.regime = frame.regime;
      write();
    },
    cycle(frame) { test(frame.test); running.deltas.push(frame.delta_mu); write(); },
    ended(frame) { running = null; ended = {number: frame.test, results: frame.results}; Scope.level({S: frame.results.mu_s, K: frame.results.mu_k}); write(); },
    /// A stream begins, perhaps of a daemon that numbers its tests from 1 again.
    clear() { running = ended = null; write(); },
    stepText,
  };
})();

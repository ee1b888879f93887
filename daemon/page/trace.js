// The whole trace of one finished test with its cycles, S and K; a span of it at full resolution; over it others of its batch or a reference.
"use strict";

const Trace = (() => {
  const kZoom = 2, kMove = 0.25;  // Of one key: how much shorter the span is; how far it moves, in spans.
  const kRetry = 300;  // ms, while the daemon reads another trace.
  const kBreak = 2;  // To uPlot.join(): where scans are missing the line breaks, whatever other tests have there.
  const kOver = 10;  // Tests laid over it at once: with more no line can be followed, and each is read by a process of its own.
  const kOthers = "others", kReference = "reference";  // A choice of "compare with"; where the tab keeps the file of the reference.
  const part = id => document.getElementById(`trace-${id}`), dialog = part("dialog"), box = part("chart"), other = part("other");
  let ask = null;
  let number = null;   // Of the test that is shown, or the name of the record.
  let shown = [];      // [{number, trace, slips}] of it and of those that are laid over it, as the chart has them.
  let view = null;     // [from, to] in view, s; null: the whole trace.
  let recorded = [];   // Every test with a record that counts.
  let listed = [];     // Those that can be laid over it, the latest first.
  let inBatch = null;  // test → whether it is of the batch that is shown; null: there is none.
  let offered = [];    // Numbers of the others of its batch, when it was opened.
  let reference = null;  // The test that lies over each one opened.
  let chart = null;

  /// By its file: numbers begin anew with the daemon.
  function refer() {
    reference = recorded.find(one => one.file === sessionStorage.getItem(kReference)) ?? null;
    part("reference").checked = reference != null && reference.number === number;
    part("reference").disabled = opened() == null;  // It has no trace.
  }
  // A test by its number, or any record by its name from the record folder on.
  const isTest = of => typeof of === "number";
  const named = of => (isTest(of) ? `test ${of}` : Tables.base(of));
  const opened = () => recorded.find(one => one.number === number);
  const others = () => listed.filter(one => one.number !== number);
  /// Numbers of the tests that were chosen to lie over it.
  const over = () => (other.value === "" ? [] : other.value === kOthers ? offered : [Number(other.value)]);
  // Its column of lowest values in the chart; the one of highest follows. What is drawn last lies on top: the test itself.
  const low = at => 1 + 2 * (kOver - at);
  // The time of the first counts.
  const whole = () => [0, Math.max(shown[0]?.trace.end ?? 0, 1e-3)];
  const inView = () => view ?? (shown.length > 0 ? whole() : [0, 1]);
  const slips = trace => trace.cycles.peak_time.map((time, k) => ({test: 0, onset: trace.cycles.onset_time[k], capture: trace.cycles.capture_time[k],
    peak_time: time, peak: trace.cycles.peak[k], captured: trace.cycles.captured[k]}));
  // Of more than two tests the first's alone: names of many would lie on one another.
  const levels = () => (shown.length > 2 ? shown.slice(0, 1) : shown).flatMap(({number: of, trace}, at) => {
    const name = letter => (shown.length > 1 ? `${letter}, ${named(of)}` : letter), [s, k, side] = at === 0 ? ["--static", "--kinetic", "left"] : ["--other", "--other", "right"];
    return [[name("S"), trace.mu_s, s, side], [name("K"), trace.mu_k, k, side]];
  });
  // Each at its own nearest bin: tests of other lengths have other bins.
  const under = u => shown.slice(0, shown.length > 2 ? 1 : 2).map(({number: of}, at) => {
    const k = u.cursor.idxs[low(at)];
    return `${shown.length > 1 ? `${named(of)} ` : ""}${k == null ? "–" : Chart.range(u.data[low(at)][k], u.data[low(at) + 1][k])}`;
  }).join(", ");

  function build() {
    const pair = name => Array.from({length: 2}, () => Chart.line(name, {spanGaps: false})), pairs = Array.from({length: 1 + kOver}, (_, k) => pair(k === kOver ? "--force" : "--other"));
    chart = Chart.make(box, Chart.height(0.45), pairs.flat(), inView, {
      cursor: {y: false, drag: {x: true, y: false, setScale: false}, points: {show: false}},
      bands: pairs.map((_, at) => ({...Chart.bands(low(at), low(at) + 1), ...(at === 0 ? {} : {fill: Chart.paint("--other-band")})})),
      hooks: {drawClear: [u => shown.length === 1 && Chart.shade(u, shown[0].slips)],
        draw: [u => { if (shown.length > 0) Chart.peaks(u, shown[0].slips); Chart.lines(u, levels()); }],
        setCursor: [u => Chart.tell("trace-at", u, k => `${u.data[0][k].toFixed(4)} s: ${under(u)} · `)],
        setSelect: [u => {
          const {left, width} = u.select;
          if (width < 3) return;
          u.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
          look(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
        }]}});
  }

  function draw() {
    if (chart == null) build();
    const empty = [[0], [null], [null]], tables = chart.bands.map((_, at) => (shown[at] == null ? empty : [shown[at].trace.time, shown[at].trace.lowest, shown[at].trace.highest]));
    const [times, ...values] = uPlot.join([...tables].reverse(), tables.map(() => [0, kBreak, kBreak]));
    // Where each bin is one scan, lowest and highest are one line.
    tables.forEach((_, at) => chart.setSeries(low(at) + 1, {show: shown[at] != null && shown[at].trace.scans_in_bin > 1}));
    chart.setData([times, ...values]);
    const first = shown[0];
    part("span").textContent = first == null ? "" : view == null ? "the whole trace" : `${view[0].toFixed(3)} s to ${view[1].toFixed(3)} s`;
    part("bins").textContent = first == null ? "" : `, ${first.trace.scans_in_bin === 1 ? "each scan" : `lowest and highest of ${first.trace.scans_in_bin} scans each`}` +
      (first.trace.left_out_cycles > 0 ? `; its ${first.trace.left_out_cycles} cycles are marked in a shorter span` : "");
    // A disabled button loses the focus, and with it the keys.
    if (view == null && document.activeElement === part("whole")) part("in").focus();
    part("whole").disabled = view == null;
  }

  async function read(of) {
    const margin = shown[0] ? 1 / shown[0].trace.rate : 0;  // The line goes on to the edge.
    const span = view == null ? "" : `&from=${Math.max(0, view[0] - margin).toFixed(6)}&to=${(view[1] + margin).toFixed(6)}`;
    for (;;) {
      try {
        return await ask("GET", `${isTest(of) ? `/v1/tests/${of}` : Tables.recordPath(of)}/trace?points=${Math.max(200, box.clientWidth)}${span}`);
      } catch (error) {
        if (error.status !== 503 || !dialog.open) throw error;
        part("message").textContent = error.message;
        await new Promise(done => setTimeout(done, kRetry));
      }
    }
  }
  // One at a time, and once more if something else was wanted meanwhile.
  let loading = false, again = false;
  async function load() {
    again = true;
    if (loading) return;
    loading = true;
    dialog.setAttribute("aria-busy", "true");
    try {
      while (again && dialog.open) {
        again = false;
        const wanted = [number, ...over()], read_traces = [], refused = [];
        part("message").textContent = "";
        for (const of of wanted) {
          if (again || !dialog.open) break;  // Something else is wanted.
          try {
            const trace = await read(of);
            read_traces.push({number: of, trace, slips: slips(trace)});
          } catch (error) {
            // Another test may be shorter than the span.
            if (of === number || view == null) refused.push(error.message);
            if (of === number) break;
          }
        }
        if (!again) part("message").textContent = refused.join("; ");
        if (!again && dialog.open) { shown = read_traces; draw(); }
      }
    } finally {
      loading = false;
      dialog.setAttribute("aria-busy", "false");
    }
  }

  /// Shows a span; one longer than the trace is the whole.
  function look(from, to) {
    if (shown.length === 0) return;
    const [, end] = whole(), shortest = Math.min(end, 4 / shown[0].trace.rate);
    const length = Math.max(shortest, to - from), start = Math.min(Math.max(0, from), Math.max(0, end - length));
    view = length >= end ? null : [start, start + length];
    draw();  // What is there, at once.
    load();
  }
  const zoom = factor => { const [from, to] = inView(), middle = (from + to) / 2, half = (to - from) / factor / 2; look(middle - half, middle + half); };
  const move = by => { const [from, to] = inView(), step = by * (to - from); look(from + step, to + step); };
  const back = () => { view = null; load(); };

  function open(of) {
    number = of;
    view = null;
    shown = [];
    part("title").textContent = `Trace of ${named(of)}`;
    const choice = one => [one.number, `${one === reference ? "reference: " : ""}test ${one.number}, ${one.results.regime}`];
    const first = reference == null || reference.number === of ? [] : [reference], rest = others().filter(one => one !== reference);
    const own = opened(), mates = own != null && inBatch?.(own) ? others().filter(inBatch) : [];
    offered = mates.slice(0, kOver).map(one => one.number);
    const batch = mates.length === 0 ? [] : [[kOthers, mates.length > kOver ? `the latest ${kOver} others of its batch` : "all others of its batch"]];
    other.replaceChildren(...[["", "no other test"], ...first.map(choice), ...batch, ...rest.map(choice)].map(([value, text]) => {
      const option = document.createElement("option");
      option.value = value; option.textContent = text;
      return option;
    }));
    other.value = first.length > 0 ? String(reference.number) : "";
    refer();
    dialog.showModal();
    part("close").focus();
    draw();
    chart.setSize({width: box.clientWidth, height: Chart.height(0.45)});
    load();
  }

  const buttons = {in: () => zoom(kZoom), out: () => zoom(1 / kZoom), left: () => move(-kMove), right: () => move(kMove), whole: back, close: () => dialog.close()};
  for (const [name, act] of Object.entries(buttons)) part(name).addEventListener("click", act);
  other.addEventListener("change", load);
  part("reference").addEventListener("change", event => {
    if (event.target.checked) sessionStorage.setItem(kReference, opened().file);
    else sessionStorage.removeItem(kReference);
    refer();
  });
  const keys = {"+": buttons.in, "=": buttons.in, "-": buttons.out, ArrowLeft: buttons.left, ArrowRight: buttons.right};
  dialog.addEventListener("keydown", event => {
    const act = event.key === "Escape" ? (view == null ? null : back) : event.target === other ? null : keys[event.key];
    if (act == null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
  // The table may have been written anew meanwhile, with what opened it.
  dialog.addEventListener("close", () => document.getElementById(`trace-${number}`)?.focus());
  window.addEventListener("resize", () => { if (chart && dialog.open) chart.setSize({width: box.clientWidth, height: Chart.height(0.45)}); });

  return {
    connect(asking) { ask = asking; },
    /// \param list  all tests, oldest first. \param ofBatch  as inBatch.
    tests(list, ofBatch) {
      recorded = list.filter(test => test.file && !test.voided);
      inBatch = ofBatch;
      listed = (inBatch == null ? recorded : recorded.filter(inBatch)).slice(-100).reverse();
      refer();
    },
    /// \param of  as named().
    open,
    named,
    levels,
    shown: () => ({number, view: inView(), tests: shown, chart}),
  };
})();

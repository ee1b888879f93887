// The whole trace of one finished test with its cycles, S and K; a span of it at full resolution; a second test laid over it.
"use strict";

const Trace = (() => {
  const kZoom = 2, kMove = 0.25;  // Of one key: how much shorter the span is; how far it moves, in spans.
  const kRetry = 300;  // ms, while the daemon reads another trace.
  const part = id => document.getElementById(`trace-${id}`), dialog = part("dialog"), box = part("chart"), other = part("other");
  let ask = null;
  let number = null;   // Of the test that is shown.
  let shown = [];      // [{number, trace}] of it and of the one that is laid over it, as the chart has them.
  let view = null;     // [from, to] in view, s; null: the whole trace.
  let listed = [];     // Tests that can be laid over it, the latest first.
  let chart = null;

  // The second is laid over the first, whose time counts.
  const whole = () => [0, Math.max(shown[0]?.trace.end ?? 0, 1e-3)];
  const inView = () => view ?? (shown.length > 0 ? whole() : [0, 1]);
  const slips = trace => trace.cycles.peak_time.map((time, k) => ({test: 0, onset: trace.cycles.onset_time[k], capture: trace.cycles.capture_time[k],
    peak_time: time, peak: trace.cycles.peak[k], captured: trace.cycles.captured[k]}));
  const levels = () => shown.flatMap(({number: of, trace}, at) => {
    const name = letter => (shown.length > 1 ? `${letter}, test ${of}` : letter), [s, k, side] = at === 0 ? ["--static", "--kinetic", "left"] : ["--other", "--other", "right"];
    return [[name("S"), trace.mu_s, s, side], [name("K"), trace.mu_k, k, side]];
  });
  const under = (u, k) => shown.map(({number: of}, at) => `${shown.length > 1 ? `test ${of} ` : ""}${Chart.range(u.data[1 + 2 * at][k], u.data[2 + 2 * at][k])}`).join(", ");

  function build() {
    const line = name => Chart.line(name, {spanGaps: false});
    chart = Chart.make(box, Chart.height(0.45), [line("--force"), line("--force"), line("--other"), line("--other")], inView, {
      cursor: {y: false, drag: {x: true, y: false, setScale: false}, points: {show: false}},
      bands: [Chart.bands(1, 2), {...Chart.bands(3, 4), fill: Chart.paint("--other-band")}],
      hooks: {drawClear: [u => shown.length === 1 && Chart.shade(u, shown[0].slips)],
        draw: [u => { if (shown.length > 0) Chart.peaks(u, shown[0].slips); Chart.lines(u, levels()); }],
        setCursor: [u => Chart.tell("trace-at", u, k => `${u.data[0][k].toFixed(4)} s: ${under(u, k)} · `)],
        setSelect: [u => {
          const {left, width} = u.select;
          if (width < 3) return;
          u.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
          look(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
        }]}});
  }

  function draw() {
    if (chart == null) build();
    const columns = shown.map(({trace}) => [trace.time, trace.lowest, trace.highest]);
    const empty = [[0], [null], [null]];
    const [times, ...values] = uPlot.join([columns[0] ?? empty, columns[1] ?? empty]);
    // Where each bin is one scan, lowest and highest are one line.
    [0, 1].forEach(at => chart.setSeries(2 + 2 * at, {show: shown[at] != null && shown[at].trace.scans_in_bin > 1}));
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
        const trace = await ask("GET", `/v1/tests/${of}/trace?points=${Math.max(200, box.clientWidth)}${span}`);
        part("message").textContent = "";
        return trace;
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
        const wanted = [number, ...(other.value === "" ? [] : [Number(other.value)])], read_traces = [];
        part("message").textContent = "";
        for (const of of wanted) {
          try {
            const trace = await read(of);
            read_traces.push({number: of, trace, slips: slips(trace)});
          } catch (error) {
            // A second test may be shorter than the span.
            if (of === number || view == null) part("message").textContent = error.message;
          }
        }
        if (read_traces[0]?.number !== number) read_traces.length = 0;
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
    part("title").textContent = `Trace of test ${of}`;
    other.replaceChildren(...[["", "no other test"], ...listed.filter(one => one.number !== of).map(one => [one.number, `test ${one.number}, ${one.results.regime}`])].map(([value, text]) => {
      const option = document.createElement("option");
      option.value = value; option.textContent = text;
      return option;
    }));
    dialog.showModal();
    part("close").focus();
    draw();
    chart.setSize({width: box.clientWidth, height: Chart.height(0.45)});
    load();
  }

  const buttons = {in: () => zoom(kZoom), out: () => zoom(1 / kZoom), left: () => move(-kMove), right: () => move(kMove), whole: back, close: () => dialog.close()};
  for (const [name, act] of Object.entries(buttons)) part(name).addEventListener("click", act);
  other.addEventListener("change", load);
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
    /// \param list  tests of which one can be laid over another, oldest first.
    tests(list) { listed = list.filter(test => test.file && !test.voided).slice(-100).reverse(); },
    open,
    levels,
    shown: () => ({number, view: inView(), tests: shown, chart}),
  };
})();

// The report page: reads the JSON in the page, writes tables, places charts. Texts go through textContent alone.
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const two = data.materials.length === 2;
  const sides = ["A", "B"];
  const strokes = ["--a", "--b"];
  const main = document.getElementById("main");
  const kTexts = new Set(["material", "file", "regime", "group"]);  // Columns of words.

  // node("td", {class: "x"}, "text", child, …)
  const node = (tag, attributes, ...children) => {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) {
      if (name.startsWith("on")) made.addEventListener(name.slice(2), value); else made.setAttribute(name, value);
    }
    made.append(...children);
    return made;
  };
  const plural = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;
  const fixed = (value, decimals) => (value == null ? "–" : value.toFixed(decimals));
  const range = (pair, decimals) => (pair == null ? "–" : `${fixed(pair[0], decimals)} … ${fixed(pair[1], decimals)}`);
  const named = (q, model) => q.label + (q.of_model ? model : "") + (q.unit === "1" ? "" : ` (${q.unit})`);
  const title = q => named(q, "");
  const label = q => named(q, " (model)");
  const probability = p => (p == null ? "–" : p < 0.0001 ? "< 0.0001" : p.toFixed(4));
  // Digits follow the uncertainty that stands beside the number.
  const halfOf = pair => (pair == null ? null : 0.5 * (pair[1] - pair[0]));
  const half = own => halfOf(own.confidence_interval);
  const meanDecimals = (own, q) => Uncertain.decimalsFor(half(own) || own.systematic_uncertainty, q.decimals);
  const scatter = (value, q) => fixed(value, Uncertain.decimalsFor(value, q.decimals));
  const meanText = (own, q) => {
    const decimals = meanDecimals(own, q);
    return own.mean == null ? "–" : fixed(own.mean, decimals) + (half(own) == null ? "" : ` ± ${fixed(half(own), decimals)}`);
  };
  const pooledText = own => Uncertain.text(own.value, own, 4);
  const pooledFacts = own => `${plural(own.slips, "slip")} of ${plural(own.tests, "test")}, ${own.escaped} escaped` +
    (own.confidence_interval == null ? "" : `; 95 % ${range(own.confidence_interval, Uncertain.decimalsFor(half(own), 4))}`) + (own.scatter == null ? "" : `; scatter from slip to slip ${fixed(own.scatter, Uncertain.decimalsFor(own.scatter, 4))}`);
  const nameOf = index => (two ? `${sides[index]}: ${data.materials[index].label}` : "");
  const absentCell = reason => node("td", {}, node("span", {class: "absent", title: reason, tabindex: "0"}, "–"));

  function table(id, headings, rows) {
    return node("div", {class: "table"}, node("table", {id},
      node("thead", {}, node("tr", {}, ...headings.map(h => node("th", {scope: "col", ...(kTexts.has(h) ? {class: "text"} : {})}, h)))),
      node("tbody", {}, ...rows)));
  }
  const section = (id, heading, ...children) => {
    const made = node("section", {id, "aria-label": heading}, node("h2", {}, heading), ...children);
    main.append(made);
    return made;
  };
  const row = (...cells) => node("tr", {}, ...cells.map(c => (c instanceof Node ? c : node("td", {}, c))));

  // ---- Fig. 1 ------------------------------------------------------------------------------------------
  function figureSeries() {
    return data.materials.flatMap((material, m) => ["static_coefficient", "kinetic_coefficient"].map((name, kind) => ({
      label: (two ? material.label + " " : "") + (kind ? "kinetic" : "static"),
      colour: two ? strokes[m] : strokes[kind], dash: kind ? [7, 4] : undefined,
      points: material.groups.filter(g => g.pull_speed != null && g.quantities[name].mean != null).map(g => ({
        x: g.pull_speed / data.speed_unit.m_per_s, mean: g.quantities[name].mean,
        low: (g.quantities[name].confidence_interval || [null])[0], high: (g.quantities[name].confidence_interval || [null, null])[1],
        values: g.tests.map(t => material.tests[t][name]).filter(v => v != null),
      })),
    }))).filter(s => s.points.length > 0);
  }

  let figure = null;
  const figureBox = node("div", {class: "chart", id: "figure", role: "img", "aria-label": "coefficient against speed; the table below has its numbers"});
  function drawFigure() {
    if (figure) figure.destroy();
    const series = figureSeries();
    figure = series.length > 0 ? Charts.againstSpeed(figureBox, series, data.speed_unit.symbol) : null;
  }

  // A chart of one speed would be a column of points.
  const speeds = new Set(data.materials.flatMap(material => material.groups.map(g => g.pull_speed)).filter(speed => speed != null).map(speed => speed.toPrecision(2)));
  function writeFigure() {
    if (speeds.size < 2) return;
    section("against-speed", "Coefficient against speed",
      node("p", {class: "note"}, "Means with their 95 % intervals; small dots are single tests (Penner 1995, Fig. 1)."), figureBox);
    drawFigure();
  }

  // "95 % intervals: k = 4.30 for n = 3": Student's t of n − 1 degrees of freedom.
  function coverage() {
    const factors = new Map(data.materials.flatMap(material => material.groups.flatMap(group => Object.values(group.quantities)))
      .filter(own => own.coverage_factor != null).map(own => [own.count, own.coverage_factor]));
    return factors.size === 0 ? "" : "95 % intervals: mean ± k s_r/√n, Student's t, k = " +
      [...factors].sort(([one], [other]) => one - other).map(([n, k]) => `${k.toFixed(2)} for n = ${n}`).join(", ") + ".";
  }

  function writeMeans() {
    const shown = data.quantities.slice(0, 5);
    const rows = data.materials.flatMap((material, m) => material.groups.map(group => ({m, group})));
    rows.sort((x, y) => (x.group.pull_speed ?? Infinity) - (y.group.pull_speed ?? Infinity) || x.m - y.m);
    const split = data.materials.map(material => material.not_pooled).filter(Boolean);
    section("means", "Means",
      table("speeds", ["group", ...(two ? ["material"] : []), "tests", "S−K by cycle", ...shown.map(title)], rows.map(({m, group}) => row(
        node("td", {class: "text"}, group.text), ...(two ? [node("td", {class: "text"}, nameOf(m))] : []), String(group.tests.length),
        group.delta_mu_by_cycle.value == null ? absentCell(group.delta_mu_by_cycle.reason) : pooledText(group.delta_mu_by_cycle),
        ...shown.map(q => {
          const own = group.quantities[q.name];
          return own.mean == null ? absentCell(own.absent.map(a => a.reason)[0] || "") : meanText(own, q);
        })))),
      node("p", {class: "note", id: "means-note"}, "± half of the 95 % interval of the mean; S−K by cycle: " +
        (Uncertain.legend(rows.map(({group}) => [group.delta_mu_by_cycle.value, group.delta_mu_by_cycle])) || "no errors") + ". " + coverage() +
        " S, K, S−K, ω and γ are model quantities, those of the two-parameter model, from which the effect of speed is taken out (Penner 1995). S−K by cycle counts each slip of all tests once, " +
        "also one that escaped; a mean of tests is too low where slips escape." + split.map(text => ` ${text}.`).join("")));
  }

  // ---- The form: what was tested, how, by whom and with what ------------------------------------------
  function writeForm() {
    const made = section("form", "Test");
    data.materials.forEach((material, m) => {
      if (two) made.append(node("h3", {}, nameOf(m)));
      made.append(node("dl", {class: "form", id: `form-${m}`}, ...[...material.form, {name: "verdict", label: "verdict", text: material.verdict}].map(line =>
        node("div", {class: line.name === "verdict" ? "verdict" : "", "data-name": line.name}, node("dt", {}, line.label), node("dd", {}, line.text)))));
    });
  }

  // ---- Comparison --------------------------------------------------------------------------------------
  const byCycle = own => (own.p == null ? row("S−K by cycle", absentCell(own.reason), ...Array(6).fill("")) :
    row("S−K by cycle", fixed(own.difference, Uncertain.decimalsFor(half(own), 4)), range(own.confidence_interval, Uncertain.decimalsFor(half(own), 4)), node("td", own.p < 0.05 ? {class: "differs"} : {}, probability(own.p)),
      ...Array(4).fill("")));
  function writeComparison() {
    const made = section("comparison", "Do they differ?", node("p", {class: "note"},
      "A − B with its 95 % interval; p of Welch's test; g is the difference in units of the scatter of single tests (Hedges). The last two columns: " +
      "tests of each material with which a difference as large would be found 80 or 90 times of 100. Green: differs at 5 %."));
    data.comparison.comparisons.forEach((pair, i) => {
      const reasons = data.quantities.map(q => pair.quantities[q.name].reason);
      made.append(node("h3", {}, pair.pull_speed_text));
      if (reasons[0] && reasons.every(reason => reason === reasons[0])) {
        made.append(node("p", {class: "note", id: `comparison-${i}`}, reasons[0]));
        return;
      }
      made.append(
        table(`comparison-${i}`, ["", "A − B", "95 %", "p", "g", "95 % of g", "tests, 80 %", "tests, 90 %"], [byCycle(pair.delta_mu_by_cycle), ...data.quantities.map(q => {
          const own = pair.quantities[q.name];
          const decimals = Uncertain.decimalsFor(half(own), q.decimals);
          if (own.p == null) return row(label(q), absentCell(own.reason), ...Array(6).fill(""));
          const needed = n => (n == null ? "> 10000" : String(n));
          return row(label(q), fixed(own.difference, decimals), range(own.confidence_interval, decimals),
            node("td", own.p < 0.05 ? {class: "differs"} : {}, probability(own.p)), fixed(own.hedges_g, 2),
            range(own.hedges_g_interval, 1), needed(own.tests_needed_80), needed(own.tests_needed_90));
        })]));
      const regime = pair.regime;
      if (regime.p != null) {
        made.append(node("p", {class: "note", id: `regime-${i}`}, `Sticking: ${regime.a_sticking} of ${regime.a_sticking + regime.a_sliding} tests of A, ` +
          `${regime.b_sticking} of ${regime.b_sticking + regime.b_sliding} of B; p ${probability(regime.p)} (Fisher's exact test).`));
      }
    });
    const combined = data.quantities.filter(q => data.comparison.combined[q.name]);
    if (combined.length > 0) {
      made.append(node("p", {class: "note"}, "All speeds together, p (Fisher): " +
        combined.map(q => `${q.title} ${probability(data.comparison.combined[q.name].p)}`).join(", ")));
    }
  }

  // ---- Replicates --------------------------------------------------------------------------------------
  const hasSystematic = group => data.quantities.some(q => group.quantities[q.name].systematic_uncertainty != null);
  function writeReplicates() {
    const made = section("replicates", "Replicates", node("p", {class: "note"},
      "Two single tests of one material differ by less than r = 2.8 s_r, 95 times of 100 (ISO 5725-6). " + coverage() +
      (data.materials.some(material => material.groups.some(hasSystematic)) ? " ± syst.: the systematic part of the mean (calibration, corrections), which more tests do not make smaller." : "")));
    const grid = node("div", {class: "grid"});
    made.append(grid);
    data.materials.forEach((material, m) => material.groups.forEach((group, g) => {
      const notes = [];
      const own = node("div", {}, node("h3", {}, `${two ? nameOf(m) + ", " : ""}${group.text}, ${plural(group.tests.length, "test")}`),
        node("p", {id: `by-cycle-${m}-${g}`}, node("b", {}, `S−K by cycle ${pooledText(group.delta_mu_by_cycle)}`),
          `: ${group.delta_mu_by_cycle.reason || pooledFacts(group.delta_mu_by_cycle)}`),
        table(`replicates-${m}-${g}`, ["", "n", "mean", ...(hasSystematic(group) ? ["± syst."] : []), "s_r", "r = 2.8 s_r", "95 % of the mean"], data.quantities.map(q => {
          const own = group.quantities[q.name];
          if (own.outlier) {
            notes.push(node("li", {}, node("b", {}, `${q.title} of ${own.outlier.file} stands out`),
              `: Grubbs ${fixed(own.outlier.statistic, 2)} above ${fixed(own.outlier.critical, 2)} (5 %). It is not left out.`));
          }
          for (const absence of own.absent) notes.push(node("li", {}, node("b", {}, `no ${q.title} in ${absence.file}`), `: ${absence.reason}`));
          return row(label(q), String(own.count), fixed(own.mean, meanDecimals(own, q)), ...(hasSystematic(group) ? [scatter(own.systematic_uncertainty, q)] : []),
            scatter(own.standard_deviation, q), scatter(own.repeatability, q), range(own.confidence_interval, meanDecimals(own, q)));
        })));
      if (notes.length > 0) own.append(node("ul", {class: "notes"}, ...notes));
      grid.append(own);
    }));
  }

  // ---- Uncertainty budgets -----------------------------------------------------------------------------
  const budgeted = ["delta_mu", "static_coefficient", "kinetic_coefficient"].map(name => data.quantities.find(q => q.name === name));
  const budgetSize = size => (size == null ? "" : size === 0 ? "0" : size.toFixed(Uncertain.decimalsFor(size, 5)));
  function budgetTable(id, budgets) {
    const owned = budgeted.filter(q => budgets[q.name] != null);
    const lines = [...new Map(owned.flatMap(q => budgets[q.name].lines).map(line => [line.source, line])).values()];
    const rank = line => Math.max(...owned.map(q => budgets[q.name].lines.findIndex(own => own.source === line.source)));
    const sizeCell = line => node("td", line.note ? {title: line.note} : {}, {counted: budgetSize(line.standard_uncertainty), included: `(${budgetSize(line.standard_uncertainty) || " "})`, none: "0", unknown: "–"}[line.state]);
    const shareOf = line => (line.share == null ? "" : line.share > 0 && line.share < 0.005 ? "<1" : (100 * line.share).toFixed(0));
    const sums = (heading, key, share) => row(node("td", {}, node("b", {}, heading)), "", ...owned.flatMap(q =>
      [node("td", {}, node("b", {}, budgets[q.name][key] == null ? "–" : budgetSize(budgets[q.name][key]))), budgets[q.name][key] == null ? "" : share]));
    const notes = new Map(owned.flatMap(q => budgets[q.name].lines).filter(line => line.note && line.state !== "none").map(line => [`${line.title}: ${line.note}`, line]));
    return node("div", {},
      table(id, ["source", "type", ...owned.flatMap(q => [`u ${title(q)}`, "%"])], [
        ...lines.sort((x, y) => rank(x) - rank(y)).map(line => row(node("td", {class: "text"}, line.title), line.type, ...owned.flatMap(q => {
          const own = budgets[q.name].lines.find(other => other.source === line.source);
          return own == null ? ["", ""] : [sizeCell(own), shareOf(own)];
        }))),
        sums("combined, u", "combined_standard_uncertainty", "100"), sums("expanded, U = 2 u", "expanded_uncertainty", "")]),
      ...owned.map(q => node("p", {}, node("b", {}, budgets[q.name].statement))),
      node("ul", {class: "notes"}, ...[...notes].map(([text, line]) => node("li", {}, `${line.state === "unknown" ? "–" : "( )"} ${text}`))));
  }
  function writeBudgets() {
    const has = budgets => budgeted.some(q => budgets[q.name] != null);
    const made = section("budgets", "Uncertainty budget", node("p", {class: "note"},
      "As in the GUM (JCGM 100:2008): u is a standard uncertainty, by statistics (type A) or otherwise (type B); %: its share of the variance u²; – not known; ( ) counted in another line. " +
      "The parts of the model add as they are, all else in quadrature."));
    data.materials.forEach((material, m) => material.groups.forEach((group, g) => {
      if (!has(group.budgets)) return;
      made.append(node("h3", {}, `${two ? nameOf(m) + ", " : ""}${group.text}, ${plural(group.tests.length, "test")}`), budgetTable(`budget-${m}-${g}`, group.budgets));
      if (group.tests.length > 1) {
        made.append(node("details", {id: `budgets-of-tests-${m}-${g}`}, node("summary", {}, "of each test"), ...group.tests.filter(t => has(material.tests[t].budgets)).map(t =>
          node("div", {}, node("h4", {}, `test ${t + 1}, ${material.tests[t].file}`), budgetTable(`budget-of-test-${m}-${t}`, material.tests[t].budgets)))));
      }
    }));
  }

  // ---- Traces ------------------------------------------------------------------------------------------
  const viewers = [];
  function writeViewer(m) {
    const material = data.materials[m];
    const box = node("div", {class: "charts", tabindex: "0", role: "group",
      "aria-label": "traces; keys: plus and minus zoom, arrows move, 0 shows the whole test"});
    const facts = node("p", {class: "facts"});
    const choice = node("select", {"aria-label": "test", id: `test-${m}`, onchange: () => viewer.show(choice.selectedIndex)},
      ...material.tests.map((t, i) => node("option", {}, `${i + 1}: ${t.file}`)));
    const count = node("span", {id: `marked-${m}`, "aria-live": "polite"});
    const button = (label, name, act) => node("button", {type: "button", "aria-label": name, title: name, onclick: act}, label);
    const viewer = {
      box, chart: null, shown: 0,
      show(i) {
        viewer.shown = i;
        choice.selectedIndex = i;
        const test = material.tests[i];
        const trace = JSON.parse(document.getElementById(`trace-${m}-${i}`).textContent);
        trace.key = `${m}`;
        // Times in equal steps are not listed.
        for (const part of [trace.force, trace.slope, trace.second])
          if (part && !part.time) part.time = part.value.map((_, n) => part.start + n * part.step);
        facts.textContent = [test.title, test.regime, `rung: ${test.rung}${test.details.rung ? `, ${test.details.rung.reason}` : ""}`, plural(trace.scan_count, "scan") + ` at ${Number(trace.rate.toPrecision(6))} Hz`,
          test.pull_speed_text, trace.thinned ? "lowest and highest scan of each part shown" : ""].filter(Boolean).join(" · ");
        if (viewer.chart) viewer.chart.destroy();
        viewer.chart = Charts.traces(box, trace, strokes[m], n => {
          count.textContent = `${plural(n, "cycle")} marked` + (n === trace.cycles.time.length ? "" : ` of ${trace.cycles.time.length}`);
        });
        document.querySelectorAll(`#tests-${m} tbody tr`).forEach((r, at) => r.classList.toggle("chosen", at === i));
      },
    };
    const keys = {"+": () => viewer.chart.zoom(0.5), "=": () => viewer.chart.zoom(0.5), "-": () => viewer.chart.zoom(2),
      "0": () => viewer.chart.whole(), ArrowLeft: () => viewer.chart.move(-0.25), ArrowRight: () => viewer.chart.move(0.25)};
    box.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    section(`traces-${m}`, two ? `Traces of ${nameOf(m)}` : "Traces",
      node("p", {class: "note"}, "Force, and below its derivative: the speed at which the coupling stretches, cut off at the pull speed while the sled sticks " +
        "(Penner 1995, Fig. 4). Below that, where it was measured, the pull speed or the position of the sled. Drag over a part to zoom in, double click for the whole test."),
      node("div", {class: "tools"}, choice, button("◀", "previous test", () => viewer.show(Math.max(0, viewer.shown - 1))),
        button("▶", "next test", () => viewer.show(Math.min(material.tests.length - 1, viewer.shown + 1))), node("span", {class: "grow"}),
        button("+", "zoom in", keys["+"]), button("−", "zoom out", keys["-"]), button("←", "move left", keys.ArrowLeft),
        button("→", "move right", keys.ArrowRight), button("whole test", "whole test", keys["0"])),
      facts, box,
      node("p", {class: "legend"}, node("span", {class: "swatch", style: "background: var(--stick)"}), "sticks",
        node("span", {class: "swatch", style: "background: var(--slip)"}), "slips",
        node("span", {class: "swatch round", style: "background: var(--mark)"}), "peak, sticks again",
        node("span", {class: "swatch ring", style: "border-color: var(--free)"}), "peak, not seen to stick again",
        node("span", {class: "swatch", style: "background: var(--limit); height: 2px; border: 0; vertical-align: .25em"}), "pull speed", " · ", count));
    viewers.push(viewer);
  }

  // Tests whose pull speed changes: what each slip measures comes first, the speed of escape after it.
  function writeRamps() {
    const lines = data.materials.flatMap((material, m) => material.tests.flatMap((t, i) => t.ramp == null ? [] :
      [node("li", {}, node("b", {}, `${two ? nameOf(m) + ", " : ""}test ${i + 1}`), `: ${t.ramp}`)]));
    if (lines.length > 0) section("ramps", "Ramp tests", node("ul", {class: "notes"}, ...lines));
  }

  // S − K first, then what it is made of.
  const leading = ["delta_mu", "mu_s", "mu_k"];
  const inTests = [...leading.map(name => data.quantities.find(q => q.name === name)), ...data.quantities.filter(q => !leading.includes(q.name))];
  function writeTests(m) {
    const material = data.materials[m];
    const show = i => { viewers[m].show(i); document.getElementById(`traces-${m}`).scrollIntoView({block: "start"}); };
    const notes = material.tests.flatMap((t, i) => [...t.departures, ...t.coded_findings].map(d => node("li", {}, node("b", {}, `test ${i + 1}`), `: ${d.text ?? d}`,
      ...(d.action ? [node("div", {class: "note"}, `→ ${d.code}, ${d.severity}: ${d.action}`)] : []))));
    section(`all-tests-${m}`, two ? `Tests of ${nameOf(m)}` : "Tests",
      node("p", {class: "note"}, "Method: " + [...new Set(material.tests.map(t => (t.method || "not known") + (t.estimator === "fit" ? "" : ", estimator " + t.estimator)))].join("; ")),
      node("p", {class: "note", id: `errors-${m}`}, Uncertain.legend(material.tests.flatMap(t => inTests.map(q => [t[q.name], t.details[q.name]])))),
      table(`tests-${m}`, ["test", "file", "speed", "regime", ...inTests.map(q => named(q, " (model)"))], material.tests.map((t, i) => row(
        node("td", {}, node("button", {type: "button", class: "link", onclick: () => show(i)}, String(i + 1))),
        node("td", {class: "text"}, t.file), t.pull_speed_text, node("td", {class: "text", title: t.details.regime ? t.details.regime.reason : ""}, t.regime),
        ...inTests.map(q => (t[q.name] == null ? absentCell(t.details[q.name].reason) : node("td", {}, ...Uncertain.lines(t[q.name], t.details[q.name], q.decimals))))))),
      ...(notes.length > 0 ? [node("ul", {class: "notes"}, ...notes)] : []));
  }

  // What the batch allows, and what was voided: not in any number of this page.
  function writeLimits(m) {
    const material = data.materials[m];
    if (material.limits.length > 0) {
      const side = value => (value == null ? "–" : String(value));
      const named = tests => tests.map(i => i + 1).join(", ");
      section(`limits-${m}`, "Limits", table(`limit-table-${m}`, ["result", "lowest", "highest", "verdict", "tests outside", "tests without it"],
        material.limits.map(own => row(node("td", {class: "text"}, own.quantity), side(own.lowest), side(own.highest),
          node("td", {class: "text"}, own.pass ? "✓ pass" : "✗ FAIL"), named(own.outside), named(own.absent)))));
    }
    if (material.voided.length > 0) {
      section(`voided-${m}`, two ? `Void tests of ${nameOf(m)}` : "Void tests",
        node("p", {class: "note"}, "Left out of all numbers here; their files are untouched."),
        node("ul", {class: "notes"}, ...material.voided.map(v => node("li", {}, node("b", {}, v.file), `: ${v.reason} (${v.by}, ${v.at.slice(0, 16).replace("T", " ")})`))));
    }
  }

  // ---- The page ----------------------------------------------------------------------------------------
  const total = data.materials.reduce((sum, m) => sum + m.tests.length, 0);
  const heading = two ? `${data.materials[0].label} against ${data.materials[1].label}` :
    total === 1 ? data.materials[0].tests[0].title || data.materials[0].tests[0].file : `Friction of ${total} tests`;
  document.title = `${heading} – stickslip`;
  document.getElementById("title").textContent = heading;
  document.getElementById("subtitle").textContent =
    data.materials.map((m, i) => (two ? `${nameOf(i)}: ` : "") + `${plural(m.tests.length, "test")} in ${plural(m.groups.length, "group")}`).join("; ");
  document.getElementById("footer").textContent = `Made by ${data.program}. This file holds everything it shows and asks no network.`;

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const setTheme = theme => { document.documentElement.dataset.theme = theme; };
  const kPaper = 700;  // Pixels of a chart on paper: A4 between its margins.
  let liked = null;    // The theme of the screen, while it is printed.
  const redraw = () => { drawFigure(); for (const viewer of viewers) { const at = viewer.chart.inView(); viewer.show(viewer.shown); viewer.chart.view(...at); } };
  setTheme(dark.matches ? "dark" : "light");

  writeForm();
  data.materials.forEach((_, m) => writeLimits(m));
  writeMeans();
  if (two) writeComparison();
  writeReplicates();
  writeBudgets();
  data.materials.forEach((_, m) => writeTests(m));
  writeRamps();
  writeFigure();
  data.materials.forEach((_, m) => writeViewer(m));
  viewers.forEach(viewer => viewer.show(0));

  document.getElementById("theme").addEventListener("click", () => { setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"); redraw(); });
  dark.addEventListener("change", () => { if (liked == null) setTheme(dark.matches ? "dark" : "light"); redraw(); });
  const fit = () => {
    if (liked != null) return;
    if (figure) figure.setSize({width: Charts.width(figureBox), height: figure.height});
    for (const viewer of viewers) viewer.chart.resize();
  };
  new ResizeObserver(fit).observe(main);

  // Charts are pictures: for a printer they are drawn anew, light and as wide as the paper.
  const print = on => {
    if (on === (liked != null)) return;
    if (on) {
      liked = document.documentElement.dataset.theme;
      setTheme("light");
      Charts.onPaper(kPaper);
    } else {
      setTheme(liked);
      liked = null;
      Charts.onPaper(null);
    }
    redraw();
  };
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));
  const printer = matchMedia("print");
  printer.addEventListener("change", () => print(printer.matches));
  window.stickslip = {data, viewers, figure: () => figure};  // For tests and for the curious.
})();

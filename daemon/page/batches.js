// All batches: reports on one, comparison of two. The daemon makes both; this only asks, shows and saves.
"use strict";

const Batches = (() => {
  const part = id => document.getElementById(id);
  const kForms = ["html", "csv", "json"];
  let ask = null, fetched = null, save = null;

  const say = text => { part("batches-message").textContent = text; };
  const reportOf = id => `/v1/batches/${encodeURIComponent(id)}/report`;
  const of = (path, form) => `${path}${path.includes("?") ? "&" : "?"}format=${form}`;
  const both = () => ["a", "b"].map(side => part("batches-dialog").querySelector(`input[name=${side}]:checked`)?.value);

  // What is being made takes a while; meanwhile no second is asked for, which the daemon would refuse.
  async function whileBusy(what, act) {
    const buttons = [...part("batches-dialog").querySelectorAll("button:not(#batches-close)")], focused = document.activeElement;
    for (const button of buttons) button.disabled = true;
    part("batches-dialog").setAttribute("aria-busy", "true");
    say(`${what} is being made …`);
    try {
      say(await act());
    } catch (error) {
      say(error.message);
    }
    for (const button of buttons) button.disabled = false;
    part("batches-dialog").setAttribute("aria-busy", "false");
    focused?.focus();
  }

  /// In a window of its own: the report draws with a script that stands in it, which this page's policy forbids.
  function show(path, what) {
    const shown = window.open("/page/report", "_blank");
    if (shown == null) return say("the browser blocks the new window: allow it, or save the report");
    const ready = new Promise(done => window.addEventListener("message", function heard(event) {
      if (event.source !== shown) return;
      window.removeEventListener("message", heard);
      done();
    }));
    return whileBusy(what, async () => {
      try {
        const text = await (await fetched(of(path, "html"))).text();
        await ready;
        shown.postMessage(text, "*");  // It has no origin of its own, so that it can touch nothing here.
      } catch (error) {
        shown.close();
        throw error;
      }
      return `${what} stands in a window of its own`;
    });
  }
  const keep = (path, form, name, what) => whileBusy(what, async () => { await save(of(path, form), `${name}.${form}`); return `saved ${name}.${form}`; });

  function button(text, label, act) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", act);
    return made;
  }
  function side(name, batch, k) {
    const td = Tables.cell(""), label = document.createElement("label"), radio = document.createElement("input"), said = document.createElement("span");
    radio.type = "radio";
    radio.name = name;
    radio.value = batch.id;
    radio.id = `batches-${name}-${k}`;
    said.className = "hidden";
    said.textContent = `${name.toUpperCase()}: ${batch.name}, ${batch.id}`;
    label.append(radio, said);
    td.append(label);
    return td;
  }
  function row(batch, k) {
    const reports = Tables.cell("", "text"), path = reportOf(batch.id), what = `the report on ${batch.name}`;
    reports.append(button("Report", `show ${what}`, () => show(path, what)),
      ...kForms.map(form => button(form.toUpperCase(), `save ${what} as ${form}`, () => keep(path, form, `${batch.id}-report`, what))));
    return Tables.row([side("a", batch, k), side("b", batch, k), Tables.cell(batch.name, "text"), Tables.cell(batch.grade ?? "–", "text"),
      Tables.cell(batch.id, "text"), Tables.cell(String(batch.counted)), Tables.cell(String(batch.voided)), reports]);
  }

  // Both sides at once, or what is missing.
  function comparing(act) {
    const [a, b] = both();
    if (a == null || b == null || a === b) return say("choose two batches, one as A and another as B");
    return act(`/v1/compare?a=${encodeURIComponent(a)}&b=${encodeURIComponent(b)}`, `${a}-${b}-comparison`, "the comparison");
  }
  part("compare-show").addEventListener("click", () => comparing((path, name, what) => show(path, what)));
  for (const form of kForms) part(`compare-${form}`).addEventListener("click", () => comparing((path, name, what) => keep(path, form, name, what)));

  part("batches-close").addEventListener("click", () => part("batches-dialog").close());
  part("batches-open").addEventListener("click", async () => {
    part("batches-dialog").showModal();
    say("");
    try {
      const {batches} = await ask("GET", "/v1/batches");
      part("batches-rows").replaceChildren(...batches.map(row));
      part("batches-table").hidden = batches.length === 0;
      if (batches.length === 0) say("there is no batch yet");
      (part("batches-rows").querySelector("button") ?? part("batches-close")).focus();
    } catch (error) { say(error.message); }
  });

  return {
    /// \param asking  (method, path) → JSON. \param fetching  path → reply. \param saving  (path, name).
    connect(asking, fetching, saving) { ask = asking; fetched = fetching; save = saving; },
  };
})();

// All batches: reports on one, comparison of two. The daemon makes both; this only asks, shows and saves (shown.js).
"use strict";

const Batches = (() => {
  const part = id => document.getElementById(id);
  const {say, show, keep} = Shown.of("batches"), {forms, button} = Shown;
  let ask = null;

  const reportOf = id => `/v1/batches/${encodeURIComponent(id)}/report`;
  const both = () => ["a", "b"].map(side => part("batches-dialog").querySelector(`input[name=${side}]:checked`)?.value);

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
      ...forms.map(form => button(form.toUpperCase(), `save ${what} as ${form}`, () => keep(path, form, `${batch.id}-report`, what))));
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
  for (const form of forms) part(`compare-${form}`).addEventListener("click", () => comparing((path, name, what) => keep(path, form, name, what)));

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
    /// \param asking  (method, path) → JSON.
    connect(asking) { ask = asking; },
  };
})();

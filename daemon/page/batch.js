// The batch: which test it asks for next, how it begins and ends, and tests that do not count.
"use strict";

const Batch = (() => {
  const part = id => document.getElementById(id);
  const plan = part("batch-begin");
  const kWithUnit = "oscillation_frequency";  // The one result of the table that has a dimension.
  let ask = null, say = null, changed = null;
  let told = null;    // What the health said of the batch, as text.
  let shown = null;   // The current batch.
  let done = 0;       // Tests of the batch that count.
  let chosen = null;  // The test to be void: {body, what, button}.

  const refusal = (id, error) => { part(id).textContent = error.message; };

  function show(batch) {
    const leads = batch != null, complete = leads && batch.next == null && batch.done === batch.planned;
    done = leads ? batch.done : 0;
    part("batch-name").textContent = leads ? `${batch.name}${batch.plan.grade ? `, ${batch.plan.grade}` : ""}: ${batch.done} of ${batch.planned} tests made` : "no batch: tests are as planned below";
    shown = batch;
    Answer.batch(batch);
    part("batch-trouble").textContent = leads && batch.trouble != null ? batch.trouble : "";
    part("batch-open").hidden = leads && !complete;
    part("batch-end").hidden = !leads;
    part("batch-tests").hidden = !leads || batch.tests.length === 0;
    const focused = document.activeElement?.id;
    part("batch-rows").replaceChildren(...(leads ? batch.tests : []).map((test, k) => {
      const tr = Tables.row([Tables.cell(String(k + 1)), Tables.cell(Answer.stepText(test), "text"), Tables.cell(test.record, "text"),
        Tables.cell(test.voided ? `void: ${test.voided.reason}, by ${test.voided.by}` : "counts", "text"), voidCell(`batch-void-${k}`, {record: test.record}, test.record, test.voided)]);
      if (test.voided) tr.className = "void";
      return tr;
    }));
    if (focused?.startsWith("batch-void-")) part(focused)?.focus();
  }

  /// A button that voids a test, or lets it count again.
  function voidCell(id, body, what, voided) {
    const td = Tables.cell(""), button = document.createElement("button");
    button.type = "button";
    button.id = id;
    button.textContent = voided ? "Restore" : "Void …";
    button.setAttribute("aria-label", `${voided ? "restore" : "void"} ${what}`);
    button.addEventListener("click", () => (voided ? restore(body, what, id) : choose(body, what, id)));
    td.append(button);
    return td;
  }
  async function restore(body, what, button) {
    try {
      show((await ask("POST", "/v1/restore", body)).batch);
      say(`${what} counts again`, true);
      part(button)?.focus();  // The table keeps it when it is written anew.
      await changed();
    } catch (error) { say(error.message); }
  }
  function choose(body, what, button) {
    chosen = {body, what, button};
    part("void-title").textContent = `${what} does not count`;
    part("void-message").textContent = "";
    part("void-reason").value = "";
    part("void-dialog").showModal();
    part("void-reason").focus();
  }
  part("void-form").addEventListener("submit", async event => {
    event.preventDefault();
    const {body, what, button} = chosen;
    try {
      show((await ask("POST", "/v1/void", {...body, reason: part("void-reason").value})).batch);
      part("void-dialog").close();
      say(`${what} does not count; its record stays as it is`, true);
      part(button)?.focus();  // The table keeps it when it is written anew.
      await changed();
    } catch (error) { refusal("void-message", error); }
  });
  part("void-close").addEventListener("click", () => part("void-dialog").close());

  part("batch-limits").querySelector("div").replaceChildren(...Tables.ranges(kWithUnit));

  // Empty fields use the method's values, else the daemon's.
  function asked() {
    const values = {};
    for (const field of plan.querySelectorAll("input")) {
      const text = field.value.trim(), [quantity, side] = field.name.split(".");
      if (text === "") continue;
      if (side) {
        ((values.limits ??= {})[quantity] ??= {})[side] = quantity === kWithUnit ? text : Number(text);
        continue;
      }
      values[field.name] = field.type === "number" ? Number(text) : field.name === "pull_speeds" ? text.split(",").map(speed => speed.trim()).filter(speed => speed !== "") : text;
    }
    return values;
  }
  part("batch-open").addEventListener("click", () => { part("batch-message").textContent = ""; part("batch-dialog").showModal(); plan.elements.name.focus(); });
  // Fields keep what was planned before: what is typed into one that was entered replaces it.
  let entered = null;
  plan.addEventListener("focusin", ({target}) => { if (target.matches("input")) (entered = target).select(); });
  plan.addEventListener("click", ({target}) => { if (target === entered) target.select(); entered = null; });
  part("batch-close").addEventListener("click", () => part("batch-dialog").close());
  plan.addEventListener("submit", async event => {
    event.preventDefault();
    if (!await Tables.sledMeant("Begin the batch")) return;
    try {
      const {batch} = await ask("POST", "/v1/batch", asked());
      show(batch);
      part("batch-dialog").close();
      part("batch-end").focus();  // What opened the dialog is gone.
      say(`batch ${batch.id} has begun: ${batch.planned} test${batch.planned === 1 ? "" : "s"}`, true);
      await changed();
    } catch (error) { refusal("batch-message", error); }
  });

  part("batch-end").addEventListener("click", () => {
    part("end-message").textContent = "";
    part("end-what").textContent = `${part("batch-name").textContent}. A batch that has ended is not gone on with; its records and its report stay.`;
    part("end-dialog").showModal();
    part("end-leave").focus();
  });
  part("end-leave").addEventListener("click", () => part("end-dialog").close());
  part("end-sure").addEventListener("click", async () => {
    try {
      await ask("DELETE", "/v1/batch");
      show(null);
      part("end-dialog").close();
      say("the batch has ended", true);
      part("batch-open").focus();  // At once: later it would take the keyboard from what somebody does next.
      await changed();
    } catch (error) { refusal("end-message", error); }
  });

  async function load() { show((await ask("GET", "/v1/batch")).batch); }

  return {
    /// \param asking  (method, path, body) → JSON. \param saying  (text, good). \param changing  what else shows tests.
    connect(asking, saying, changing) { ask = asking; say = saying; changed = changing; },
    /// Reads the batch again where it has changed.
    async health(status) {
      const now = JSON.stringify(status.batch);
      if (now === told) return;
      told = now;
      try {
        await load();
        await changed();
      } catch (error) {
        told = null;  // Once more with the next.
        say(error.message);
      }
    },
    load,
    voidCell,
    done: () => done,
    /// The place of a test in the current batch, {name, grade, pull_speed, replicate, slide}; undefined: it has none.
    place(test) {
      const file = path => path.split("/").pop();
      const step = shown?.under_way.find(one => one.test === test.number) ?? (test.file ? shown?.tests.find(one => file(one.record) === file(test.file)) : undefined);
      return step && {...step, name: shown.name, grade: shown.plan.grade};
    },
  };
})();

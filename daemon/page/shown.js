// Reports that the daemon makes: shown in a window of their own, or saved. The dialog that asks says meanwhile what is done.
"use strict";

const Shown = (() => {
  const forms = ["html", "csv", "json"];
  const inForm = (path, form) => `${path}${path.includes("?") ? "&" : "?"}format=${form}`;
  let fetched = null, save = null;

  /// For one dialog. \param name  that of `name-dialog`, `name-message` and `name-close`.
  function of(name) {
    const part = id => document.getElementById(`${name}-${id}`);
    const say = text => { part("message").textContent = text; };

    // What is being made takes a while; meanwhile no second is asked for, which the daemon would refuse. \param act  gives what is said then.
    async function whileBusy(doing, act) {
      const buttons = [...part("dialog").querySelectorAll(`button:not(#${name}-close)`)], focused = document.activeElement;
      for (const button of buttons) button.disabled = true;
      part("dialog").setAttribute("aria-busy", "true");
      say(doing);
      try {
        say(await act());
      } catch (error) {
        say(error.message);
      }
      for (const button of buttons) button.disabled = false;
      part("dialog").setAttribute("aria-busy", "false");
      // Whoever has gone on to another field stays there.
      if (document.activeElement === document.body || document.activeElement === focused) focused?.focus();
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
      return whileBusy(`${what} is being made …`, async () => {
        try {
          const text = await (await fetched(inForm(path, "html"))).text();
          await ready;
          shown.postMessage(text, "*");  // It has no origin of its own, so that it can touch nothing here.
        } catch (error) {
          shown.close();
          throw error;
        }
        return `${what} stands in a window of its own`;
      });
    }
    const keep = (path, form, file, what) =>
      whileBusy(`${what} is being made …`, async () => { await save(inForm(path, form), `${file}.${form}`); return `saved ${file}.${form}`; });
    return {say, whileBusy, show, keep};
  }

  function button(text, label, act) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", act);
    return made;
  }

  return {
    /// \param fetching  path → reply. \param saving  (path, name).
    connect(fetching, saving) { fetched = fetching; save = saving; },
    of, forms, button,
  };
})();

// Who has the bench: this page, another, or nobody; taken over, given back, and given back when the page goes.
"use strict";

const Lease = (() => {
  const kReturned_s = 30;  // For which a page that is loaded anew has what it had.
  const kTaken_s = 60;
  const part = id => document.getElementById(id);
  if (!sessionStorage.getItem("name")) sessionStorage.setItem("name", `page ${Math.random().toString(36).slice(2, 6)}`);
  // Of the operator, on this computer; else one of this tab.
  const name = () => localStorage.getItem("operator") || sessionStorage.getItem("name");
  let ask = null, send = null, say = null;
  let holder = null;      // Its name, as the daemon told it last; null: nobody.
  let commanded = false;  // This tab has taken the bench: what it took goes with it, and not what another tab of the operator took.

  function write(lease) {
    holder = lease.controller;
    const mine = holder === name();
    if (!mine) commanded = false;
    const text = holder == null ? "nobody commands" : `${mine ? (localStorage.getItem("operator") ? `${holder}, you, commands` : "this page commands") : `${holder} commands`}`;
    if (part("holder").textContent !== text) part("holder").textContent = text;
    part("give-back").hidden = !mine;
    part("take-over").hidden = holder == null || mine;
  }
  const load = async () => write(await ask("GET", "/v1/controller"));
  async function act(method, body) {
    try { write(await ask(method, "/v1/controller", body)); } catch (error) { say(error.message); await load(); }
  }

  part("give-back").addEventListener("click", async () => { await act("DELETE"); part("operator").focus(); });
  part("take-over").addEventListener("click", async () => {
    const from = holder;
    if (!await Tables.confirm("Take the bench over?", `${from} has the bench. What is under way goes on, and ${from} is refused from then on.`, [], `Take it from ${from}`)) return;
    await act("PUT", {seconds: kTaken_s, from});
    (part("give-back").hidden ? part("operator") : part("give-back")).focus();
  });
  part("operator").value = localStorage.getItem("operator") ?? "";
  part("operator").addEventListener("change", async event => {
    // Under the old name first: with another one it cannot be given back.
    if (commanded && holder === name()) await act("DELETE");
    localStorage.setItem("operator", event.target.value.trim());
    await load();
  });
  window.addEventListener("pagehide", () => {
    if (!commanded) return;
    sessionStorage.setItem("had bench", "yes");
    send("DELETE", "/v1/controller", undefined, {keepalive: true}).catch(() => {});
  });

  return {
    name,
    load,
    /// A request that takes the bench has been granted.
    took() { commanded = true; },
    /// \param sending  (method, path, body, more for fetch) → its reply, which outlives the page with keepalive.
    connect(asking, sending, saying) { ask = asking; send = sending; say = saying; },
    /// Takes again what this tab had before it was loaded anew, unless somebody else has it by now.
    async back() {
      if (sessionStorage.getItem("had bench") == null) return load();
      sessionStorage.removeItem("had bench");
      try { write(await ask("PUT", "/v1/controller", {seconds: kReturned_s})); } catch { await load(); }
    },
  };
})();

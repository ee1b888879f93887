// Who has the bench: this page, another, or nobody; taken over, given back, and given back when the page goes.
"use strict";

const Lease = (() => {
  const kLongest_s = 3600;  // That may be asked for.
  const kCommand_s = 30;  // That each command takes.
  const kLongestName = 64;  // Bytes.
  const kTaken_s = 60;
  const kHealth_ms = 1000;  // From one health frame to the next.
  const part = id => document.getElementById(id);
  if (!sessionStorage.getItem("name")) sessionStorage.setItem("name", `page ${Math.random().toString(36).slice(2, 6)}`);
  // Of the operator, on this computer; else one of this tab.
  const name = () => localStorage.getItem("operator") || sessionStorage.getItem("name");
  let ask = null, send = null, say = null;
  let holder = null;      // Its name, as the daemon told it last; null: nobody.
  let commanded = false;  // A command of this tab was granted: only then does closing it give the bench back.
  let until = 0;          // Of its lease, by this computer's clock, ms.
  let granted = 0;        // When this page was granted a command last, ms.

  function write(lease) {
    holder = lease.controller;
    const mine = holder === name();
    if (!mine) commanded = false;
    until = Date.now() + 1000 * lease.seconds_left;
    const text = holder == null ? "nobody commands" : !mine ? `${holder} commands` : localStorage.getItem("operator") ? `${holder}, you, commands` : "this page commands";
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
    if (!await Tables.confirm("Take the bench over?", `${from} has the bench. What is under way goes on, and ${from} is refused while you have it.`, [], `Take it from ${from}`)) return;
    await act("PUT", {seconds: kTaken_s, from});
    (part("give-back").hidden ? part("operator") : part("give-back")).focus();
  });
  part("operator").value = localStorage.getItem("operator") ?? "";
  part("operator").addEventListener("change", async event => {
    const said = event.target.value.trim();
    if (new TextEncoder().encode(said).length > kLongestName) return say(`my name: "${said}" is longer than ${kLongestName} bytes: shorten it`);
    // Under the old name first: with another one it cannot be given back.
    if (commanded && holder === name()) await act("DELETE");
    localStorage.setItem("operator", said);
    await load();
  });
  // Said in another tab.
  window.addEventListener("storage", event => {
    if (event.key !== "operator") return;
    part("operator").value = event.newValue ?? "";
    load().catch(() => {});
  });
  window.addEventListener("pagehide", () => {
    if (!commanded) return;
    sessionStorage.setItem("had bench", String(until));
    send("DELETE", "/v1/controller", undefined, {keepalive: true}).catch(() => {});
  });

  return {
    name,
    /// A frame on its way when a command was granted does not know of it: the next one does.
    health(status) { if (Date.now() - granted > kHealth_ms) write(status.lease); },
    /// A request that takes the bench has been granted.
    took() {
      granted = Date.now();
      write({controller: name(), seconds_left: Math.max((until - granted) / 1000, kCommand_s)});
      commanded = true;
    },
    /// \param sending  (method, path, body, more for fetch) → its reply, which outlives the page with keepalive.
    connect(asking, sending, saying) { ask = asking; send = sending; say = saying; },
    /// Takes again what this tab had before it was loaded anew, unless somebody else has it by now.
    async back(status) {
      const left_s = (Number(sessionStorage.getItem("had bench")) - Date.now()) / 1000;
      sessionStorage.removeItem("had bench");
      if (!(left_s > 0)) return write(status.lease);
      try { write(await ask("PUT", "/v1/controller", {seconds: Math.min(left_s, kLongest_s)})); } catch { await load(); }
    },
  };
})();

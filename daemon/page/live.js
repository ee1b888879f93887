// The live page: asks and commands over HTTP, listens over the WebSocket, and comes back by itself.
"use strict";

(() => {
  const kRetry = 2000;  // ms
  const text = (id, said) => { document.getElementById(id).textContent = said; };
  // From #token=… of the address, which the browser sends to nobody; kept for this tab alone.
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) {
    sessionStorage.setItem("token", given);
    history.replaceState(null, "", location.pathname);
  }
  const token = () => sessionStorage.getItem("token") || "";
  const say = (said, good) => { text("message", said); document.getElementById("message").className = good ? "good" : ""; };

  // A header has bytes, and a name is UTF-8.
  const bytes = text => String.fromCharCode(...new TextEncoder().encode(text));
  function send(method, path, body, more) {
    const headers = {Authorization: `Bearer ${token()}`, "Stickslip-Controller": bytes(Lease.name())};
    if (method !== "GET") headers["Idempotency-Key"] = `${Date.now()}-${Math.random()}`;
    return fetch(path, {method, headers, body: body === undefined ? undefined : JSON.stringify(body), ...more});
  }
  async function ask(method, path, body) {
    const reply = await send(method, path, body);
    const json = await reply.json();
    if (reply.status === 401) document.getElementById("access").hidden = false;
    if (!reply.ok) throw Object.assign(new Error(json.error), {status: reply.status});
    if (method !== "GET") Lease.took();
    return json;
  }
  async function fetched(path) {
    const reply = await fetch(path, {headers: {Authorization: `Bearer ${token()}`}});
    if (!reply.ok) throw new Error((await reply.json()).error);
    return reply;
  }
  // The browser's own way to save a file cannot carry the token.
  async function download(path, name) {
    const reply = await fetched(path);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await reply.blob());
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
    say(`saved ${name}`, true);
  }
  const attempt = async act => { try { await act(); } catch (error) { say(error.message); } };

  // One at a time, and once more if something came meanwhile: the table must not fall behind a slow machine.
  let refreshing = false, again = false;
  async function refresh() {
    again = true;
    if (refreshing) return;
    refreshing = true;
    try {
      while (again) {
        again = false;
        await show();
      }
    } finally {
      refreshing = false;
    }
  }
  async function show() {
    const made = Batch.done();  // First: of a test that ends meanwhile the table may know more, not less.
    const {tests, summary} = await ask("GET", "/v1/tests");
    Answer.tests(tests, summary);
    Trace.tests(tests, summary.batch == null ? null : Batch.place);
    Tables.tests(tests, summary, made, (path, name) => attempt(() => download(path, name)), Batch.voidCell, Batch.place);
    fillPlan(await ask("GET", "/v1/plan"));  // A batch and others change it, too.
  }
  async function command(verb, body) {
    await attempt(async () => {
      const done = await ask("POST", `/v1/${verb}`, body);
      say(`${verb}: test ${done.test}, scan ${done.scan}`, true);
      Answer.bench(done.bench);
      await refresh();
    });
  }
  for (const button of document.querySelectorAll("[data-command]")) button.addEventListener("click", async () => {
    const verb = button.dataset.command;
    if (verb === "stop" || await Tables.sledMeant(button.textContent)) command(verb);
  });
  document.getElementById("mark").addEventListener("submit", event => {
    event.preventDefault();
    const field = document.getElementById("mark-text");
    command("mark", {text: field.value}).then(() => { field.value = ""; });
  });
  document.getElementById("access").addEventListener("submit", event => {
    event.preventDefault();
    sessionStorage.setItem("token", document.getElementById("token").value);
    event.target.hidden = true;
    say("");
    connect();
  });

  Tare.connect(ask, refresh);
  Calibrate.connect(ask);
  Batch.connect(ask, say, refresh);
  Shown.connect(fetched, download);
  Batches.connect(ask);
  Records.connect(ask, download);
  Trend.connect(ask);
  Trace.connect(ask);
  Lease.connect(ask, send, say);
  const plan = document.getElementById("plan");
  const planned = values =>
    text("planned", [values.name, values.pull_speed == null ? null : Tables.speed(values.pull_speed), values.operator].filter(said => said != null).join(", "));
  const planFields = () => plan.querySelectorAll("input, textarea");
  const otherFacts = facts => Object.entries(facts).filter(([key]) => !plan.elements[`fact.${key}`]).map(fact => fact.join("=")).join("\n");
  /// Fields that somebody has changed since they were filled keep what was typed.
  function fillPlan(values, all) {
    planned(values);
    for (const field of planFields()) {
      if (!all && field.value !== field.dataset.filled) continue;
      const value = field.name === "facts" ? otherFacts(values.facts) : field.name.startsWith("fact.") ? values.facts[field.name.slice("fact.".length)] : values[field.name];
      field.value = value == null ? "" : field.name === "pull_speed" ? Tables.speed(value) : value;
      field.dataset.filled = field.value;
    }
  }
  /// The plan as it is now, with the fields that were changed.
  async function changedPlan() {
    const {pull_speed: pull_speed_m_per_s, ...values} = await ask("GET", "/v1/plan");
    values.pull_speed_m_per_s = pull_speed_m_per_s;
    for (const field of [...planFields()].filter(field => field.value !== field.dataset.filled)) {
      const typed = field.value.trim();
      if (field.name === "facts") {
        for (const key of Object.keys(values.facts)) if (!plan.elements[`fact.${key}`]) values.facts[key] = null;
        for (const line of typed.split("\n").filter(line => line.trim() !== "")) {
          const [key, ...value] = line.split("=");
          if (value.length === 0) throw new Error(`other facts: "${line}" has no "=": write KEY=VALUE`);
          values.facts[key.trim()] = value.join("=").trim();
        }
      } else if (field.name.startsWith("fact.")) values.facts[field.name.slice("fact.".length)] = typed === "" ? null : typed;
      else {
        if (field.name === "pull_speed") delete values.pull_speed_m_per_s;
        values[field.name] = typed === "" ? null : field.type === "number" ? Number(typed) : typed;
      }
    }
    return values;
  }
  plan.addEventListener("submit", event => {
    event.preventDefault();
    attempt(async () => {
      fillPlan(await ask("PUT", "/v1/plan", await changedPlan()), true);
      say("the plan holds for tests that begin from now on", true);
    });
  });

  const frames = {
    scans(frame) { Scope.scans(frame); Tare.scans(frame); Answer.scans(frame); },
    bench(frame) { Answer.bench(frame.bench); Tare.bench(frame.bench); },
    "test-began": frame => { Scope.began(frame); Answer.began(frame); attempt(Batch.load); },
    fall: frame => Scope.fall(frame),
    cycle(frame) { Scope.cycle(frame); Tables.cycle(frame); Answer.cycle(frame); },
    gap(frame) { say(`gap: ${frame.scan_count} scans missing: ${frame.cause}`); },
    note() {},
    /// What the page draws, of before it came.
    history({frames}) {
      const drawn = {scans(one) { Scope.scans(one); Answer.scans(one); }, fall: Scope.fall, cycle(one) { Scope.cycle(one); Tables.cycle(one); Answer.cycle(one); },
        "test-began": Scope.began, "test-ended"(one) { Scope.ended(one); Answer.ended(one); }};
      for (const one of frames) drawn[one.type]?.(one);
    },
    dropped(frame) { say(`this browser was too slow for ${frame.frame_count} frames`); },
    "test-ended": frame => { Scope.ended(frame); Answer.ended(frame); attempt(refresh); },
    health(frame) {
      Tables.health(frame.status);
      Trend.health(frame.status);
      Tare.health(frame.status);
      Calibrate.health(frame.status);
      Batch.health(frame.status);
      Answer.health(frame.status);
      Lease.health(frame.status);
      // Records appear a moment after their tests, and those of before the daemon began one after the other.
      if ((frame.status.latest_test && document.querySelector("#tests tbody td:last-child")?.textContent === "…") || Tables.lacks()) attempt(refresh);
    },
  };

  let socket = null;
  function listen() {
    socket = new WebSocket(`ws://${location.host}/v1/live?history=1`, token() ? ["stickslip.v1", `token.${token()}`] : ["stickslip.v1"]);
    Scope.clear();
    Answer.clear();
    socket.addEventListener("message", event => { const frame = JSON.parse(event.data); frames[frame.type]?.(frame); });
    socket.addEventListener("close", () => {
      Answer.bench("not connected");
      Tare.gone();
      Tables.trouble("the daemon does not answer: the values shown are old");
      setTimeout(connect, kRetry);
    });
  }
  async function connect() {
    if (socket && socket.readyState < WebSocket.CLOSING) return;
    try {
      const status = await ask("GET", "/v1/status");
      Tables.health(status);
      Trend.health(status);
      Answer.health(status);
      fillPlan(await ask("GET", "/v1/plan"), true);
      await Lease.back(status);
      await refresh();
      await Batch.health(status);
      listen();
    } catch (error) {
      if (error instanceof TypeError) Tables.trouble("the daemon does not answer: the values shown are old"); else say(error.message);
      Answer.bench("not connected");
      if (document.getElementById("access").hidden) setTimeout(connect, kRetry);
    }
  }
  connect();
})();

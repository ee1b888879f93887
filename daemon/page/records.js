// History: the records of the record folder, searched as `stickslip find` does, with their traces, reports and files.
"use strict";

const Records = (() => {
  const kDigits = 4;
  const kShown = ["delta_mu", "mu_s", "mu_k"];
  const part = id => document.getElementById(`records-${id}`), form = part("form");
  const {say, whileBusy, show} = Shown.of("records");
  let ask = null, save = null;

  part("ranges").replaceChildren(...Tables.ranges());

  /// Begin and end of a day by the clock of this browser, as the table shows it.
  const kEdges = {from: "00:00:00", to: "23:59:59"};
  /// What is no day is left to the daemon, which says so.
  function moment(day, time) {
    const at = new Date(`${day}T${time}`);
    return Number.isNaN(at.getTime()) ? day : at.toISOString().replace(".000", "");
  }

  /// What the fields ask for; empty fields ask for nothing.
  function query() {
    const asked = new URLSearchParams(), ranges = new Map();
    for (const {name, value} of form.querySelectorAll("input, select")) {
      const text = value.trim(), [result, side] = name.split(".");
      if (text === "") continue;
      if (side) ranges.set(result, {...ranges.get(result), [side]: text}); else asked.set(name, kEdges[name] ? moment(text, kEdges[name]) : text);
    }
    const where = [...ranges].map(([result, {lowest, highest}]) => `${result}=${lowest ?? ""}:${highest ?? ""}`).join(",");
    if (where !== "") asked.set("where", where);
    return [...asked].map(([name, text]) => `${name}=${encodeURIComponent(text)}`).join("&");
  }

  function row(found) {
    const {record, results} = found, file = Tables.base(record), what = `the report on ${file}`;
    const texts = [found.sample, found.grade, found.operator, found.batch, found.method?.split(" ")[0], results.regime + (found.voided ? ` · void: ${found.voided.reason}` : "")];
    const tr = Tables.row([Tables.cell("", "text"), ...texts.map(text => Tables.cell(text ?? "–", "text")),
      ...kShown.map(name => Tables.cell(Uncertain.lines(results[name], results.uncertainties?.[name], kDigits))),
      Tables.cell([Shown.button("Report", `show ${what}`, () => show(`${Tables.recordPath(record)}/report`, what))], "text"),
      Tables.cell([Tables.recordLink(`found-${record}`, record, save)], "text")]);
    Tables.traced(record, Tables.minute(found.start_time), tr);
    if (found.voided) tr.className = "void";
    return tr;
  }
  function told({records, count, unread, notices}) {
    const rest = count - records.length, plural = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;
    return [count === 0 ? "no record meets these conditions" : `${rest === 0 ? "" : `${records.length} of `}${plural(count, "record")}, the newest first`,
      ...(rest > 0 ? [`${plural(rest, "older one")} not shown: narrow the search`] : []),
      ...(unread.length > 0 ? [`${plural(unread.length, "file")} cannot be searched: stickslip find --unread says why`] : []), ...notices].join("; ");
  }
  const search = () => whileBusy("searching …", async () => {
    const found = await ask("GET", `/v1/records?${query()}`);
    part("rows").replaceChildren(...found.records.map(row));
    part("table").hidden = found.records.length === 0;
    part("errors").textContent = Uncertain.legend(found.records.flatMap(({results}) => kShown.map(name => [results[name], results.uncertainties?.[name]])));
    return told(found);
  });

  form.addEventListener("submit", event => { event.preventDefault(); search(); });
  part("close").addEventListener("click", () => part("dialog").close());
  part("open").addEventListener("click", () => {
    part("dialog").showModal();
    form.elements.sample.focus();
    search();
  });

  return {
    /// \param asking  (method, path) → JSON. \param saving  (path, name).
    connect(asking, saving) { ask = asking; save = (path, name) => saving(path, name).then(() => say(`saved ${name}`), error => say(error.message)); },
  };
})();

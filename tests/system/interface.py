"""What others rely on when they use the programs, as facts that can be kept and compared: the words of the command line,
the names in what is printed, the description of the API. `freeze_version.py` keeps them, `system_compatibility` compares."""

import json
import pathlib
import re
import shutil
import subprocess

from running_daemon import RunningDaemon, wait_for

TIMEOUT_S = 240
# What --help calls a value → one that is taken. Others take any word.
VALUES = {"HZ": "350", "N": "1", "T": "1 s", "UNIT": "N", "SHELL": "bash", "N|FILE.h5": "1", "V": "1 m/s", "COUNT": "1"}

TIMES = {"idle": "5 s", "pull": "2 s", "rest": "5 s"}  # Of the first test of the frozen state.


def run(*words, cwd=None):
    return subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)


def printed(*words, cwd=None):
    done = run(*words, cwd=cwd)
    assert done.returncode in (0, 1), f"{words}: {done.stderr}"
    return done.stdout


def entries(text, heading):
    """The first columns of a list of --help."""
    listed = re.search(rf"(?ms)^{heading}:\n(.*?)(?:\n\n|\Z)", text)
    return re.findall(r"(?m)^  (\S.*?)(?:  .*)?$", listed[1]) if listed else []


def command_line(program, *command):
    """{"simulate": {"options": [[names, word for its value, required], …], "positionals": [[word, required], …]}, …} of a program
    and all its subcommands."""
    text = printed(program, *command, "--help")
    options = []
    for entry in entries(text, "Options"):
        names, *rest = entry.split()
        value = rest[0].partition("=")[0].partition(":")[0] if rest and rest[0] not in ("REQUIRED", "Excludes:", "Needs:") else None
        options.append([names.split(","), value, "REQUIRED" in rest])
    positionals = []
    for entry in entries(text, "Positionals"):
        value = entry.split()[1].partition("=")[0].partition(":")[0]
        positionals.append([value, "REQUIRED" in entry])
    found = {" ".join(command): {"options": options, "positionals": positionals}}
    for entry in entries(text, "Subcommands"):
        found |= command_line(program, *command, entry.split()[0])
    return found


def paths(value, place="", found=None):
    """{"tests[].results.mu_k": ["number"], …}: each place in a document of JSON with the kinds of what stands there."""
    found = {} if found is None else found
    if isinstance(value, dict):
        for key, one in value.items():
            paths(one, f"{place}.{key}" if place else key, found)
    elif isinstance(value, list):
        for one in value:
            paths(one, f"{place}[]", found)
    kinds = found.setdefault(place, [])
    kind = {dict: "object", list: "array", str: "text", bool: "boolean", int: "number", float: "number", type(None): None}[type(value)]
    if kind and kind not in kinds:
        kinds.append(kind)
    return found


def outputs(build, record):
    """{what prints it: names in it} of what the programs print for other programs to read."""
    cli, daemon = build / "bin" / "stickslip", build / "bin" / "stickslipd"

    def named(what):
        return sorted(one["name"] for one in json.loads(printed(cli, what, "--json"))[what])

    def columns(*words):
        return next(line for line in printed(cli, *words).splitlines() if not line.startswith("#")).split(",")

    documents = {"analyze --json": (cli, "analyze", record, "--json"), "analyze --effects --json": (cli, "analyze", record, "--effects", "--json"),
                 "verify --json": (cli, "verify", record, "--json"), "report --json": (cli, "report", record, "--json"),
                 "compare --json": (cli, "compare", record, "--json", "--against", record),
                 "scenes --json": (cli, "scenes", "--json"), "methods --json": (cli, "methods", "--json"), "boards --json": (cli, "boards", "--json"),
                 "stickslipd --result": (daemon, "--result", record)}
    tables = {"export --csv": ("export", record, "--csv"), "export --cycles --csv": ("export", record, "--cycles", "--csv"),
              "report --csv": ("report", record, "--csv", "-"), "compare --csv": ("compare", record, "--csv", "-", "--against", record)}
    return {"documents": {name: paths(json.loads(printed(*words))) for name, words in documents.items()},
            "columns": {name: columns(*words) for name, words in tables.items()},
            "names": {what: named(what) for what in ("scenes", "methods")}}


def metrics(text):
    """"NAME KIND LABELS" of each metric of Prometheus."""
    kinds = dict(re.findall(r"(?m)^# TYPE (\S+) (\S+)$", text))
    return sorted({f"{name} {kinds.get(name, '')}".strip() for name in kinds} |
                  {" ".join((name, *re.findall(r'(\w+)="', labels))) for name, labels in re.findall(r"(?m)^([a-z_]+)\{(.*)\} ", text)})


def without_words(value, names=False):
    """An OpenAPI description without what is said to people. names: its keys are names of fields."""
    if isinstance(value, dict):
        return {key: without_words(one, not names and key in ("properties", "schemas", "paths", "responses")) for key, one in value.items()
                if names or key not in ("description", "summary") or not isinstance(one, str)}
    return [without_words(one) for one in value] if isinstance(value, list) else value


def begin(daemon, frames):
    """Begins a test by command while the sled rests."""
    status = 0
    while status != 200:
        daemon.wait_for_rest(frames)
        status, _ = daemon.ask("POST", "/v1/start", {})


def goes_on(test, build, source, state):
    """Starts the daemon in a copy of `state`, which another one left, and measures one test there. Returns what it answers of the time
    before; the record that it made of each journal; description of the API, live stream and metrics."""
    daemon = RunningDaemon(test, build, source, times=TIMES, whole=(state / "d.toml").read_text(encoding="utf-8"),
                           prepare=lambda folder: shutil.copytree(state, folder, dirs_exist_ok=True))
    made = [daemon.folder / journal.relative_to(state).with_suffix(".h5") for journal in state.rglob("*.journal")]
    answers = {path: daemon.ask("GET", path)[1] for path in ("/v1/batch", "/v1/batches", "/v1/calibration", "/v1/plan")}
    del answers["/v1/calibration"]["folder"]  # Where it is today.
    process, stream = daemon.watch()
    test.addCleanup(process.communicate)
    test.addCleanup(process.kill)
    live = {}

    def noted():
        for frame in stream:
            if frame["type"] != "health":  # As GET /v1/status, which the description has.
                for place, kinds in paths(frame).items():
                    known = live.setdefault(frame["type"], {}).setdefault(place, [])
                    known += [kind for kind in kinds if kind not in known]
            yield frame

    frames = noted()
    begin(daemon, frames)
    wait_for(frames, lambda frame: frame["type"] == "cycle")
    daemon.ask("POST", "/v1/stop", {})  # Unless it has ended meanwhile.
    wait_for(frames, lambda frame: frame["type"] == "test-ended")
    asked = {"openapi": without_words(daemon.ask("GET", "/v1/openapi.json")[1]), "live": live, "metrics": metrics(daemon.ask("GET", "/metrics")[1])}
    daemon.end()
    before = {file.stem for file in (*state.rglob("*.h5"), *made)}
    waiting = [json.loads(file.read_text(encoding="utf-8")) for file in (daemon.folder / "outbox").glob("*.json")]
    answers["outbox"] = sorted(result["entry_identifier_uuid"] for result in waiting if pathlib.Path(result["file"]).stem in before)
    answers["verify"] = {file.name: run(build / "bin" / "stickslip", "verify", file).returncode for file in made}
    return answers, made, asked

#!/usr/bin/env python3
"""Every figure that the pages quote in short, measured now, beside what they say: `./dev bench --table`.

    tools/bench_table.py BENCH_BUILD RELEASE_BUILD DOCS

Runs the demo, its scenes, the random tests, the benchmarks and the daemon, some twenty minutes in all; writes
BENCH_BUILD/table.md and prints it. What takes hours to measure (the paper's promise, kills) is compared with the document
that holds its whole table. Exit status 1 if a figure is not on its page, or off by more than its kind may be: a
count is the same; accuracy is computed and the same everywhere but for the last digit, of which the pages give one or two;
ratios were measured side by side; times and shares are those of the machine.
"""

import dataclasses
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

FACTORS = {"count": 1.0, "accuracy": 1.2, "ratio": 1.5, "time": 2.0}
#: Where the figures stand, below DOCS: a page and the heading of a section, or None for what stands before the first one.
QUOTED = (("simulate.md", "The demo"), ("detector-limits.md", "In short"), ("speed.md", "In short"), ("reliability.md", None), ("README.md", "Analyse"))
# As the pages write them.
UNITS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0, "million": 1e6, "MB": 1e6, "%": 1.0, "×": 1.0, "": 1.0}


@dataclasses.dataclass
class Figure:
    what: str
    kind: str
    value: float
    said: str  # What its page says around it: one group for the number, one for its unit if it has one.
    value_said: float | None = None  # Where that is no number of its own.


def benchmarks(program, pattern):
    """{name: row} of a Google Benchmark program."""
    done = subprocess.run([program, f"--benchmark_filter={pattern}", "--benchmark_format=json"], capture_output=True, text=True, check=True)
    return {re.sub(r"/(iterations:1|manual_time|process_time)", "", row["name"]): row for row in json.loads(done.stdout)["benchmarks"]}


def row(first, *cells):
    """The pattern of a row of a table: `cells` after the cell that begins with `first`."""
    return r"\| " + re.escape(first) + r"[^|]*\|" + "".join(cells)


def printed(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=True, **options).stdout


def quoted(docs):
    """The text of the sections that quote figures."""
    texts = []
    for page, heading in QUOTED:
        sections = re.split(r"^## ", (docs / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
        texts += [text for text in sections[1:] if text.startswith(f"{heading}\n")] if heading else sections[:1]
    assert len(texts) == len(QUOTED), "a section that quotes figures is not there"
    return "\n".join(texts)


def demo(release, text):
    """The rows of its table that docs/simulate.md shows, to hold as they are."""
    with tempfile.TemporaryDirectory(prefix="stickslip-table-") as folder:
        rows = [line.split() for line in printed(release / "bin/stickslip", "demo", "--folder", folder).splitlines()]
    shown = [line.split() for line in text.splitlines() if re.match(r"^ +(\d+  [a-z-]+ |truth  |± s\w+\. )", line)]
    found = sum(any(row[:len(line)] == line for row in rows) for line in shown)
    yield Figure("rows of the demo's table that are shown", "count", found, r"()()", value_said=len(shown))


def held(release):
    """Counts that tests demand; a test that fails ends the table."""
    for program in ("scenario_demo_scenes", "scenario_measured_traces"):
        printed(release / "tests/scenario" / program)
    traces = (pathlib.Path(__file__).parents[1] / "tests/scenario/measured_traces_test.cpp").read_text(encoding="utf-8")
    scenes = (pathlib.Path(__file__).parents[1] / "tests/scenario/demo_scenes_test.cpp").read_text(encoding="utf-8")
    yield Figure("tests of each scene with the right regime", "count", int(re.search(r"kRepeats = (\d+)", scenes)[1]), r"(\d+)() of 300")
    for cycles, said in ((131, r"(\d+)() cycles where 131 are"), (39, r"(\d+)() slips where 39 are")):
        assert re.search(rf"\b{cycles}\b", traces), f"no test of {cycles}"
        yield Figure(f"the trace of {cycles}", "count", cycles, said)
    yield Figure("shipped scenes", "count", len(printed(release / "bin/stickslip", "scenes", "--json").split('"name"')) - 1, r"each of the (\d+)() shipped")


def limits(release):
    rows = re.findall(r"^([\w-]+|with one to three captures) +(\d+) +([\d.]+) % +([\d.]+) %$",
                      printed(release / "bench/regime_limits", "10000", "1").split("\nnoise ")[1], re.MULTILINE)
    classes = [(int(tests), float(wrong), float(undecided)) for name, tests, wrong, undecided in rows if not name.startswith("with")]
    total = sum(tests for tests, _, _ in classes)
    wrong, undecided = (sum(row[0] * row[i] for row in classes) / total for i in (1, 2))
    yield Figure("random tests of the right regime", "accuracy", 100 - wrong - undecided, r"right regime in ([\d.]+) (%)")
    yield Figure("of a wrong one", "accuracy", wrong, r"a wrong one in ([\d.]+) (%)")
    ratios = [float(ratio) for ratio in re.findall(r"^\S.*? +(?:S - K|K|omega|gamma)\S* +[\d.]+ +([\d.]+) ", printed(release / "bench/estimator_limits", "4000"), re.MULTILINE)]
    assert len(ratios) >= 16, "the table of estimator_limits has changed"
    yield Figure("rms error over the statistical limit, less 1", "accuracy", 100 * (max(ratios) - 1), r"γ come within ([\d.]+) (%)")


def documents():
    docs = pathlib.Path(__file__).parents[1] / "docs"
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in (docs / "promise.md").read_text(encoding="utf-8").splitlines() if re.match(r"\| \d+ \| 0\.\d", line)]
    factors = sorted(float(row[7].split()[0]) for row in cells if row[0] == "190" and float(row[1]) <= 0.3 and float(row[3]) >= 0.01)
    yield Figure("conditions of the promise", "count", len(cells), r"all (\d+)() conditions")
    yield Figure("the least factor", "accuracy", factors[0], r"it is (\d+)() to \d+, median")
    yield Figure("the largest", "accuracy", factors[-1], r"it is \d+ to (\d+)(), median")
    yield Figure("the median", "accuracy", statistics.median(factors), r"to \d+, median (\d+)()")
    reliability = (docs / "reliability-evidence.md").read_text(encoding="utf-8")
    yield Figure("kills", "count", int(re.search(r"\./dev torture (\d+) --seed", reliability)[1]), r"(\d+)() kills")
    yield Figure("states of a disk after a power cut", "count", sum(int(states) for states in re.findall(r"^\|.* states each.* \| (\d+) \| 0 \|$", reliability, re.MULTILINE)), r"(\d+)() states")


def accuracy(release):
    done = subprocess.run([release / "tests/scenario/scenario_demo_scenes"], capture_output=True, text=True, check=True)
    variances = [float(variance) for variance in re.findall(r"variance ([\d.]+)$", done.stdout, re.MULTILINE)]
    yield Figure("least variance of normalised errors", "accuracy", min(variances), r"variance of ([\d.]+)() to")
    yield Figure("largest", "accuracy", max(variances), r"variance of [\d.]+ to ([\d.]+)()\.")
    errors = {}
    for name, value in re.findall(r"^(\w+) +true .* rms error ([\d.e-]+) ", done.stdout, re.MULTILINE):
        errors.setdefault(name, []).append(float(value))
    for name, label in (("delta_mu", "S − K"), ("mu_k", "K"), ("gamma_over_2omega", "γ/2ω")):
        stick_slip, ring_down = errors[name]
        yield Figure(f"rms error of {label}, ring-down", "accuracy", ring_down, rf"\| {label}[^|]*\| ([\d.]+)() \|")
        yield Figure(f"rms error of {label}, stick-slip", "accuracy", stick_slip, rf"\| {label}[^|]*\|[^|]*\| ([\d.]+)() \|")


def simulator(bench):
    rows = benchmarks(bench / "bench_simulator", "exact_solver$|exact_solver_with|bench_hour|cvode|odeint")
    exact, solved = (1 / rows[name]["items_per_second"] for name in ("exact_solver", "exact_solver_with_each_slip_solved"))
    cvode, odeint = (rows[name] for name in ("cvode_at_error_1e_9", "peer_odeint_dopri5_at_error_1e_9"))
    time, ratio, skip = r" ([\d.]+) (ns|µs|ms)[^|]*\|", r" ([\d.]+) (×) \|", r"[^|]*\|"
    yield Figure("one simulated scan", "time", exact, row("one simulated scan", time))
    yield Figure("its peer, CVODE", "time", 1 / cvode["items_per_second"], row("one simulated scan", skip, time))
    yield Figure("CVODE over exact", "ratio", cvode["times_exact"], row("one simulated scan", skip, skip, ratio))
    yield Figure("a scan where no slip repeats", "time", solved, row("the same where no slip", time))
    yield Figure("CVODE over that", "ratio", 1 / cvode["items_per_second"] / solved, row("the same where no slip", skip, skip, ratio))
    yield Figure("its peer, odeint", "time", 1 / odeint["items_per_second"], row("the same", skip, r" ([\d.]+) (ns|µs|ms), Boost[^|]*\|"))
    yield Figure("odeint over exact", "ratio", odeint["times_exact"], row("the same", skip, r"[^|]*Boost[^|]*\|", ratio))
    yield Figure("one bench hour", "time", 1e-3 * rows["bench_hour"]["cpu_time"], row("one bench hour", time))


def others(bench):
    time, ratio, skip = r" ([\d.]+) (ns|µs|ms)[^|]*\|", r" ([\d.]+) (×) \|", r"[^|]*\|"
    ring = benchmarks(bench / "bench_ring", ".")
    here, peer = (1e-9 * ring[name]["cpu_time"] for name in ("ring_hand_over", "peer_mutex_deque_hand_over"))
    yield Figure("hand-over of 64 scans", "time", here, row("hand-over", time))
    yield Figure("its peer", "time", peer, row("hand-over", skip, time))
    yield Figure("peer over here", "ratio", peer / here, row("hand-over", skip, skip, ratio))
    detector = benchmarks(bench / "bench_detector", "^follow/(turning-points|fit)/350/1000|^peer_scipy_chain_live/350")
    for first, here, peer in (("live detector", "follow/turning-points/350/1000", "peer_scipy_chain_live/350"),
                              ("the same, `fit`", "follow/fit/350/1000", "peer_scipy_chain_live/350")):
        here, peer = (detector[name]["per_scan"] for name in (here, peer))
        yield Figure(f"{first}, a scan", "time", here, row(first, time))
        yield Figure("its peer, SciPy", "time", peer, row(first, skip, time))
        yield Figure("SciPy over here", "ratio", peer / here, row(first, skip, skip, ratio))
    analysis = benchmarks(bench / "bench_analysis", "whole_test_fit")["analysis_with_whole_test_fit"]
    yield Figure("all results of a test", "time", 1e-9 * analysis["cpu_time"], row("all results", time))
    pipeline = benchmarks(bench / "bench_pipeline", "^sustained/turning-points")
    for rate_Hz, said in ((10_000, row("the whole pipeline", r" ([\d.]+) (million); ")), (350, row("the whole pipeline", r"[^|]*; ([\d.]+) (million) \|"))):
        yield Figure(f"scans a second at {rate_Hz} Hz", "time", pipeline[f"sustained/turning-points/{rate_Hz}"]["all_scans_per_s"], said)


def daemon(release):
    done = subprocess.run([sys.executable, pathlib.Path(__file__).parents[1] / "bench/daemon_load.py", release, "30"],
                          capture_output=True, text=True, check=True)
    yield Figure("processor of the daemon", "time", float(re.search(r"processor +([\d.]+) %", done.stdout)[1]), r"takes ([\d.]+) (%) of a processor")
    yield Figure("memory of the daemon", "time", 1e6 * float(re.search(r"memory +([\d.]+) MB", done.stdout)[1]), r"of a processor and ([\d.]+) (MB)")


def main(bench, release, docs):
    bench, release = pathlib.Path(bench).resolve(), pathlib.Path(release).resolve()
    text = quoted(pathlib.Path(docs))
    lines, wrong = ["| figure | measured | said | of it | |", "|---|---|---|---|---|"], 0
    for part in (demo(release, text), held(release), documents(), accuracy(release), simulator(bench / "bench"),
                 others(bench / "bench"), daemon(release), limits(bench)):
        for figure in part:
            found = re.search(figure.said, text)
            said = figure.value_said or (float(found[1]) * UNITS[found[2]] if found else None)
            quotient = figure.value / said if said else float("nan")
            good = 1 / FACTORS[figure.kind] <= quotient <= FACTORS[figure.kind]
            wrong += not good
            lines.append(f"| {figure.what} | {figure.value:.3g} | {'not there' if said is None else f'{said:.3g}'} | {quotient:.2f} | "
                         f"{'' if good else 'WRONG'} |")
            print(lines[-1], file=sys.stderr, flush=True)
    (bench / "table.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    print(f"{len(lines) - 2} figures, {wrong} of them not as the pages say; {bench / 'table.md'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

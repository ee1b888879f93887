"""Judges records twice: `stickslip verify` reads every byte, and h5py looks as somebody would who knows
docs/record-file.md alone. What both say must agree.
"""

import dataclasses
import json
import pathlib
import subprocess

import h5py
import numpy

import support

VERIFY_TIMEOUT_S = 120


@dataclasses.dataclass
class Gap:
    first: int
    count: int
    estimated: bool
    cause: str


@dataclasses.dataclass
class Judged:
    path: pathlib.Path
    scan: numpy.ndarray
    counts: numpy.ndarray
    gaps: list
    results: dict       # name -> float or text
    findings: list      # texts
    events: list        # texts
    anchors: tuple      # scan, monotonic (ns)
    granted_Hz: float
    measured_Hz: float  # by the anchors
    cycles: dict
    status: str         # of the record: complete, interrupted, recovered, incomplete
    reasons: list
    end_cause: str      # empty where nobody lived to say it


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def gaps_of(entry):
    group = entry["gaps"]
    return [Gap(int(first), int(count), bool(estimated), text(cause)) for first, count, estimated, cause in
            zip(group["first_scan"][()], group["scan_count"][()], group["estimated"][()], group["cause"][()])]


def check_jumps(scan, gaps):
    """Indices rise by one except over the gaps that the record names, and each gap is a jump."""
    steps = numpy.diff(scan)
    assert (steps >= 1).all(), "scan indices that do not rise"
    jumps = [(int(scan[at]) + 1, int(steps[at]) - 1) for at in numpy.flatnonzero(steps > 1)]
    assert jumps == [(gap.first, gap.count) for gap in gaps], (jumps, gaps)


def rate_by(scan, monotonic_ns):
    """Least squares; nan where two anchors are not enough."""
    if len(scan) < 3:
        return float("nan")
    seconds = (monotonic_ns - monotonic_ns[0]) * 1e-9
    return float(numpy.polyfit(seconds - seconds.mean(), scan - scan.mean(), 1)[0])


def played_from(codes, counts):
    """Which of the codes played was the first of these counts, all others following in order."""
    head = numpy.lib.stride_tricks.sliding_window_view(codes, min(64, len(counts)))
    [at] = numpy.flatnonzero((head == counts[:head.shape[1]]).all(axis=1))
    numpy.testing.assert_array_equal(codes[at:at + len(counts)], counts)
    return int(at)


def verify(judged):
    """The product's own verdict: whole, or incomplete for the reasons that the record gives and no other."""
    done = subprocess.run([support.CLI, "verify", "--json", judged.path], capture_output=True, text=True,
                          timeout=VERIFY_TIMEOUT_S, check=False)
    assert done.stdout, done.stderr
    [verdict] = json.loads(done.stdout)["files"]
    expected = ["process/status"] * (judged.status != "complete") + ["gaps"] * len(judged.gaps)
    found = [finding for finding in verdict["findings"] if finding["weight"] != "note"]
    assert sorted(finding["place"] for finding in found) == sorted(expected), verdict
    assert verdict["judgement"] == ("incomplete" if expected else "complete"), verdict
    assert done.returncode == (1 if expected else 0), done.returncode
    for finding in found:
        if finding["place"] == "process/status":
            assert finding["text"].startswith(judged.status), finding
            assert all(reason in finding["text"] for reason in judged.reasons), finding


def judge(path):
    """Reads a record and checks that it agrees with itself and with `stickslip verify`. Raises AssertionError."""
    with h5py.File(path) as file:
        assert text(file.attrs["format"]) == "stickslip-record"
        entry = file["entry"]
        scan = entry["raw/scan"][()]
        counts = entry["raw/counts"][()]
        assert len(scan) == len(counts) > 0
        gaps = gaps_of(entry)
        check_jumps(scan, gaps)
        results = {}
        for name, data in entry["results"].items():
            if isinstance(data, h5py.Dataset) and data.shape == ():
                results[name] = text(data[()])
        assert int(results["gap_count"]) == len(gaps), results["gap_count"]
        anchors = entry["timing/scan"][()], entry["timing/monotonic_raw"][()]
        findings = [text(finding) for finding in entry["results/findings"][()]]
        judged = Judged(path, scan, counts, gaps, results, findings,
                      [text(event) for event in entry["events/text"][()]], anchors,
                      float(entry["timing/scan_rate_granted"][()]), rate_by(*anchors),
                      {name: data[()] for name, data in entry["cycles"].items()},
                      text(entry["process/status"][()]), [text(why) for why in entry["process/reasons"][()]],
                      text(entry["process/end_cause"][()]) if "process/end_cause" in entry else "")
    verify(judged)
    return judged

#!/usr/bin/env python3
"""What an instrument that is not ideal does to S - K: `./dev evidence instrument`.

    instruments.py BUILD_DIR [TESTS [SEED]]       # of a row; prints the table

Each row is a property of real testers that stickslip's model does not have. A sled of sled.py is read through it, imported and analysed as
anybody's trace is: without a characterised tester, with the speed of the belt.
"""

import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

from sled import Setup, import_options, simulate_to

RING_DOWN = {"S": 0.325}  # Q 2.6 where the threshold is 1.94.
EIGHTH_OF_A_STEP = 1.1 * Setup.full_scale / 2**8 / 8

ROWS = {
    "ideal": {},
    "ideal, ring-down": RING_DOWN,
    "load cell of 200 Hz, damping 0.05": {"cell": 200.0},
    "load cell of 120 Hz": {"cell": 120.0},
    "load cell of 80 Hz": {"cell": 80.0},
    "load cell of 60 Hz, 6 in/min": {"cell": 60.0, "speed": 6.0},
    "Butterworth 4 at 60 Hz": {"filter": 60.0},
    "Butterworth 4 at 50 Hz, 2 kHz": {"filter": 50.0, "rate": 2000.0},
    "F = c (1 + 0.05 c)": {"beta": 0.05},
    "F = c (1 + 0.1 c)": {"beta": 0.1},
    "F = c (1 + 0.3 c)": {"beta": 0.3},
    "speed +- 10 % at 2 Hz": {"modulation": 0.1, "modulation_frequency": 2.0},
    "speed +- 5 % at 5 Hz": {"modulation": 0.05, "modulation_frequency": 5.0},
    "8 bits, noise of 1/8 step": {"bits": 8, "noise": EIGHTH_OF_A_STEP},
    "creep to 0.05 v, ring-down": {"creep": 0.05, "creep_scale": 0.001, **RING_DOWN},
    "creep to 0.3 v, ring-down": {"creep": 0.3, "creep_scale": 0.001, **RING_DOWN},
}


TRANSDUCERS = [row for row, settings in ROWS.items() if "cell" in settings or "filter" in settings]


@dataclasses.dataclass
class Number:
    """A result, its truth and its errors; no value where the program gives none."""

    truth: float
    value: float | None
    standard_error: float
    systematic: float

    def z(self, systematic=True):
        error = math.hypot(self.standard_error, self.systematic if systematic else 0.0)
        return math.nan if self.value is None or error == 0.0 else (self.value - self.truth) / error

    def bias(self):
        return math.nan if self.value is None else self.value / self.truth - 1.0


@dataclasses.dataclass
class Outcome:
    regime: str
    expected_regime: str
    numbers: dict
    findings: list  # Codes of warnings and faults.
    swing: float  # Frequency at which the misfit swings, Hz; NaN where none is told
    omega_systematic: float  # 1/s

    def honest(self, errors=2.0):
        """Is S - K within so many errors, absent, or spoken against?"""
        return bool(self.findings) or self.numbers["delta_mu"].value is None or abs(self.numbers["delta_mu"].z()) <= errors


def told(program, *words):
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def transducer_options(setup):
    """What the maker of cell and filter states."""
    cell = ["--load-cell-frequency", f"{setup.cell} Hz", "--load-cell-damping", f"{setup.cell_damping}"] if setup.cell else []
    return cell + (["--anti-alias", f"{setup.filter} Hz", "--anti-alias-order", f"{setup.order}"] if setup.filter else [])


def outcome(program, setup, known=False):
    """With `known` the program is told the transducer."""
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        table, record = pathlib.Path(folder) / "pull.csv", pathlib.Path(folder) / "pull.h5"
        slips = simulate_to(table, setup)
        told(program, "import", table, *import_options(setup), *(transducer_options(setup) if known else []), "-o", record)
        test = json.loads(told(program, "analyze", "--json", record))["tests"][0]

    def number(name, truth):
        found = test["details"][name]
        return Number(truth, found["value"], found.get("standard_error") or 0.0, found.get("systematic_uncertainty") or 0.0)

    numbers = {"mu_s": number("mu_s", setup.S), "mu_k": number("mu_k", setup.K), "delta_mu": number("delta_mu", setup.S - setup.K)}
    findings = [finding["code"] for finding in test["coded_findings"] if finding["severity"] != "note"]
    told_numbers = {one["name"]: one["value"] for finding in test["coded_findings"] for one in finding["numbers"]}
    return Outcome(test["regime"], "ring-down" if slips == 1 else "stick-slip", numbers, findings, told_numbers.get("swing_frequency", math.nan),
                   test["details"]["omega"].get("systematic_uncertainty") or 0.0)


def outcomes(program, row, tests, seed, known=False):
    """Seeds from this one on. The programs run beside each other."""
    setups = [Setup(seed=seed + test, **ROWS[row]) for test in range(tests)]
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(outcome, [program] * tests, setups, [known] * tests))


def rms(values):
    known = [value for value in values if math.isfinite(value)]
    return math.sqrt(statistics.fmean(value * value for value in known)) if known else math.nan


def table_row(name, found):
    delta, kinetic = ([one.numbers[which] for one in found] for which in ("delta_mu", "mu_k"))
    biases = [100.0 * number.bias() for number in delta if number.value is not None]
    share = lambda count: 100.0 * count / len(found)
    return (f"{name:34} {statistics.fmean(biases) if biases else math.nan:8.2f} {rms(n.z() for n in delta):7.2f} {rms(n.z(False) for n in delta):7.1f} "
            f"{share(sum(abs(n.z()) <= 2.0 for n in delta)):7.0f} {share(sum(bool(one.findings) for one in found)):8.0f} "
            f"{share(sum(not one.honest() for one in found)):8.0f} {share(sum(one.regime != one.expected_regime for one in found)):7.0f} "
            f"{statistics.fmean(100.0 * n.bias() for n in kinetic):7.2f} {rms(n.z() for n in kinetic):6.1f}  "
            + ", ".join(sorted({code for one in found for code in one.findings})))


def main():
    build = pathlib.Path(sys.argv[1])
    tests, seed = (int(word) for word in [*sys.argv[2:4], *["60", "1"][len(sys.argv) - 2:]])
    base = Setup()
    print(f"{tests} tests a row, seeds from {seed} on; S {base.S}, K {base.K} (ring-down: S {RING_DOWN['S']}), {base.frequency:g} Hz, gamma/2omega {base.damping}, "
          f"{base.speed:g} in/min, {base.rate:g} Hz, {base.pull:g} s, noise {base.noise}\n"
          "bias: of the mean, %; z: error over statistical and systematic errors together, and over the statistical alone, rms; shares in %\n\n"
          f"{'':34} {'S - K:':>8} {'rms':>7} {'rms z,':>7} {'within':>7} {'':>8} {'neither':>8} {'regime':>7} {'K:':>7} {'rms':>6}\n"
          f"{'instrument':34} {'bias':>8} {'z':>7} {'stat.':>7} {'2':>7} {'flagged':>8} {'of both':>8} {'wrong':>7} {'bias':>7} {'z':>6}  findings")
    for row in ROWS:
        print(table_row(row, outcomes(build / "bin" / "stickslip", row, tests, seed)), flush=True)
    print("\nthe program is told cell and filter:")
    for row in TRANSDUCERS:
        print(table_row(row, outcomes(build / "bin" / "stickslip", row, tests, seed, known=True)), flush=True)


if __name__ == "__main__":
    main()

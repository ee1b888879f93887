#!/usr/bin/env python3
"""What each rung of the ladder costs and gives: `./dev evidence rungs`.

    rungs.py BUILD_DIR [TESTS [SEED [PICTURE.svg]]]   # of a row; prints the tables, and draws the first

The pulls are those of sled.py, which shares nothing with stickslip; the measured traces lie in data/ of the folder "shared" beside the
project, and are left out where they are absent.
"""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor

from instruments import RING_DOWN, Number, rms, told
from sled import Setup, import_options, simulate_to

ROWS = {
    "12 in/min": {},
    "6 in/min": {"speed": 6.0},
    "6 in/min, S - K 0.01": {"speed": 6.0, "S": 0.31},
    "6 in/min, noise 0.005": {"speed": 6.0, "noise": 0.005},
    "6 in/min, slope -0.1 s/m": {"speed": 6.0, "slope": -0.1},
}
# Name, options of `analyze`; {tester} is a file of five ring-downs.
RUNGS = {
    "turning-points": ["--estimator", "turning-points"],
    "two-parameter-law": ["--estimator", "fit", "--tester", "{tester}"],
    "law-with-slope": ["--estimator", "fit"],
}
MEASURED = pathlib.Path(__file__).resolve().parents[3] / "shared/data"
RING_DOWNS = 5


def record_of(program, folder, setup, name):
    table, record = pathlib.Path(folder) / f"{name}.csv", pathlib.Path(folder) / f"{name}.h5"
    simulate_to(table, setup)
    told(program, "import", table, *import_options(setup), "-o", record)
    return record


def analysed(program, record, options):
    return json.loads(told(program, "analyze", "--json", record, *options))["tests"][0]


def difference(test, truth=math.nan):
    found = test["details"]["delta_mu"]
    return Number(truth, found["value"], found.get("standard_error") or 0.0, found.get("systematic_uncertainty") or 0.0)


def trial(program, setup, tester):
    """For each rung: its number, and whether the result names it."""
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        record = record_of(program, folder, setup, "pull")
        tests = {rung: analysed(program, record, [word.format(tester=tester) for word in options]) for rung, options in RUNGS.items()}
    return {rung: (difference(test, setup.S - setup.K), test["rung"] == rung) for rung, test in tests.items()}


def draw(found, picture):
    """Errors and honesty of each rung, by gnuplot. `found`: row -> rung -> (rms error in %, rms of z by the statistical error)."""
    lines = "\n".join(f'"{row}" ' + " ".join(f"{error:g} {z:g}" for error, z in rungs.values()) for row, rungs in found.items())
    panel = lambda first: ", ".join(f"$found using {first + 2 * i}:xtic(1) title '{rung}'" for i, rung in enumerate(RUNGS))
    script = f"""set terminal svg size 900,700 font 'sans,13'
set output '{picture}'
$found << EOD
{lines}
EOD
set multiplot layout 2,1
set style data histogram
set style fill solid 0.7
set logscale y
set grid y
set xtics font ',11'
set key top left
set ylabel 'S - K: rms error, %'
plot [][0.03:100] {panel(2)}
unset key
set ylabel 'rms error over standard error'
plot [][0.3:100] {panel(3)}, 1 with lines lc rgb 'black'
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def simulated(program, tests, seed, tester):
    found = {}
    print(f"{'S - K of a pull':30} {'rung':18} {'rms error,':>10} {'rms z,':>7} {'rms z,':>7} {'within 2':>9} {'named,':>7}\n"
          f"{'':30} {'':18} {'%':>10} {'stat.':>7} {'both':>7} {'of both':>9} {'%':>7}")
    for row, settings in ROWS.items():
        with ProcessPoolExecutor(os.cpu_count()) as pool:
            trials = list(pool.map(trial, [program] * tests, [Setup(seed=seed + i, **settings) for i in range(tests)], [tester] * tests))
        found[row] = {}
        for rung in RUNGS:
            numbers = [one[rung][0] for one in trials]
            found[row][rung] = (100 * rms(n.bias() for n in numbers), rms(n.z(False) for n in numbers))
            print(f"{row:30} {rung:18} {100 * rms(n.bias() for n in numbers):10.2f} {rms(n.z(False) for n in numbers):7.2f} "
                  f"{rms(n.z() for n in numbers):7.2f} {100 * sum(abs(n.z()) <= 2 for n in numbers) / tests:9.0f} "
                  f"{100 * sum(one[rung][1] for one in trials) / tests:7.0f}", flush=True)
    return found


def cost(program, folder, tester):
    record = pathlib.Path(folder) / "hour.h5"
    told(program, "simulate", "stick-slip-at-12-in-per-min", "--duration", "1 h", "-o", record)
    print(f"\n{'analysis of an hour':30} {'s':>6}   slips")
    for rung, options in RUNGS.items():
        times = []
        for _ in range(3):
            begin = time.perf_counter()
            test = analysed(program, record, [word.format(tester=tester) for word in options])
            times.append(time.perf_counter() - begin)
        print(f"{rung:30} {min(times):6.2f}   {test['cycle_count']}", flush=True)


def measured(program, folder):
    print(f"\n{'measured trace':30} {'estimator':18} {'S - K':>8} {'stat.':>8} {'syst.':>8}   rung")
    for trace in sorted(MEASURED.glob("*.csv")):
        speed = trace.stem.rsplit("_v", 1)[1]
        record = pathlib.Path(folder) / f"{trace.stem}.h5"
        told(program, "import", trace, "--column", "F_over_mg", "--unit", "coefficient", "--sled-mass", "30.7 g", "--speed", f"{speed}e-6 m/s", "-o", record)
        for estimator in ("turning-points", "fit"):
            test = analysed(program, record, ["--estimator", estimator])
            number = difference(test)
            if number.value is None:
                print(f"{trace.stem:30} {estimator:18} {'-':>8} {'':>8} {'':>8}   {test['details']['delta_mu']['reason']}")
            else:
                print(f"{trace.stem:30} {estimator:18} {number.value:8.4f} {number.standard_error:8.4f} {number.systematic:8.4f}   {test['rung']}", flush=True)


def main():
    program = pathlib.Path(sys.argv[1]) / "bin" / "stickslip"
    tests, seed = (int(word) for word in [*sys.argv[2:4], *["60", "1"][len(sys.argv) - 2:]])
    base = Setup()
    print(f"{tests} tests a row, seeds from {seed} on; S {base.S}, K {base.K}, {base.frequency:g} Hz, gamma/2omega {base.damping}, {base.rate:g} Hz, {base.pull:g} s, "
          f"noise {base.noise}; tester: {RING_DOWNS} ring-downs\nz: error over the statistical error, and over statistical and systematic error together\n")
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        ring_downs = [record_of(program, folder, Setup(seed=10_000 + i, **RING_DOWN), f"ring-down-{i}") for i in range(RING_DOWNS)]
        tester = pathlib.Path(folder) / "tester.toml"
        told(program, "characterise", *ring_downs, "-o", tester)
        found = simulated(program, tests, seed, tester)
        if len(sys.argv) > 4:
            draw(found, sys.argv[4])
        cost(program, folder, tester)
        measured(program, folder)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Figs. 1 to 4 of A. P. Penner, Stick-slip behavior of paper during friction testing (1995), from records.

figures.py FOLDER OUTPUT: records made by make_records.sh; OUTPUT/figure-1.svg … figure-4.svg are written.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.fonttype"] = "none"  # Text as text: a third of the size.
matplotlib.rcParams["svg.hashsalt"] = "stickslip"  # Equal records, equal files.

import h5py
import matplotlib.pyplot as plt
import numpy as np

PAPERS = {"thorold": "Thorold", "baie-comeau": "Baie Comeau"}
SPEEDS = (3, 6, 12)  # in/min
SIZE = (6.4, 4.2)


def records(folder, paper, speed):
    return [h5py.File(path) for path in sorted(folder.glob(f"{paper}-{speed}-*.h5"))]


def coefficient(record):
    """Time in s and force over the sled's weight."""
    tester = record["entry/instrument/tester"]
    weight = tester["sled_mass"][()] * tester["gravity"][()]
    return record["entry/raw/time"][:], record["entry/raw/force"][:] / weight


def stiffness(record):
    """Of the coupling, N/m: m (omega^2 + (gamma/2)^2), as the scene has it."""
    omega, damping = record["entry/truth/omega"][()], record["entry/truth/gamma_over_2omega"][()]
    return record["entry/instrument/tester/sled_mass"][()] * omega**2 * (1 + damping**2)


def save(figure, output, number, title):
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(output / f"figure-{number}.svg", metadata={"Date": None})
    plt.close(figure)


def figure_1(folder, output):
    """Static and kinetic coefficient of the tradition against the sled's speed."""
    figure, axes = plt.subplots(figsize=SIZE)
    for paper, marker in zip(PAPERS, "os"):
        for name, style in (("static_coefficient", "-"), ("kinetic_coefficient", "--")):
            values = [[record[f"entry/results/{name}"][()] for record in records(folder, paper, speed)]
                      for speed in SPEEDS]
            axes.errorbar(SPEEDS, [np.mean(some) for some in values], [np.std(some) for some in values],
                          marker=marker, linestyle=style, capsize=3,
                          label=f"{PAPERS[paper]}, {name.split('_', maxsplit=1)[0]}")
    axes.set(xlabel="sled speed (in/min)", ylabel="coefficient", xlim=(0, 13))
    axes.legend()
    save(figure, output, 1, "Fig. 1: coefficient of friction against sled speed")


def signals(folder, output, number, paper):
    """The force of three replicates, one above the other."""
    chosen = records(folder, paper, 12)[:3]
    figure, panels = plt.subplots(len(chosen), 1, figsize=SIZE, sharex=True, sharey=True, squeeze=False)
    for axes, record in zip(panels[:, 0], chosen):
        time, values = coefficient(record)
        axes.plot(time, values, linewidth=0.8)
        axes.set_xlim(0.4, 2.0)
    panels[-1, 0].set_xlabel("time (s)")
    panels[len(chosen) // 2, 0].set_ylabel("force over weight")
    save(figure, output, number, f"Fig. {number}: {PAPERS[paper]}, {len(chosen)} samples at 12 in/min")


def figure_4(folder, output):
    """The speed at which the coupling stretches, dF/dt over stiffness: chopped off at the sled's speed."""
    figure, panels = plt.subplots(len(SPEEDS), 1, figsize=SIZE, squeeze=False)
    for axes, speed in zip(panels[:, 0], SPEEDS):
        record = records(folder, "thorold", speed)[0]
        tester = record["entry/instrument/tester"]
        time, force = record["entry/raw/time"][:], record["entry/raw/force"][:].astype(float)
        velocity = np.gradient(force, time) / stiffness(record)
        axes.plot(time, 1000 * velocity, linewidth=0.8)
        axes.axhline(1000 * tester["pull_speed"][()], color="0.5", linestyle=":")
        start = record["entry/cycles/peak_time"][0]
        axes.set(xlim=(start - 0.05, start + 0.35), title=f"{speed} in/min")
    panels[-1, 0].set_xlabel("time (s)")
    panels[1, 0].set_ylabel("speed of the coupling (mm/s)")
    save(figure, output, 4, "Fig. 4: one Thorold sample at each speed")


def main():
    folder, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    output.mkdir(parents=True, exist_ok=True)
    figure_1(folder, output)
    signals(folder, output, 2, "thorold")
    signals(folder, output, 3, "baie-comeau")
    figure_4(folder, output)


main()

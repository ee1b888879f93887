"""What is done with SciPy where there is no detector: median of five, Savitzky-Golay, find_peaks.

    scipy_chain.py < SCENES.json

A scene is {"scan_rate": Hz, "frequency": Hz of the oscillation, "tests": [[force, ...], ...]}; for each comes back
{"ns_per_scan": the least of many runs over the whole array of the first test at once, "differences": [peak less the mean
from it to the next peak, for each cycle of each test but the first cycle]}. The window is a quarter of an oscillation,
the prominence a quarter of the range.
"""

import json
import sys
import time

import numpy
from scipy.signal import find_peaks, medfilt, savgol_filter

RUNS = 20


def chain(scans, window):
    smooth = savgol_filter(medfilt(scans, 5), window, 3)
    peaks, _ = find_peaks(smooth, prominence=0.25 * (smooth.max() - smooth.min()))
    return smooth, peaks


def least_time_s(scans, window):
    least_s = float("inf")
    for _ in range(RUNS):
        begin_s = time.perf_counter()
        chain(scans, window)
        least_s = min(least_s, time.perf_counter() - begin_s)
    return least_s


def measured(scene):
    window = max(5, int(scene["scan_rate"] / scene["frequency"] / 4) | 1)
    tests = [numpy.array(test) for test in scene["tests"]]
    differences = []
    for scans in tests:
        smooth, peaks = chain(scans, window)
        later = peaks[1:]
        differences += [smooth[peak] - smooth[peak:following].mean() for peak, following in zip(later, later[1:])]
    return {"ns_per_scan": 1e9 * least_time_s(tests[0], window) / len(tests[0]), "differences": differences}


json.dump([measured(scene) for scene in json.load(sys.stdin)], sys.stdout)

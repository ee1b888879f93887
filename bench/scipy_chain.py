"""What is done with SciPy where there is no detector: median of five, Savitzky–Golay, find_peaks.

    scipy_chain.py SCANS.f64 RATE_HZ FREQUENCY_HZ

Prints nanoseconds a scan, the least of many runs over the whole array at once, and the mean of peak less the mean
of the scans from the second to the last peak. The window is a quarter of an oscillation, the prominence a quarter
of the range.
"""

import sys
import time

import numpy
from scipy.signal import find_peaks, medfilt, savgol_filter


def chain(scans, rate_hz, frequency_hz):
    window = max(5, int(rate_hz / frequency_hz / 4) | 1)
    smooth = savgol_filter(medfilt(scans, 5), window, 3)
    peaks, _ = find_peaks(smooth, prominence=0.25 * (smooth.max() - smooth.min()))
    return smooth, peaks


def main():
    scans = numpy.fromfile(sys.argv[1])
    rate_hz, frequency_hz = float(sys.argv[2]), float(sys.argv[3])
    least = float("inf")
    for _ in range(20):
        begin = time.perf_counter()
        smooth, peaks = chain(scans, rate_hz, frequency_hz)
        least = min(least, time.perf_counter() - begin)
    later = peaks[1:]
    difference = smooth[later].mean() - smooth[later[0]:later[-1]].mean() if len(later) > 1 else float("nan")
    print(1e9 * least / len(scans), difference)


main()

"""The slips of a test, each fitted by scipy.optimize.least_squares: MINPACK's Levenberg–Marquardt with the analytic
Jacobian over NumPy arrays, the fastest method that SciPy has for few parameters. No slip is told from an oscillation.

    least_squares_peer.py < {"time_s": [...], "value": [...], "slips": [{"first": 0, "end": 18, "guess": [...]}, ...]}

A guess is onset, S, K, omega, gamma, r; the window of a slip ends where it is captured, or before. Prints the least time
of three for a slip, in s, and the mean of S - K.
"""

import json
import sys
import time

import numpy
from scipy.optimize import least_squares


def course(p, t):
    onset, S, K, omega, gamma, r = p
    tau = t - onset
    slip = tau >= 0.0
    decay = numpy.exp(-0.5 * gamma * tau)
    cosine, sine = decay * numpy.cos(omega * tau), decay * numpy.sin(omega * tau)
    D = S - K
    B = (r + 0.5 * gamma * D) / omega
    swing = D * cosine + B * sine
    by_D = cosine + 0.5 * gamma / omega * sine
    rate = r * cosine - (0.5 * gamma * B + omega * D) * sine
    value = numpy.where(slip, K + swing, S + r * tau)
    by = numpy.stack(
        [
            numpy.where(slip, -rate, -r),
            numpy.where(slip, by_D, 1.0),
            numpy.where(slip, 1.0 - by_D, 0.0),
            numpy.where(slip, tau * (B * cosine - D * sine) - B / omega * sine, 0.0),
            numpy.where(slip, -0.5 * tau * swing + 0.5 * D / omega * sine, 0.0),
            numpy.where(slip, sine / omega, tau),
        ],
        axis=1,
    )
    return value, by


def main():
    test = json.load(sys.stdin)
    t, c = numpy.array(test["time_s"]), numpy.array(test["value"])
    slips = [(t[s["first"] : s["end"]], c[s["first"] : s["end"]], numpy.array(s["guess"])) for s in test["slips"]]
    least_s = float("inf")
    for _ in range(3):
        begin_s = time.perf_counter()
        fits = [
            least_squares(lambda p, ti=ti, ci=ci: course(p, ti)[0] - ci, guess, jac=lambda p, ti=ti: course(p, ti)[1],
                          method="lm", x_scale=numpy.abs(guess) + 1e-3)
            for ti, ci, guess in slips
        ]
        least_s = min(least_s, time.perf_counter() - begin_s)
    json.dump({"slip_s": least_s / len(slips), "delta_mu": float(numpy.mean([f.x[1] - f.x[2] for f in fits]))}, sys.stdout)


main()

#!/usr/bin/env python3
"""How soon can an escape be told from a capture at all? The bound beside bench/live_limits (docs/detector-limits.md).

    python3 bench/escape_bound.py                  # a table by Q/Q_th
    python3 bench/escape_bound.py escapes.csv      # the mean over the escapes that bench/escape_limits listed

The scans of a slip that just escapes, without noise, are fitted by the nearest captured course: [11]-[13] up to
the capture, stick at rate r, a second slip; free are the onset, S - K, K and S - K of the second slip, which is
expected to be log-normal about the first with 0.5545 (core/detect/captured_trajectory). omega, gamma and r are known. With
d^2 the sum of squares left over the noise, the log likelihood ratio of scans with white noise is normal with variance
d^2 and mean d^2/2 if the sled escaped, -d^2/2 if it took that course. By Neyman and Pearson (1933) no rule tells more
escapes than the one that asks for a limit of this ratio; where it takes one in 10^4 of those captured courses for an
escape it tells Phi(d - 3.719) of the escapes. A rule that asks for odds of 10^4, as ours, tells
Phi((d^2/2 - ln 10^4)/d) of them, and errs less often.

With spikes the scans are not Gaussian: each is off, with the chance that a spike falls on it, by a size that is
exponential to both sides. Again no rule beats the likelihood ratio; how many escapes it tells is counted over random
scans, the captured courses taken for an escape by importance sampling from the escapes: their chance is the mean of
exp(-ratio) over the escapes that are told.
"""
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.special import erfcx
from scipy.stats import norm

ERRORS = 1e-4

# The tester of tests/support/live_trials.hpp [Penner 1995, Table 1], 12 in/min.
SCAN_RATE_HZ = 350.0
FREQUENCY_HZ = 20.0
GAMMA_OVER_2OMEGA = 0.022
DELTA_MU = 0.05
Q = 1.309
NOISE = 0.02 * DELTA_MU
LOG_SCATTER = 0.5545
DECISIVE = np.log(1e4)  # As in core/detect/slip_follower.

SPIKES_PER_S = 20.0  # As in tests/support/random_tests.hpp,
SPIKE_SIGMAS = DELTA_MU / NOISE  # and so is their mean size.
SPIKED_TESTS = 40_000
LARGEST_D = norm.isf(ERRORS) - norm.ppf(1.0 / SPIKED_TESTS)  # Beyond it the drawn tests would all be told.
SEED = 1

OMEGA = 2.0 * np.pi * FREQUENCY_HZ
GAMMA = 2.0 * GAMMA_OVER_2OMEGA * OMEGA
STICK_RATE = Q * OMEGA * DELTA_MU
PERIOD_S = 1.0 / FREQUENCY_HZ


def swing(delta_mu, t):
    """c - K from the onset on (11)."""
    b = (STICK_RATE + 0.5 * GAMMA * delta_mu) / OMEGA
    return np.exp(-0.5 * GAMMA * t) * (delta_mu * np.cos(OMEGA * t) + b * np.sin(OMEGA * t))


def rate(delta_mu, t):
    """Its derivative (12)."""
    b = (STICK_RATE + 0.5 * GAMMA * delta_mu) / OMEGA
    return np.exp(-0.5 * GAMMA * t) * (
        (OMEGA * b - 0.5 * GAMMA * delta_mu) * np.cos(OMEGA * t)
        - (OMEGA * delta_mu + 0.5 * GAMMA * b) * np.sin(OMEGA * t)
    )


RISE_S = np.linspace(0.4, 1.0, 100_001) * PERIOD_S


def threshold_delta_mu():
    """Least S - K after which c' gets back to the stick rate (22), by bisection."""
    low, high = 1e-4, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if rate(middle, RISE_S).max() > STICK_RATE:
            high = middle
        else:
            low = middle
    return high


def capture_s(delta_mu):
    left = rate(delta_mu, RISE_S) - STICK_RATE
    return RISE_S[np.argmax(left >= 0.0) if left.max() >= 0.0 else np.argmax(left)]


def captured_course(onset_s, delta_mu, kinetic, next_delta_mu, t):
    tau = t - onset_s
    capture = capture_s(delta_mu)
    at_capture = kinetic + swing(delta_mu, capture)
    next_static = max(kinetic + next_delta_mu, at_capture)
    next_onset = capture + (next_static - at_capture) / STICK_RATE
    return np.select(
        [tau < 0.0, tau <= capture, tau <= next_onset],
        [
            kinetic + delta_mu + STICK_RATE * tau,
            kinetic + swing(delta_mu, tau),
            at_capture + STICK_RATE * (tau - capture),
        ],
        kinetic + swing(next_static - kinetic, tau - next_onset),
    )


def differences(over_threshold, periods, threshold):
    """Over the noise, what the nearest captured course leaves of the scans up to so many periods after the onset, and
    last how unusual its second slip is."""
    truth = threshold / over_threshold
    # From 30 scans of the stick before on; the onset lies a third of a scan after a scan.
    t = (np.arange(-30, int(periods * PERIOD_S * SCAN_RATE_HZ) + 1) + 1.0 / 3.0) / SCAN_RATE_HZ
    t = t[t <= periods * PERIOD_S]
    free = np.where(t < 0.0, truth + STICK_RATE * t, swing(truth, t))

    def residuals(p):
        surprise = np.log(max(p[3] / truth, 1e-6)) / LOG_SCATTER
        return np.append((captured_course(*p, t) - free) / NOISE, surprise)

    fits = [
        least_squares(
            residuals,
            [0.0, part * threshold, 0.0, next_part * threshold],
            bounds=([-0.02, threshold, -1.0, 1e-6], [0.02, 1.0, 1.0, 1.0]),
            x_scale=[1e-4, 1e-3, 1e-3, 1e-2],
            diff_step=1e-5,
        )
        for part in (1.0 + 1e-9, 1.05)
        for next_part in (0.02, 0.1, 0.5, 1.0)
    ]
    return min(fits, key=lambda fit: fit.cost).fun


def distance(over_threshold, periods, threshold):
    """d of the nearest captured course."""
    return np.linalg.norm(differences(over_threshold, periods, threshold))


def told(d):
    """Chance of the best rule that errs once in 10^4."""
    return norm.cdf(d - norm.isf(ERRORS))


def log_density(z):
    """Of a scan that is z off: noise, and perhaps a spike, whose exponential size the noise smears."""
    smeared = sum(erfcx((1.0 / SPIKE_SIGMAS + side * np.clip(z, -20.0, 20.0)) / np.sqrt(2.0)) for side in (-1.0, 1.0))
    spike = np.where(
        np.abs(z) > 20.0,  # Noise is nothing there.
        np.exp(0.5 / SPIKE_SIGMAS**2 - np.abs(z) / SPIKE_SIGMAS) / (2.0 * SPIKE_SIGMAS),
        np.exp(-0.5 * np.minimum(z * z, 400.0)) * smeared / (4.0 * SPIKE_SIGMAS),
    )
    chance = -np.expm1(-SPIKES_PER_S / SCAN_RATE_HZ)
    return np.log((1.0 - chance) * norm.pdf(z) + chance * spike)


def told_with_spikes(left):
    """As told(), of scans with spikes. The last difference is no scan's."""
    random = np.random.default_rng(SEED)
    z = random.standard_normal((SPIKED_TESTS, left.size))
    scans = z[:, :-1]
    scans += (random.random(scans.shape) < -np.expm1(-SPIKES_PER_S / SCAN_RATE_HZ)) * random.laplace(0.0, SPIKE_SIGMAS, scans.shape)
    # The scans are the escape's; off the captured course they are by z - left.
    ratio = (log_density(scans) - log_density(scans - left[:-1])).sum(axis=1)
    ratio += 0.5 * (z[:, -1] - left[-1]) ** 2 - 0.5 * z[:, -1] ** 2
    ratio = np.sort(ratio)[::-1]
    return np.searchsorted(np.cumsum(np.exp(-ratio)) / SPIKED_TESTS, ERRORS) / SPIKED_TESTS


def told_by_odds(d):
    """Chance that the log likelihood ratio of scans at this distance exceeds ln 10^4."""
    return norm.cdf((0.5 * d * d - DECISIVE) / d)


def print_mean(path, threshold):
    """d grows with S - K over the noise; between the points of a table it is interpolated."""
    over, noise = np.loadtxt(path, delimiter=",", unpack=True)
    grid = np.array([1.001, 1.005, 1.01, 1.02, 1.03, 1.05, 1.08, 1.13, 1.2, 1.35, 1.6])
    left = [differences(x, 1.5, threshold) for x in grid]
    d_of_grid = np.array([np.linalg.norm(one) for one in left])
    # What spikes leave of d; told() of that is what they leave to be told.
    at_most = 1.0 - 1.0 / SPIKED_TESTS
    left_of_grid = [(norm.ppf(min(told_with_spikes(one), at_most)) + norm.isf(ERRORS)) / min(d, LARGEST_D) for one, d in zip(left, d_of_grid)]
    d = np.interp(over, grid, d_of_grid) * (NOISE / DELTA_MU) / noise
    with_spikes = told(d * np.interp(d, d_of_grid, left_of_grid))
    print(f"seed {SEED}\n")
    print("| Q/Q_th of the escape | escapes | told within 1.5 periods at best, % | with spikes, % | by odds of 10^4, % |\n|---|---|---|---|---|")
    for low, high in ((1.0, 1.05), (1.05, 1.13), (1.13, 1.35), (1.35, 2.0), (2.0, np.inf), (0.0, np.inf)):
        chosen = (over >= low) & (over < high)
        print(f"| {low} to {high} | {chosen.sum()} | {100.0 * told(d[chosen]).mean():.1f} | {100.0 * with_spikes[chosen].mean():.1f} | {100.0 * told_by_odds(d[chosen]).mean():.1f} |")


def main():
    threshold = threshold_delta_mu()
    if len(sys.argv) > 1:
        print_mean(sys.argv[1], threshold)
        return
    print(f"Q_th {STICK_RATE / OMEGA / threshold:.6f}, noise {NOISE} a scan\n")
    print("| Q/Q_th of the escape | d within 1.5 periods | at best told, % | by odds of 10^4, % | at best within 3 periods, % |\n|---|---|---|---|---|")
    for over in (1.02, 1.05, 1.13, 1.35, 1.55, 2.0):
        row = []
        for periods in (1.5, 3.0):
            d = distance(over, periods, threshold)
            row.append((d, 100.0 * told(d), 100.0 * told_by_odds(d)))
        print(f"| {over} | {row[0][0]:.2f} | {row[0][1]:.1f} | {row[0][2]:.1f} | {row[1][1]:.1f} |", flush=True)


if __name__ == "__main__":
    main()

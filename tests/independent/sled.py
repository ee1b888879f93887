#!/usr/bin/env python3
"""A sled on a spring, simulated apart from core/sim: Runge-Kutta of order 4 in steps of one size, events by bisection, noise of NumPy.

    sled.py pull.csv --seed 1 --cell 80           # a trace for `stickslip import`; prints the command that imports it
    sled.py --help

What is read may pass through a load cell that rings, a filter, a spring that stiffens, a belt that is not even and a converter. SI units;
forces over the sled's weight.
"""

import argparse
import dataclasses
import math
import shlex

import numpy

GRAVITY_M_PER_S2 = 9.80665
M_PER_S_OF_IN_PER_MIN = 0.0254 / 60.0
# Of the motion, at the least: 175 steps a cycle leave 1e-7 of the amplitude.
STEPS_PER_S = 3500
BISECTIONS = 50


@dataclasses.dataclass
class Setup:
    S: float = 0.35
    K: float = 0.30
    frequency: float = 20.0  # Of the damped oscillation, Hz
    damping: float = 0.022  # gamma over 2 omega
    speed: float = 12.0  # in/min
    idle: float = 0.5  # s without load before the belt starts
    pull: float = 4.0  # s
    rate: float = 350.0  # Scans per second
    noise: float = 0.001  # rms of a scan
    slope: float = 0.0  # Of sliding friction by the sled's speed on the belt, s/m
    creep: float = 0.0  # Creep of the contact at F = S over the speed of the belt, 0 ... 1
    creep_scale: float = 0.005  # Force below S over which creep falls by e
    beta: float = 0.0  # F = c (1 + beta c), c being the extension of the spring
    cell: float = 0.0  # Natural frequency of the load cell, Hz; 0: none
    cell_damping: float = 0.05  # Of critical
    filter: float = 0.0  # Butterworth's corner, Hz; 0: none
    order: int = 4  # Butterworth's
    modulation: float = 0.0  # Of the belt's speed: v (1 + modulation sin(2 pi modulation_frequency t))
    modulation_frequency: float = 2.0  # Hz
    bits: int = 0  # Of the converter; 0: none
    full_scale: float = 0.5  # Of the converter, which begins at minus a tenth of it
    seed: int = 1


class Sled:
    """x = k l/(m g) and u = dx/dt over the belt's course. It sticks, or slides slower than the belt: it is never faster here."""

    def __init__(self, setup):
        omega = 2.0 * math.pi * setup.frequency
        self.gamma = 2.0 * omega * setup.damping
        self.omega0_squared = omega**2 + self.gamma**2 / 4.0
        self.setup = setup
        self.rate = self.omega0_squared * setup.speed * M_PER_S_OF_IN_PER_MIN / GRAVITY_M_PER_S2
        self.x, self.u, self.sticks = 0.0, 0.0, False
        self.slips = 0

    def belt(self, t):
        """dx/dt of a sled that sticks to the belt, and its derivative."""
        a, w = self.setup.modulation, 2.0 * math.pi * self.setup.modulation_frequency
        if not a:
            return self.rate, 0.0
        return self.rate * (1.0 + a * math.sin(w * t)), self.rate * a * w * math.cos(w * t)

    def force(self, x):
        return x * (1.0 + self.setup.beta * x)

    def sliding(self, t, x, u):
        """du/dt"""
        friction = self.setup.K
        if self.setup.slope:
            friction += self.setup.slope * max(self.belt(t)[0] - u, 0.0) * GRAVITY_M_PER_S2 / self.omega0_squared
        return self.omega0_squared * (friction - self.force(x)) - self.gamma * u

    def sticking(self, t, x):
        """dx/dt"""
        rate = self.belt(t)[0]
        if self.setup.creep:
            rate *= 1.0 - self.setup.creep * math.exp(min((self.force(x) - self.setup.S) / self.setup.creep_scale, 0.0))
        return rate

    def stepped(self, t, h):
        """(x, u) after h, by the motion at hand whatever happens meanwhile."""
        x, u, half = self.x, self.u, 0.5 * h
        if self.sticks:
            k1 = self.sticking(t, x)
            k2 = self.sticking(t + half, x + half * k1)
            k3 = self.sticking(t + half, x + half * k2)
            k4 = self.sticking(t + h, x + h * k3)
            end = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            return end, self.sticking(t + h, end)
        a1 = self.sliding(t, x, u)
        u2, a2 = u + half * a1, self.sliding(t + half, x + half * u, u + half * a1)
        u3, a3 = u + half * a2, self.sliding(t + half, x + half * u2, u + half * a2)
        u4, a4 = u + h * a3, self.sliding(t + h, x + h * u3, u + h * a3)
        return x + h / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4), u + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)

    def ends(self, t, x, u):
        """Is this past the end of the motion at hand? A sled that sticks is accelerated as the belt is."""
        rate, change = self.belt(t)
        if self.sticks:
            return self.force(x) + change / self.omega0_squared > self.setup.S
        return u > rate

    def advance(self, t, h):
        until = t + h
        while t < until:
            low, high = 0.0, until - t
            x, u = self.stepped(t, high)
            if not self.ends(t + high, x, u):
                self.x, self.u = x, u
                return
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if self.ends(t + middle, *self.stepped(t, middle)) else (middle, high)
            self.x, self.u = self.stepped(t, high)
            t += high
            self.slips += self.sticks
            self.sticks = not self.sticks
            # A slip begins at the belt's speed: no faster by a rounding, or it would end at once.
            self.u = min(self.u, self.belt(t)[0])


def second_order(signal, step_s, frequency, damping):
    """y'' = w^2 (signal - y) - 2 damping w y', exact for a signal that is straight between two samples."""
    w = 2.0 * math.pi * frequency
    # Of (y, y', signal, its slope), by scaling and squaring.
    system = numpy.zeros((4, 4))
    system[0, 1], system[2, 3] = 1.0, 1.0
    system[1] = [-w * w, -2.0 * damping * w, w * w, 0.0]
    small, over = numpy.eye(4), numpy.eye(4)
    for power in range(1, 16):
        over = over @ system * (step_s / 1024.0 / power)
        small = small + over
    for _ in range(10):
        small = small @ small
    (a, b, c, d), (e, f, g, i) = small[0].tolist(), small[1].tolist()
    values = signal.tolist()
    y, rate, out = values[0], 0.0, [values[0]]
    for now, following in zip(values, values[1:]):
        slope = (following - now) / step_s
        y, rate = a * y + b * rate + c * now + d * slope, e * y + f * rate + g * now + i * slope
        out.append(y)
    return numpy.array(out)


def butterworth(signal, step_s, frequency, order):
    """Sections of order two, whose poles lie on a circle. An even order."""
    for section in range(order // 2):
        signal = second_order(signal, step_s, frequency, math.sin((2 * section + 1) * math.pi / (2 * order)))
    return signal


def simulate(setup):
    """(readings, slips): forces over the weight, or codes of the converter; and how often the sled let go."""
    steps = math.ceil(STEPS_PER_S / setup.rate)
    step_s = 1.0 / (steps * setup.rate)
    sled = Sled(setup)
    random = numpy.random.default_rng(setup.seed)
    # Where between two scans the belt starts is drawn.
    idle = round((setup.idle + random.random() / setup.rate) / step_s)
    force = [0.0] * idle
    for step in range(round(setup.pull / step_s)):
        force.append(sled.force(sled.x))
        sled.advance(step * step_s, step_s)
    read = numpy.array(force)
    if setup.cell:
        read = second_order(read, step_s, setup.cell, setup.cell_damping)
    if setup.filter:
        read = butterworth(read, step_s, setup.filter, setup.order)
    read = read[::steps]
    read = read + setup.noise * random.standard_normal(len(read))
    if setup.bits:
        codes = 2**setup.bits
        read = numpy.clip(numpy.floor((read / setup.full_scale + 0.1) / 1.1 * codes), 0, codes - 1)
    return read, sled.slips


def simulate_to(path, setup):
    """Writes a table of one column. Returns how often the sled let go."""
    read, slips = simulate(setup)
    with open(path, "w", encoding="utf-8") as table:
        table.write("counts\n" if setup.bits else "mu\n")
        table.writelines(f"{value:.0f}\n" if setup.bits else f"{value:.9f}\n" for value in read)
    return slips


def import_options(setup):
    words = ["--rate", f"{setup.rate} Hz", "--speed", f"{setup.speed} in/min"]
    if not setup.bits:
        return ["--column", "mu", "--unit", "coefficient", *words]
    # A sled of 1 kg and a cell of its weight a volt.
    codes, volts = 2**setup.bits, 1.1 * setup.full_scale
    return ["--column", "counts", "--unit", "counts", "--count-range", f"0..{codes - 1}", "--volts-per-count", f"{volts / codes} V", "--sled-mass", "1 kg",
            "--load-cell-gain", f"{GRAVITY_M_PER_S2} N/V", "--load-cell-zero", f"{0.1 * setup.full_scale - 0.5 * volts / codes} V", *words]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", metavar="FILE.csv")
    for field in dataclasses.fields(Setup):
        parser.add_argument("--" + field.name.replace("_", "-"), type=field.type, default=field.default, metavar=str(field.default))
    asked = vars(parser.parse_args())
    table = asked.pop("table")
    setup = Setup(**asked)
    if setup.order < 2 or setup.order % 2:
        parser.error(f"--order {setup.order}: takes an even number from 2")
    simulate_to(table, setup)
    print(shlex.join(["stickslip", "import", table, *import_options(setup), "-o", table.removesuffix(".csv") + ".h5"]))


if __name__ == "__main__":
    main()

"""The promises of daq::Board on the kernel's comedi_test, and a hundred starts and stops of the daemon."""

import unittest

import h5py
import numpy

import support
import verdict


class StartsAndStops(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.results = support.small_guest("cycles")

    def test_the_board_conforms(self):
        text = (self.results / "conformance.txt").read_text()
        passed = text.count("[       OK ]")
        print(f"\n{passed} promises kept")
        # All of BoardConformance, with one channel and with two, but the promise that needs an input that repeats.
        self.assertGreaterEqual(passed, 2 * 16, text)
        self.assertNotIn("[  FAILED  ]", text)

    def test_both_channels_of_a_scan_are_of_the_same_scan(self):
        [path] = support.records(self.results, "second")
        record = verdict.judge(path)
        with h5py.File(path) as file:
            square = file["entry/raw/pull_speed_counts"][()]
            speed = file["entry/raw/pull_speed"][()]
            gain = file["entry/instrument/second/gain"][()]
        self.assertEqual(len(square), len(record.scan))
        self.assertGreater(len(square), 3 * 349)
        # Which half of its period the saw-tooth is in, but for the scans on the border.
        low, high = record.counts.min(), record.counts.max()
        phase = (record.counts.astype(float) - low) / (high - low)
        inside = numpy.abs(numpy.abs(phase - 0.5) - 0.25) < 0.24
        levels = sorted(set(square))
        self.assertEqual(len(levels), 2)
        first_half = set(square[inside & (phase < 0.5)])
        second_half = set(square[inside & (phase > 0.5)])
        print(f"\n{len(square)} scans, square wave {levels}")
        self.assertEqual(len(first_half), 1)
        self.assertEqual(first_half | second_half, set(levels))
        # +-1 V at 1 mm/s for each volt.
        self.assertAlmostEqual(gain, 1e-3)
        numpy.testing.assert_allclose(numpy.unique(numpy.abs(speed)), 1e-3, rtol=1e-3)

    def test_a_hundred_starts_and_stops(self):
        self.assertEqual((self.results / "cycles-done").read_text().split(), ["100"])
        log = (self.results / "cycles" / "daemon.log").read_text()
        self.assertEqual(log.count("stopping: SIGTERM"), 100)
        self.assertEqual(log.count("Hz granted"), 100)
        for bad in ("error:", "warning:", "board missing"):
            self.assertNotIn(bad, log)


if __name__ == "__main__":
    unittest.main()

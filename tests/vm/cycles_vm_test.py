"""The promises of daq::Board on the kernel's comedi_test, and a hundred starts and stops of the daemon."""

import unittest

import support


class StartsAndStops(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.results = support.small_guest("cycles")

    def test_the_board_conforms(self):
        text = (self.results / "conformance.txt").read_text()
        passed = text.count("[       OK ]")
        print(f"\n{passed} promises kept")
        # All of BoardConformance but the one that needs an input that repeats.
        self.assertGreaterEqual(passed, 14, text)
        self.assertNotIn("[  FAILED  ]", text)

    def test_a_hundred_starts_and_stops(self):
        self.assertEqual((self.results / "cycles-done").read_text().split(), ["100"])
        log = (self.results / "cycles" / "daemon.log").read_text()
        self.assertEqual(log.count("stopping: SIGTERM"), 100)
        self.assertEqual(log.count("Hz granted"), 100)
        for bad in ("error:", "warning:", "board missing"):
            self.assertNotIn(bad, log)


if __name__ == "__main__":
    unittest.main()

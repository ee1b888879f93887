#!/usr/bin/env python3
"""docs/hard-cases.md is complete and true: it has a row for each of the twenty cases, and every test that it
names exists.

hard_cases_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[2]).resolve()

TEST = re.compile(r"\b(?:TEST|TEST_F|TEST_P|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)\s*[,)]")
ROW = re.compile(r"^\| (\d+) \| (.+?) \| (.+?) \|$", re.MULTILINE)


class HardCases(unittest.TestCase):
    def setUp(self):
        self.rows = ROW.findall((SOURCE / "docs" / "hard-cases.md").read_text(encoding="utf-8"))
        self.tests = set()
        for file in (SOURCE / "tests").rglob("*.cpp"):
            self.tests |= {f"{suite}.{name}" for suite, name in TEST.findall(file.read_text(encoding="utf-8"))}

    def test_each_case_has_its_row(self):
        self.assertEqual([int(number) for number, _, _ in self.rows], list(range(1, 21)))

    def test_each_row_names_tests_that_exist(self):
        self.assertGreater(len(self.tests), 500)
        for number, _, cell in self.rows:
            names = re.findall(r"`([^`]+)`", cell)
            self.assertGreater(len(names), 0, f"case {number}")
            for name in names:
                self.assertTrue(name in self.tests, f"case {number}: there is no test {name}")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)

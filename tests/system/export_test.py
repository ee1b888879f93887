#!/usr/bin/env python3
"""stickslip export gives a record away to the last digit: what is imported from its table again is the same to the
last bit, and the table of cycles is that of the record.

export_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy
except ImportError:
    h5py = None

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
STICKSLIP = BUILD / "bin" / "stickslip"
TIMEOUT_S = 300


def parts(text):
    """Metadata before the header, and the rows as dictionaries."""
    lines = text.splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    return facts, list(csv.DictReader(line for line in lines if not line.startswith("#")))


@unittest.skipIf(h5py is None and os.environ.get("CI") != "true", "python3-h5py is not installed")
class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(cls.place.cleanup)
        cls.folder = pathlib.Path(cls.place.name)
        cls.run_stickslip("simulate", "drift-hum-and-spikes", "-o", "pull.h5", "--folder",
                          str(SOURCE / "config" / "scenes"), "--duration", "6 s")

    @classmethod
    def run_stickslip(cls, *arguments, status=0):
        done = subprocess.run([STICKSLIP, *arguments], cwd=cls.folder, capture_output=True, text=True, check=False,
                              timeout=TIMEOUT_S)
        if done.returncode != status:
            raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr}")
        return done

    def test_scans_come_back_to_the_last_bit(self):
        text = self.run_stickslip("export", "pull.h5", "--csv").stdout
        (self.folder / "pull.csv").write_text(text, encoding="utf-8")
        facts, rows = parts(text)
        with h5py.File(self.folder / "pull.h5") as record:
            raw, cell = record["entry/raw"], record["entry/instrument/calibration"]
            adc, tester = record["entry/instrument/adc"], record["entry/instrument/tester"]
            self.assertEqual(facts["uuid"], record["entry/entry_identifier_uuid"][()].decode())
            self.assertEqual([int(row["counts"]) for row in rows], list(raw["counts"]))
            self.assertEqual([int(row["scan"]) for row in rows], list(raw["scan"]))
            self.assertEqual([float(row["time_s"]) for row in rows], list(raw["time"]))
            spikes = [int(row["spike"]) for row in rows]
            self.assertEqual(spikes, [int(flags) & 1 for flags in raw["flags"]])
            self.assertGreater(sum(spikes), 0)
            # Horner, as docs/record-file.md says: the same operations, the same bits.
            x = raw["counts"][:].astype(float) - adc["expansion_origin"][()]
            volts = numpy.zeros_like(x)
            for power in reversed(adc["polynomial"][:]):
                volts = volts * x + power
            force = (volts - cell["zero"][()]) * cell["gain"][()]
            weight = tester["sled_mass"][()] * tester["gravity"][()]
            mass = float(tester["sled_mass"][()])
        self.assertEqual([float(row["voltage_V"]) for row in rows], list(volts))
        self.assertEqual([float(row["force_N"]) for row in rows], list(force))
        self.assertEqual([float(row["coefficient"]) for row in rows], list(force / weight))

        for column, unit, values in (("force_N", "N", force), ("coefficient", "coefficient", force / weight)):
            name = f"{column}.h5"
            self.run_stickslip("import", "pull.csv", "--column", column, "--time-column", "time_s", "--rate", "350 Hz",
                               "--unit", unit, "--sled-mass", f"{mass!r} kg", "-o", name)
            with h5py.File(self.folder / name) as record:
                raw = record["entry/raw"]
                self.assertTrue(numpy.array_equal(raw[raw.attrs["signal"]][:], values))
            # And out again.
            _, again = parts(self.run_stickslip("export", name, "--csv").stdout)
            self.assertEqual([float(row[column]) for row in again], list(values))

    def test_cycles_are_those_of_the_record(self):
        self.run_stickslip("export", "pull.h5", "--csv", "--cycles", "-o", "cycles.csv")
        _, rows = parts((self.folder / "cycles.csv").read_text(encoding="utf-8"))
        units = {"s": "_s", "1": "", "m/s": "_m_per_s"}
        with h5py.File(self.folder / "pull.h5") as record:
            cycles = record["entry/cycles"]
            self.assertGreater(len(rows), 40)
            self.assertEqual({name + units[column.attrs["units"]] for name, column in cycles.items()}, set(rows[0]))
            for name, column in cycles.items():
                printed = [row[name + units[column.attrs["units"]]] for row in rows]
                for text, value in zip(printed, column[:], strict=True):
                    self.assertEqual(text == "", math.isnan(value), name)
                    self.assertTrue(text == "" or float(text) == value, (name, text, value))

    def test_gaps_come_back_from_an_export(self):
        self.run_stickslip("simulate", "clock-and-missing-scans", "-o", "gaps.h5", "--folder",
                           str(SOURCE / "config" / "scenes"), "--duration", "4 s")
        self.run_stickslip("export", "gaps.h5", "--csv", "-o", "gaps.csv")
        _, rows = parts((self.folder / "gaps.csv").read_text(encoding="utf-8"))
        scans = [int(row["scan"]) for row in rows]
        self.assertGreater(scans[-1] - scans[0] + 1, len(scans))
        self.run_stickslip("import", "gaps.csv", "--column", "force_N", "--sled-mass", "2331 g", "-o", "again.h5")
        with h5py.File(self.folder / "gaps.h5") as before, h5py.File(self.folder / "again.h5") as after:
            self.assertEqual(list(after["entry/raw/scan"]), list(before["entry/raw/scan"]))
            self.assertTrue(numpy.array_equal(after["entry/raw/force"][:].astype("f4"), before["entry/raw/force"][:]))
            for name in ("first_scan", "scan_count"):
                self.assertEqual(list(after["entry/gaps"][name]), list(before["entry/gaps"][name]))
            # Forces in volts and in newtons go through other roundings.
            for name in ("kinetic_coefficient", "mu_s", "mu_k"):
                self.assertAlmostEqual(after["entry/results"][name][()], before["entry/results"][name][()], delta=1e-6)

    def test_an_exported_record_comes_back_without_an_option(self):
        self.run_stickslip("simulate", "clock-and-missing-scans", "-o", "whole.h5", "--folder",
                           str(SOURCE / "config" / "scenes"), "--duration", "4")
        for name in ("pull", "whole"):
            self.run_stickslip("export", f"{name}.h5", "--csv", "-o", f"{name}-out.csv")
            [command] = [line for line in self.run_stickslip("import", f"{name}-out.csv", "--inspect").stdout.splitlines()
                         if line.startswith("to import: ")]
            self.assertEqual(command, f"to import: stickslip import {name}-out.csv -o {name}-out.h5")
            self.run_stickslip("import", f"{name}-out.csv", "-o", f"{name}-out.h5")
            with h5py.File(self.folder / f"{name}.h5") as before, h5py.File(self.folder / f"{name}-out.h5") as after:
                same = []
                before["entry"].visititems(lambda path, item: same.append(path) if isinstance(item, h5py.Dataset) else None)
                # The truth is not in the table; the source is new; the evaluation takes its own time.
                same = [path for path in same if not re.match(r"truth/|process/(source_|compute_time|file_sha256)|self_check/counts", path)]
                self.assertGreater(len(same), 80)
                for path in same:
                    numpy.testing.assert_array_equal(after["entry"][path][()], before["entry"][path][()], path)
                self.assertEqual(after["entry/process/source_file"].asstr()[()], f"{name}-out.csv")
            # Missing scans count.
            self.run_stickslip("verify", f"{name}-out.h5", status=0 if name == "pull" else 1)

    def test_a_table_that_was_changed_is_refused_with_its_line(self):
        text = self.run_stickslip("export", "pull.h5", "--csv").stdout
        heading = text.splitlines().index("time_s,scan,counts,voltage_V,force_N,coefficient,spike,saturated")
        rows = text.splitlines()[heading + 1:heading + 4]
        for wrong, said in ((text.replace(rows[1], rows[1].replace(",1,", ",1.5,", 1)), f":{heading + 3}: column \"scan\" is '1.5'"),
                            (text.replace(rows[1], rows[1] + ",0"), f":{heading + 3}: the row has 9 fields, the heading 8"),
                            (text.replace(rows[2] + "\n", rows[1] + "\n"), f":{heading + 4}: column \"scan\" is '1'"),
                            (text.replace(rows[1] + "\n", ""), f":{heading + 3}: the rows of scans 1 … 1 are missing"),
                            (text.replace(rows[0] + "\n", ""), "rows are missing: the table has "),
                            (text + rows[2] + "\n", "a row stands below the line \"# end: …\""),
                            (text[:text.index("# end: ")], "the table is cut"),
                            (text.replace("# header: {", "# header: {{"), f":{heading}: the line \"# header: …\" cannot be read")):
            (self.folder / "wrong.csv").write_text(wrong, encoding="utf-8")
            message = self.run_stickslip("import", "wrong.csv", "-o", "wrong.h5", status=2).stderr
            self.assertIn(said, message)
            self.assertIn("give --column NAME", message)
        self.run_stickslip("import", "wrong.csv", "--column", "force_N", "--sled-mass", "2331 g", "-o", "wrong.h5")
        (self.folder / "right.csv").write_text(text, encoding="utf-8")
        self.assertIn("leave out --sled-mass",
                      self.run_stickslip("import", "right.csv", "-o", "x.h5", "--sled-mass", "2331 g", status=2).stderr)

    def test_refusals(self):
        self.assertIn("--csv", self.run_stickslip("export", "pull.h5", status=2).stderr)
        self.run_stickslip("export", "missing.h5", "--csv", status=2)
        (self.folder / "there.csv").write_text("mine", encoding="utf-8")
        self.run_stickslip("export", "pull.h5", "--csv", "-o", "there.csv", status=2)
        self.assertEqual((self.folder / "there.csv").read_text(encoding="utf-8"), "mine")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

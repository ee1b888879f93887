#!/usr/bin/env python3
"""`stickslip import` of traces with troubles in their times: each refusal names a remedy, and the remedy works.

import_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy
import scipy.io

BUILD = pathlib.Path(sys.argv[1]).resolve()
CLI = BUILD / "bin" / "stickslip"
SOURCE = pathlib.Path(sys.argv[2]).resolve()
SANITIZED = any(flag in str(BUILD) for flag in ("asan", "tsan"))
# 8 TB of numbers in a file of a few kB: reading it all at once takes more memory than there is.
TRAP = {"shape": (10**12,), "chunks": (1000,), "dtype": "f8"}
RATE_Hz = 350
# "give --resample to …", "give --time-column none and --rate HZ"
REMEDY = re.compile(r"--(?:time-column none|rate HZ|time-unit (?:s|ms|us|min|h)\b|invert|reverse|resample|skip-doubled|unit \w+|decimal \",\")")


class Import(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="stickslip-import-")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        scene = SOURCE / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
        cls.call("simulate", scene, "-o", cls.folder / "pull.h5")
        with h5py.File(cls.folder / "pull.h5") as record:
            cls.force = list(map(float, record["entry/raw/force"][:]))
            cls.delta_mu = float(record["entry/results/delta_mu"][()])

    @staticmethod
    def call(*words, status=0):
        done = subprocess.run([CLI, *map(str, words)], capture_output=True, text=True, check=False)
        if done.returncode != status:
            raise AssertionError(f"{words}: {done.returncode}: {done.stderr}{done.stdout}")
        return done.stdout if status == 0 else done.stderr

    def write(self, name, rows, heading="time,force"):
        file = self.folder / name
        file.write_text("\n".join([heading, *(",".join(row) for row in rows)]) + "\n", encoding="utf-8")
        return file

    def arguments(self, file, *options):
        for old in self.folder.glob("x*.h5"):
            old.unlink()
        return ["import", file, "--column", "force", "--unit", "N", "--sled-mass", "2331 g", "-o", self.folder / "x.h5", *options]

    def follow(self, file, what, *options, steps=3):
        """The import is refused for `what`; the remedies in its messages lead to the record of the pull."""
        message = self.call(*self.arguments(file, *options), status=2)
        self.assertIn(what, message)
        given = list(options)
        for _ in range(steps):
            remedies = REMEDY.findall(message)
            self.assertTrue(remedies, message)
            for remedy in remedies:
                words = shlex.split(remedy.replace("HZ", f'"{RATE_Hz} Hz"'))
                if words[0] not in given:
                    given += words
            done = subprocess.run([CLI, *map(str, self.arguments(file, *given))], capture_output=True, text=True, check=False)
            if done.returncode == 0:
                break
            message = done.stderr
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.folder / "x.h5") as record:
            self.assertAlmostEqual(record["entry/timing/scan_rate_granted"][()], RATE_Hz, delta=0.5)
            self.assertAlmostEqual(record["entry/results/delta_mu"][()], self.delta_mu, delta=0.001)

    def rows(self, times=None, decimals=6):
        times = times or [scan / RATE_Hz for scan in range(len(self.force))]
        return [[f"{time:.{decimals}f}", f"{force:.5f}"] for time, force in zip(times, self.force, strict=True)]

    def test_each_remedy_works_when_it_is_followed(self):
        even = [scan / RATE_Hz for scan in range(len(self.force))]
        doubled = self.rows()
        doubled.insert(500, doubled[499])
        set_back = [time - (0.05 if scan >= 1000 else 0) for scan, time in enumerate(even)]
        uneven = [time + (0.4 / RATE_Hz if scan % 7 == 3 else 0) for scan, time in enumerate(even)]
        for name, rows, what in (("doubled.csv", doubled, "the time of the row before"),
                                 ("set_back.csv", self.rows(set_back), "time goes back by"),
                                 ("uneven.csv", self.rows(uneven), "displaced by"),
                                 ("reversed.csv", self.rows()[::-1], "time runs backwards"),
                                 ("coarse.csv", self.rows(decimals=0), "too coarse"),
                                 ("still.csv", [["5", row[1]] for row in self.rows()], "does not advance"),
                                 ("negative.csv", [[row[0], f"{-float(row[1]):.5f}"] for row in self.rows()], "negative while sliding")):
            with self.subTest(name):
                self.follow(self.write(name, rows), what)
        with self.subTest("no time"):
            self.follow(self.write("no_time.csv", [[row[1]] for row in self.rows()], heading="force"), "no column is a time")
        with self.subTest("milliseconds"):
            thousand = [[f"{1e3 * time:.3f}", f"{force:.5f}"] for time, force in zip(even, self.force, strict=True)]
            self.follow(self.write("ms.csv", thousand, heading="time (s),force"), "Hz", "--rate", "350 Hz")

    def test_inspection_prints_a_command_that_imports(self):
        file = self.write("inspect.csv", self.rows(), heading="Time (s),Force (N)")
        printed = self.call("import", file, "--inspect")
        self.assertFalse(list(self.folder.glob("inspect.h5")))
        [command] = re.findall(r"^to import: stickslip (.*)$", printed, re.MULTILINE)
        self.assertIn("--sled-mass MASS", command)
        self.call(*(word.replace("MASS", "2331 g") for word in shlex.split(command)))
        with h5py.File(self.folder / "inspect.h5") as record:
            self.assertAlmostEqual(record["entry/results/delta_mu"][()], self.delta_mu, delta=0.001)
        # What the file does not say is not made up.
        unknown = self.call("import", self.write("unknown.csv", [[row[1]] for row in self.rows()], heading="F"), "--inspect")
        for word in ("--unit UNIT", "--rate HZ", "--sled-mass MASS"):
            self.assertIn(word, unknown)

    def test_a_clock_that_starts_again_gives_a_record_for_each_run(self):
        stdout = self.call(*self.arguments(self.write("twice.csv", self.rows() + self.rows())))
        self.assertIn("the clock starts again in line", stdout)
        for name in ("x-1.h5", "x-2.h5"):
            with h5py.File(self.folder / name) as record:
                self.assertAlmostEqual(record["entry/results/delta_mu"][()], self.delta_mu, delta=0.001)
        # The same scans in two records of one report are told.
        report = json.loads(self.call("report", self.folder / "x-1.h5", self.folder / "x-2.h5", "--json"))
        self.assertEqual(report["tests"][0]["findings"], [])
        self.assertRegex(report["tests"][1]["findings"][0], r"^has the same scans as .*x-1\.h5: the trace was imported twice")

    def test_a_record_keeps_its_source_and_its_force(self):
        file = self.write("source.csv", self.rows())
        self.call(*self.arguments(file, "--sample", "liner 42", "--grade", "kraft", "--operator", "Ada", "--replicate", 3))
        with h5py.File(self.folder / "x.h5") as record:
            process, sample = record["entry/process"], record["entry/sample"]
            self.assertEqual(process["source_file"].asstr()[()], "source.csv")
            self.assertEqual(process["source_size"][()], file.stat().st_size)
            self.assertEqual(process["source_sha256"].asstr()[()], subprocess.run(["sha256sum", file], capture_output=True, text=True, check=True).stdout.split()[0])
            self.assertIn("separator comma", process["source_reading"].asstr()[()])
            self.assertIn("--sample 'liner 42'", process["source_command"].asstr()[()])
            self.assertEqual((sample["name"].asstr()[()], sample["replicate"][()]), ("liner 42", 3))
        coefficient = [[row[0], f"{float(row[1]) / (2.331 * 9.80665):.6f}"] for row in self.rows()]
        self.call("import", self.write("mu.csv", coefficient, heading="time,mu"), "--column", "mu", "--unit", "coefficient", "--sled-mass", "2331 g",
                  "-o", self.folder / "mu.h5")
        with h5py.File(self.folder / "mu.h5") as record:
            for measured, true in zip(record["entry/raw/force"][:], self.force, strict=True):
                self.assertAlmostEqual(measured, true, delta=2e-5)
        self.call("verify", self.folder / "mu.h5")

    def expect_force(self, file, *options):
        """Imports the pull into x.h5. \return what was printed."""
        for old in self.folder.glob("x*.h5"):
            old.unlink()
        printed = self.call("import", file, "--unit", "N", "--sled-mass", "2331 g", "-o", self.folder / "x.h5", *options)
        with h5py.File(self.folder / "x.h5") as record:
            self.assertAlmostEqual(record["entry/timing/scan_rate_granted"][()], RATE_Hz, delta=0.5)
            numpy.testing.assert_allclose(record["entry/raw/force"][:], self.force, rtol=1e-6)
            process = record["entry/process"]
            self.assertEqual(process["source_file"].asstr()[()], file.name)
            self.assertEqual(process["source_size"][()], file.stat().st_size)
            self.assertEqual(process["source_sha256"].asstr()[()], hashlib.sha256(file.read_bytes()).hexdigest())
            self.assertEqual(process["source_reading"].asstr()[()].splitlines()[0], printed.splitlines()[0])
        return printed

    def columns(self):
        return {"t": numpy.arange(len(self.force)) / RATE_Hz, "F": numpy.array(self.force)}

    def test_files_of_matlab_give_the_force_of_their_variable(self):
        pair = numpy.column_stack(list(self.columns().values()))
        for name, format_read, options in (("v4.mat", "MATLAB 4", {"format": "4"}), ("v5.mat", "MATLAB 5", {}), ("v7.mat", "MATLAB 5", {"do_compression": True}),
                                           ("column.mat", "MATLAB 5", {"oned_as": "column"})):
            file = self.folder / name
            scipy.io.savemat(file, self.columns() | {"M": pair}, **options)
            self.assertIn(f"recognised: {format_read}, variable F\n", self.expect_force(file, "--column", "F"))
            self.expect_force(file, "--column", "M(:,2)", "--time-column", "M(:,1)", "--time-unit", "s")
            with self.subTest("by a pipe"), file.open("rb") as content:
                done = subprocess.run(f'cat | "{CLI}" import /dev/stdin --column F --inspect', shell=True, stdin=content, capture_output=True, text=True, check=True)
                self.assertIn(format_read, done.stdout)
        file = self.folder / "run.mat"
        scipy.io.savemat(file, {"run": {"Time": self.columns()["t"], "Data": self.columns()["F"]}, "z": pair * 1j})
        self.assertIn("variable run.Data\n", self.expect_force(file, "--column", "run.Data"))
        self.assertIn("no columns: z is complex\n", self.call("import", file, "--inspect"))
        file.write_bytes(file.read_bytes()[:-1000])
        self.assertIn("cut short or damaged", self.call(*self.arguments(file), status=2))

    def test_hdf5_files_give_the_force_of_their_dataset(self):
        file = self.folder / "other.h5"
        with h5py.File(file, "w") as other:
            other["run1/force"] = self.columns()["F"]
            other["run1/force"].attrs["units"] = "N"
            other["run1/time"] = self.columns()["t"]
            other.create_dataset("trap", **TRAP)
        self.assertIn("recognised: HDF5, dataset /run1/force\n", self.expect_force(file, "--dataset", "/run1/force"))
        self.expect_force(file, "--dataset", "/run1/force", "--time-dataset", "/run1/time")
        # One dataset that cannot be read hides no other; a pipe is as good as a file.
        with file.open("rb") as content:
            shown = subprocess.run(f'cat | "{CLI}" import /dev/stdin --inspect', shell=True, stdin=content, capture_output=True, text=True, check=True).stdout
        self.assertRegex(shown, r"3  /trap +1000000000000  cannot be read")
        self.assertIn("to import: stickslip import /dev/stdin --dataset /run1/force", shown)
        self.expect_force(file, "--dataset", "/run1/force", "--time-dataset", "none", "--rate", RATE_Hz)
        # The command of the error imports, but for what nobody knows.
        message = self.call("import", file, status=2)
        self.assertIn('give --dataset NAME; there are 1 "/run1/force"', message)
        [command] = re.findall(r": stickslip (import .*)$", message)
        self.call(*(word.replace("MASS", "2331 g") for word in shlex.split(command)))
        # What is a record already needs no import, and the error says what to do with it.
        record = self.folder / "other-record.h5"
        message = self.call("import", record, "--dataset", "/entry/raw/force", "-o", "y.h5", status=2)
        self.assertIn("needs no import", message)
        [command] = re.findall(r"needs no import: stickslip (.*)$", message)
        self.call(*shlex.split(command))

    @unittest.skipIf(SANITIZED, "a sanitizer maps terabytes: there is no limit of memory")
    def test_dataset_larger_than_the_limit_of_memory_is_refused(self):
        file = self.folder / "trap.h5"
        with h5py.File(file, "w") as other:
            other.create_dataset("trap", **TRAP)
        self.assertRegex(self.call("import", file, "--dataset", "/trap", "--rate", RATE_Hz, "--unit", "N", "--sled-mass", "1 kg", "-o", "y.h5", status=2),
                         r"cannot be read in \d+ MB of memory, which is the limit for its size: .*restore it from a backup")

    def test_counts_become_a_record_like_that_of_a_board(self):
        counts = [[row[0], str(round(float(row[1]) / 2 / 0.5e-3))] for row in self.rows()]
        file = self.write("counts.csv", counts, heading="time,code")
        words = ["import", file, "--column", "code", "--unit", "counts", "--sled-mass", "2331 g", "-o", self.folder / "counts.h5"]
        self.assertIn("--count-range 0..65535", self.call(*words, status=2))
        words += ["--count-range", "-32768..32767"]
        self.assertIn("--volts-per-count", self.call(*words, status=2))
        words += ["--volts-per-count", "0.5 mV"]
        self.assertIn("--load-cell-gain", self.call(*words, status=2))
        self.call(*words, "--load-cell-gain", "2 N/V")
        with h5py.File(self.folder / "counts.h5") as record:
            self.assertEqual(list(record["entry/raw/counts"][:]), [int(row[1]) + 32768 for row in counts])
            self.assertAlmostEqual(record["entry/results/delta_mu"][()], self.delta_mu, delta=0.001)
        self.call("verify", self.folder / "counts.h5")

    def test_a_record_keeps_the_facts_that_its_user_states(self):
        file = self.write("meta.csv", self.rows())
        self.call(*self.arguments(file, "--set-meta", "humidity=52 %", "--set-meta", "room.temperature=23.1 °C = ok"))
        with h5py.File(self.folder / "x.h5") as record:
            stated = {key: value.asstr()[()] for key, value in record["entry/metadata"].items()}
        self.assertEqual(stated, {"humidity": "52 %", "room.temperature": "23.1 °C = ok"})
        self.call("verify", self.folder / "x.h5")
        self.assertIn("   test 1: humidity: 52 %\n", self.call("report", self.folder / "x.h5"))
        self.assertEqual(json.loads(self.call("report", self.folder / "x.h5", "--json"))["tests"][0]["metadata"], stated)
        shown = self.call("show", self.folder / "x.h5")
        self.assertRegex(shown, r"(?m)^  metadata\.humidity +52 %$")
        self.assertRegex(shown, r"(?m)^  delta_mu +0\.0[45]")
        self.assertEqual(json.loads(self.call("show", self.folder / "x.h5", "--json"))["metadata"], stated)
        self.assertRegex(self.call("show", self.folder / "no-such.h5", status=2), r"no-such\.h5: .*a test of the daemon is named by its number")
        # Through a table and back, with one more.
        table = self.folder / "meta-out.csv"
        self.call("export", self.folder / "x.h5", "--csv", "-o", table)
        self.call("import", table, "--set-meta", "note=again", "-o", self.folder / "x-again.h5")
        with h5py.File(self.folder / "x-again.h5") as record:
            self.assertEqual({key: value.asstr()[()] for key, value in record["entry/metadata"].items()}, {**stated, "note": "again"})
        for pairs, said in ((["note"], "has no '='"), (["=x"], 'key ""'), (["a/b=x"], 'key "a/b"'), (["1a=x"], "a letter"), (["k" * 65 + "=x"], "at most 64"),
                            (["a="], "a: the value is empty"), (["a=" + "x" * 201], "is 201 bytes long, at most 200 are allowed"),
                            (["a=1\n2"], "holds the control character"), (["a=1", "a=2"], 'a is "1" already, and "2" comes too')):
            options = [word for pair in pairs for word in ("--set-meta", pair)]
            message = self.call(*self.arguments(file, *options), status=2)
            self.assertIn(said, message)
            self.assertIn("--set-meta", message)

    def test_a_transducer_is_kept_and_each_part_can_be_replaced(self):
        file = self.write("cell.csv", self.rows())
        self.call(*self.arguments(file, "--load-cell-frequency", "300 Hz"))
        with h5py.File(self.folder / "x.h5") as record:
            tester = record["entry/instrument/tester"]
            self.assertEqual({name: tester[name][()] for name in ("load_cell_frequency", "load_cell_damping")}, {"load_cell_frequency": 300.0, "load_cell_damping": 0.05})
            self.assertNotIn("anti_alias", tester)
        self.assertRegex(self.call("show", self.folder / "x.h5"), r"(?m)^  load_cell +300 Hz, damping 0\.05$")

        def delta_mu(*options):
            return json.loads(self.call("analyze", self.folder / "x.h5", "--json", *options))["tests"][0]["delta_mu"]

        # With a filter beside the cell, which stays, S - K is another one than with either alone.
        cell = ("--load-cell-frequency", "300 Hz")
        both = delta_mu("--anti-alias", "150 Hz")
        self.assertEqual(both, delta_mu("--anti-alias", "150 Hz", *cell))
        self.assertEqual(delta_mu(), delta_mu(*cell))
        self.assertNotEqual(both, delta_mu())
        for options, said in ((("--load-cell-frequency", "80"), "a frequency needs its unit"), (("--anti-alias", "0 Hz"), "must be 0.1 to 1000000 Hz"),
                              (("--load-cell-damping", "0.1"), "--load-cell-damping needs --load-cell-frequency"), (("--anti-alias-order", "3"), "--anti-alias-order needs --anti-alias"),
                              (("--anti-alias", "60 Hz", "--anti-alias-order", "2.5"), "must be a whole number"), (("--anti-alias", "60 Hz", "--anti-alias-order", "9"), "must be 1 to 8\n"),
                              ((*cell, "--load-cell-damping", "1"), "must be 0 to 0.99\n")):
            self.assertIn(said, self.call("analyze", self.folder / "x.h5", *options, status=2))

    def test_a_folder_that_is_missing_is_told_before_the_file_is_read(self):
        file = self.write("pull.csv", self.rows())
        words = [str(self.folder / "nowhere" / "x.h5") if word == self.folder / "x.h5" else word for word in self.arguments(file)]
        self.assertRegex(self.call(*words, status=2), "there is no folder .*nowhere: make it first")

    def test_memory_does_not_grow_with_the_trace(self):
        if SANITIZED:
            self.skipTest("a sanitizer has a memory of its own")
        code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL);"
                "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)")
        # Both traces are fitted in more sections than threads hold at once. One arena: what several arenas of
        # the allocator keep free grows to its end over the first sections.
        peaks, counts = [], (600_000, 1_800_000)
        for count in counts:
            scan = numpy.arange(count)
            force = 7.0 * numpy.minimum(1.0, scan / 300) + 0.5 * (scan % 100) / 100
            file = self.folder / "long.csv"
            with open(file, "w", encoding="utf-8") as text:
                text.write("time,force\n")
                text.writelines(f"{t:.3f},{f:.4f}\n" for t, f in zip(scan / 1000, force))
            words = [sys.executable, "-c", code, CLI, *map(str, self.arguments(file))]
            peaks.append(int(subprocess.run(words, capture_output=True, text=True, check=True,
                                            env={**os.environ, "MALLOC_ARENA_MAX": "1"}).stdout))
            file.unlink()
            with h5py.File(self.folder / "x.h5") as record:
                numpy.testing.assert_array_equal(record["entry/raw/scan"][()], scan)
                numpy.testing.assert_allclose(record["entry/raw/force"][()], force, atol=0.51e-4)
        # One column in memory would be 8 bytes a row.
        self.assertLess((peaks[1] - peaks[0]) / (counts[1] - counts[0]), 4)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

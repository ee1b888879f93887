#!/usr/bin/env python3
"""A batch on the simulated tester, from its plan to its report: led from test to test, over a kill of the daemon, with a
test that was voided.

batch_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import csv
import io
import json
import pathlib
import subprocess
import sys
import unittest

import h5py

from running_daemon import RunningDaemon, wait_for

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


class Batch(unittest.TestCase):
    def setUp(self):
        times = {"idle": "10 s", "pull": "5 s", "rest": "1 s"}
        self.daemon = RunningDaemon(self, BUILD, SOURCE, '[test]\nbegins = "command"\n', times=times)

    def run_cli(self, *arguments, status=0):
        done = self.daemon.run(*arguments, *(() if "--as" in arguments or arguments == ("batch",) else ("--as", "ada")))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout if status == 0 else done.stderr

    def report(self, *arguments, status=0, command="report"):
        # It talks to no daemon, and has no --socket.
        done = subprocess.run([str(self.daemon.cli), command, *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout if status == 0 else done.stderr

    def measure(self):
        """One test, begun by command while the sled rests, ended by the end of the pull. Returns its record."""
        process, frames = self.daemon.watch()
        try:
            status = 0
            while status != 200:
                self.daemon.wait_for_rest(frames)
                status, started = self.daemon.ask("POST", "/v1/start", {})
            wait_for(frames, lambda frame: frame["type"] == "test-ended")
        finally:
            process.kill()
            process.communicate()
        return self.daemon.record(started["test"])

    @staticmethod
    def place(record):
        with h5py.File(record) as file:
            sample = file["entry/sample"]
            return sample["batch"][()].decode(), sample["replicate"][()], sample["slide"][()], sample["name"][()].decode()

    def batch(self):
        return self.daemon.ask("GET", "/v1/batch")[1]["batch"]

    def wait_for_tests(self, count):
        """The journal is written after the record."""
        process, frames = self.daemon.watch()
        try:
            wait_for(frames, lambda frame: frame["type"] == "health" and len(self.batch()["tests"]) == count)
        finally:
            process.kill()
            process.communicate()

    def wait_for_known(self, count):
        """The daemon's tests, once it has so many: those of before it began are read one after the other."""
        process, frames = self.daemon.watch()
        try:
            for _ in frames:
                known = self.daemon.ask("GET", "/v1/tests")[1]
                if len(known["tests"]) == count:
                    return known
        finally:
            process.kill()
            process.communicate()
        raise AssertionError("the stream ended")

    def test_a_batch_leads_over_a_kill_asks_again_for_what_was_voided_and_reports_the_rest(self):
        begun = self.run_cli("batch", "begin", "--name", "liner 42", "--grade", "kraft", "--replicates", "2", "--slides", "2",
                             "--limit", "delta_mu=0.03:0.07", "--limit", "mu_k=:0.2", "--limit", "period_median=1 ms:10 s")
        self.assertIn("0 of 4 tests made\nnext: sheet 1, slide 1\n", begun)
        batch = self.batch()["id"]
        records = [self.measure(), self.measure()]
        self.assertEqual([self.place(record) for record in records], [(batch, 1, slide, "liner 42") for slide in (1, 2)])
        self.assertIn("is not complete", self.run_cli("batch", "begin", "--name", "other", status=1))

        # Killed as soon as a record is there, perhaps before the journal has it.
        tests = self.daemon.ask("GET", "/v1/tests")[1]["tests"]
        self.daemon.kill()
        self.daemon.start()
        # What the tests were is read from their records again, and they are numbered on.
        known = self.wait_for_known(2)
        for test, earlier in zip(tests, known["tests"], strict=True):
            self.assertEqual(earlier, {**test, "first_scan": None, "end_scan": None, "file": earlier["file"]})
            self.assertEqual(earlier["file"].split("/")[-1], records[test["number"] - 1].name)
        self.assertEqual(known["summary"]["tests"], [1, 2])
        self.assertGreater(known["summary"]["delta_mu_by_cycle"]["slips"], 100)
        self.assertEqual(self.daemon.ask("GET", "/v1/status")[1]["test_count"], 0)
        self.assertEqual([test["record"] for test in self.batch()["tests"]], [record.name for record in records])
        self.assertEqual(self.batch()["next"], {"pull_speed": None, "replicate": 2, "slide": 1})
        records.append(self.measure())
        self.assertEqual(self.place(records[2])[1:3], (2, 1))
        self.wait_for_tests(3)

        voided = self.run_cli("void", "3", "--reason", "paper torn")
        self.assertIn("void: paper torn, by ada", voided)
        self.assertIn("next: sheet 2, slide 1", voided)
        self.assertEqual(self.daemon.ask("GET", "/v1/tests/3")[1]["voided"]["by"], "ada")
        untouched = records[2].read_bytes()
        records.append(self.measure())
        self.assertEqual(self.place(records[3])[1:3], (2, 1), "the same step again")
        records.append(self.measure())
        self.wait_for_tests(5)
        self.assertEqual(records[2].read_bytes(), untouched)
        self.assertIn("4 of 4 tests made", self.run_cli("batch"))
        self.assertIsNone(self.batch()["next"])
        # Nobody leads any more: the next test is of no batch.
        self.assertNotIn("batch", h5py.File(self.measure())["entry/sample"])

        folder = records[0].parent
        report = json.loads(self.report("--batch", "liner 42", folder, "--json"))
        counted = [str(folder / records[i].name) for i in (0, 1, 3, 4)]
        self.assertEqual([test["file"] for test in report["tests"]], counted)
        self.assertEqual([(test["file"], test["reason"], test["by"]) for test in report["voided"]], [(str(folder / records[2].name), "paper torn", "ada")])
        limits = {limit["quantity"]: limit for limit in report["limits"]}
        self.assertTrue(limits["delta_mu"]["pass"], report["limits"])  # The scene has S - K 0.05, known to 0.0013.
        self.assertEqual((limits["mu_k"]["pass"], limits["mu_k"]["outside"]), (False, [0, 1, 2, 3]))
        self.assertEqual(report["groups"][0]["quantities"]["delta_mu"]["count"], 4)
        text = self.report("--batch", batch, folder, "-o", folder / "page.html", "--csv", folder / "table.csv")
        self.assertEqual(self.report("--batch", batch, folder), text)
        self.assertTrue(limits["period_median"]["pass"], report["limits"])
        self.assertIn("FAIL  mu_k – … 0.2: 0 of 4 inside; outside: test 1 2 3 4", text)
        self.assertIn("void, left out: paper torn (ada", text)
        self.assertIn("paper torn", (folder / "page.html").read_text(encoding="utf-8"))
        rows = list(csv.DictReader(io.StringIO((folder / "table.csv").read_text(encoding="utf-8"))))
        self.assertEqual([row["voided"] for row in rows], ["", "", "", "", "paper torn"])
        self.assertEqual(rows[4]["mu_s"], "")
        # Named one by one it is left out just the same, and alone it is refused.
        self.assertEqual(len(json.loads(self.report(*records, "--json"))["tests"]), 4)
        self.assertIn("paper torn", self.report(records[2], status=2))
        self.assertIn('no batch "x"; it has ' + batch, self.report("--batch", "x", folder, status=2))

        # Without the daemon: it sees what was written beside it.
        self.assertEqual(self.run_cli("void", records[2], "--restore", "--as", "bob").count("counts again"), 1)
        self.assertEqual([test["voided"] for test in self.batch()["tests"]], [None] * 5)
        self.run_cli("batch", "end")
        self.assertIsNone(self.batch())
        self.run_cli("batch", "begin", "--name", "next")

        # Two batches of one folder.
        other = self.measure()
        self.wait_for_tests(1)
        compared = json.loads(self.report("--batch-a", "liner 42", "--batch-b", "next", folder, "--json", command="compare"))
        self.assertEqual([len(compared["a"]["tests"]), [test["file"] for test in compared["b"]["tests"]]], [5, [str(folder / other.name)]])
        for wrong in (["--batch-a", "next", folder], ["--batch-a", "next", "--batch-b", "liner 42"], ["--batch-a", "next", "--batch-b", "liner 42", folder, "--", folder]):
            self.assertIn("both are to be named, and one folder", self.report(*wrong, status=2, command="compare"))

    def test_a_method_plans_its_speed_and_number_and_is_in_the_records(self):
        self.run_cli("batch", "begin", "--name", "liner", "--method", "iso-8295")
        plan = self.batch()["plan"]
        self.assertRegex(plan["method"], "^iso-8295 ")
        self.assertEqual(len(plan["pull_speeds"]), 1)
        with h5py.File(self.measure()) as record:
            self.assertEqual(record["entry/process/method"][()].decode(), plan["method"])
            self.assertEqual(record["entry/instrument/tester/pull_speed"][()], plan["pull_speeds"][0])
        for wrong, why in ((["--method", "iso"], "method: "), (["--limit", "mu=1:2"], 'no result called "mu"'), (["--limit", "mu_k"], "RESULT=LOWEST:HIGHEST"),
                           (["--limit", "mu_k=2:1"], "lowest 2 is above highest 1"), (["--pull-speed", "0 m/s"], "must be above 0"),
                           (["--replicates", "9999", "--slides", "9999"], "more than 10000 tests")):
            self.assertIn(why, self.run_cli("batch", "begin", "--name", "x", *wrong, status=2))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""Control charts on the whole path: the daemon plays simulated tests, then the tester's noise and omega shift; the alarms stand in log, status,
metrics and `stickslip trend`, and go once they are acknowledged.

trend_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import pathlib
import re
import subprocess
import sys
import unittest

from running_daemon import RunningDaemon, wait_for
from schema import complaints

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
TIMES = {"idle": "2 s", "pull": "2 s", "rest": "2 s"}
BEFORE = 30  # Tests in control; a shift of many standard deviations is then told within ten (docs/evidence.md).


class Trend(unittest.TestCase):
    def trend(self, *arguments, status=0):
        done = subprocess.run([str(BUILD / "bin" / "stickslip"), "trend", str(self.records), *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout if status == 0 else done.stderr

    def wait(self, daemon, wanted):
        process, frames = daemon.watch()
        try:
            return wait_for(frames, lambda frame: frame["type"] == "health" and wanted(self.charts(frame["status"])))["status"]
        finally:
            process.kill()
            process.communicate()

    @staticmethod
    def charts(status):
        return {chart["chart"]: chart for chart in status["trend"]["charts"]}

    def test_a_shift_of_noise_and_omega_is_told_everywhere_until_it_is_acknowledged(self):
        daemon = RunningDaemon(self, BUILD, SOURCE, '[sample]\nname = "ref"\n[trend]\nreference = "ref"\n', speed=60, times=TIMES)
        self.records = daemon.folder / "records"
        status = self.wait(daemon, lambda charts: charts and charts["noise"]["test_count"] >= BEFORE)
        description = json.loads((SOURCE / "daemon/control/openapi.json").read_text(encoding="utf-8"))
        self.assertEqual(complaints(status, {"$ref": "#/components/schemas/Status"}, description), [])
        for name in ("reference", "omega", "damping", "zero", "noise", "spikes"):
            self.assertEqual(self.charts(status)[name]["verdict"], "learning", name)
        # A clock that runs faster than the world measures no scan rate.
        self.assertEqual(self.charts(status)["rate"]["verdict"], "off")
        code, log = daemon.end()
        self.assertEqual(code, 0, log)
        self.assertNotIn("trend-", log)

        scene = daemon.folder / "scene.toml"
        text = scene.read_text(encoding="utf-8")
        for was, becomes in (("sd = 0.001 ", "sd = 0.0015 "), ('frequency = "20 Hz"', 'frequency = "20.5 Hz"')):
            self.assertEqual(text.count(was), 1)
            text = text.replace(was, becomes)
        scene.write_text(text, encoding="utf-8")
        daemon.start()
        status = self.wait(daemon, lambda charts: charts and all(charts[name]["alarm"] for name in ("noise", "omega")))
        for name in ("noise", "omega"):
            alarm = self.charts(status)[name]["alarm"]
            self.assertTrue(alarm["rises"])
            self.assertNotEqual(alarm["since_file"], alarm["told_file"])
        self.assertEqual({finding["code"] for finding in status["coded_findings"]} & {"trend-noise", "trend-omega"}, {"trend-noise", "trend-omega"})
        metrics = daemon.ask("GET", "/metrics")[1]
        self.assertIn('\nstickslip_trend_alarm{chart="omega"} 1\n', metrics)
        self.assertIn('\nstickslip_trend_alarm{chart="zero"} 0\n', metrics)
        self.assertIn("omega rose by about", daemon.run("status").stdout)
        # GET /v1/trend has the charts to draw them, as `stickslip trend --json`; a restart and a voiding beside the daemon are there at once.
        code, drawn = daemon.ask("GET", "/v1/trend")
        self.assertEqual((code, complaints(drawn, {"$ref": "#/components/schemas/Trend"}, description)), (200, []))
        points = {chart["chart"]: chart["points"] for chart in drawn["charts"]}
        self.assertGreater(max(points["omega"]["upper"]), drawn["decision_interval"])
        self.assertEqual(points["rate"]["value"], [])
        self.assertEqual(daemon.run("void", self.records / points["zero"]["file"][0], "--reason", "torn").returncode, 0)
        self.trend("--restart", "damping", "--reason", "new coupling")
        # Tests go on: of these the first ones are known.
        again = {chart["chart"]: chart["points"]["file"] for chart in daemon.ask("GET", "/v1/trend")[1]["charts"]}
        self.assertNotIn(points["zero"]["file"][0], again["zero"])
        self.assertFalse(set(points["damping"]["file"]) & set(again["damping"]))
        code, log = daemon.end()
        self.assertEqual(code, 0, log)
        self.assertEqual(len(re.findall(r"tester: omega rose by about .*trend-omega, warning: ", log)), 1, log)

        table = self.trend()
        self.assertLessEqual(max(map(len, table.split("!")[0].splitlines())), 80)
        self.assertRegex(table, r"(?m)^omega +rad/s +\d+ .* alarm$")
        self.assertRegex(table, r"omega rose by about .* with the test of \S+ \(.*\.h5\)")
        self.assertIn(f"stickslip trend {self.records} --restart omega --reason TEXT", table)
        json_of = {chart["chart"]: chart for chart in json.loads(self.trend("--json"))["charts"]}
        # The shift: 0.5 Hz of omega, 0.0005 of the sled's weight in noise.
        # An arm that had risen before by chance takes some tests of before the shift for tests of it.
        for name, shift in (("omega", 2 * 3.14159 * 0.5), ("noise", 0.0005 * 2.331 * 9.80665)):
            told = json_of[name]["alarm"]["shift"]
            self.assertTrue(0.2 * shift < told < 1.5 * shift, f"{name}: {told}, {shift} is true")

        self.assertIn("--reason: is missing", self.trend("--restart", "omega", status=2))
        self.assertIn("no chart; there are reference, omega", self.trend("--restart", "omeega", "--reason", "x", status=2))
        after = self.trend("--restart", "omega", "--reason", "new coupling", "--as", "ada")
        self.assertRegex(after, r"(?m)^omega +rad/s +0 .* off$")
        self.assertRegex(after, r"(?m)^noise .* alarm$")
        self.assertRegex(self.trend("--restart", "all", "--baseline-stays", "--reason", "nothing found"), r"(?m)^noise .* learning$")

    def test_records_are_added_by_hand_once_and_those_older_than_the_history_are_told(self):
        daemon = RunningDaemon(self, BUILD, SOURCE, speed=60, repeats=3, times=TIMES)
        self.records = daemon.folder / "records"
        daemon.process.wait()
        daemon.end()
        history = self.records / "tester-history.jsonl"
        self.assertIn(" 3 ", re.search(r"(?m)^noise .*", self.trend())[0])
        history.unlink()
        self.assertIn("--add", self.trend(status=1))
        files = sorted(map(str, self.records.glob("*.h5")))
        self.assertIn(" 2 ", re.search(r"(?m)^noise .*", self.trend("--add", *files[1:]))[0])
        again = subprocess.run([str(BUILD / "bin" / "stickslip"), "trend", str(self.records), "--add", *files], capture_output=True, text=True, check=True)
        self.assertIn("1 of 3 records are older", again.stderr)
        self.assertIn(" 2 ", re.search(r"(?m)^noise .*", again.stdout)[0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

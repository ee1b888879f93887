#!/usr/bin/env python3
"""Facts of a test (temperature, lot …) from configuration, plan, batch and broker: in its record, found again, in the report.

facts_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py

from broker import MOSQUITTO, Broker
from running_daemon import PATIENT, TIMEOUT_S, RunningDaemon, wait_for

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


class Facts(unittest.TestCase):
    def begin(self, config, **options):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, config, speed=20, times=PATIENT, **options)
        process, self.frames = self.daemon.watch()
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return self.daemon

    def wait_for_log(self, daemon, words):
        while words not in daemon.unread.get(timeout=TIMEOUT_S):
            pass

    def good(self, *arguments):
        done = self.daemon.run(*arguments, *(() if arguments[0] == "status" else ("--as", "ada")))
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def record(self):
        """Of a test that is begun and ended by command."""
        self.daemon.wait_for_rest(self.frames)
        status, began = self.daemon.ask("POST", "/v1/start")
        self.assertEqual(status, 200, began)
        wait_for(self.frames, lambda frame: frame["type"] == "test-began")
        self.daemon.ask("POST", "/v1/stop")
        return self.daemon.record(began["test"])

    def stated(self, record):
        with h5py.File(record) as file:
            if "metadata" not in file["entry"]:
                return {}
            return {key: text.asstr()[()] for key, text in file["entry/metadata"].items()}

    def numbers(self, record):
        with h5py.File(record) as file:
            sample = file["entry/sample"]
            return {key: (round(float(sample[key][()]), 9), sample[key].attrs["units"]) for key in ("temperature", "humidity", "contact_time", "lot") if key in sample}

    def told(self, facts):
        """Waits until the status says so."""
        wait_for(self.frames, lambda _: self.daemon.ask("GET", "/v1/status")[1]["next_facts"] == facts)

    def test_of_configuration_plan_and_batch_are_in_the_records_and_found_again(self):
        daemon = self.begin('[test]\nbegins = "command"\n[sample]\nfacts = ["temperature=73.4 degF", "lot = 1"]\n')
        record = self.record()
        self.assertEqual(self.stated(record), {"temperature": "73.4 degF", "lot": "1"})
        self.assertEqual(self.numbers(record), {"temperature": (23.0, "degC")})
        self.good("plan", "--name", "liner", "--fact", "lot=2", "--fact", "temperature=", "--fact", "humidity=52 %", "--fact", "room=lab 2")
        self.assertEqual(daemon.ask("GET", "/v1/status")[1]["next_facts"], {"humidity": "52 %", "lot": "2", "room": "lab 2"})
        self.assertRegex(self.good("plan"), r"(?m)^fact room +lab 2$")
        refused = daemon.run("plan", "--fact", "humidity=52")
        self.assertEqual(refused.returncode, 2)
        self.assertIn('--fact: humidity: "52" is not within 0 … 1; write it like "50 %"', refused.stderr)
        record = self.record()
        self.assertEqual(self.stated(record), {"humidity": "52 %", "lot": "2", "room": "lab 2"})
        self.assertEqual(self.numbers(record), {"humidity": (0.52, "1")})
        with h5py.File(record) as file:
            self.assertGreater(file["entry/instrument/tester/pull_speed"][()], 0.0)  # Of the scene: no plan has said one.
        # A request without facts leaves them.
        status, plan = daemon.ask("PUT", "/v1/plan", {"name": "bag"})
        self.assertEqual((status, plan["name"], plan["facts"]["lot"]), (200, "bag", "2"))
        # A batch states facts of its own for all its tests, and takes no lot of another sample. Other facts may change while it leads.
        self.good("batch", "begin", "--name", "liner", "--replicates", "4", "--fact", "shift=3")
        self.assertEqual(self.stated(self.record()), {"humidity": "52 %", "shift": "3", "room": "lab 2"})
        self.good("plan", "--fact", "humidity=53 %")
        self.assertEqual(self.stated(self.record())["humidity"], "53 %")
        for wanted in ({"facts": {"shift": "5"}}, {"facts": {}}, {"name": "bag"}):
            plan = daemon.ask("GET", "/v1/plan")[1]
            del plan["pull_speed"]
            status, said = daemon.ask("PUT", "/v1/plan", {**plan, **wanted})
            self.assertEqual(status, 409, wanted)
            self.assertIn("(liner) states all but some facts of its tests: end it first (stickslip batch end", said["error"])
        refused = daemon.run("batch", "begin", "--name", "liner", "--fact", "lot=")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("stickslip plan --fact lot=", refused.stderr)

        # After a restart in the batch its facts hold again, and those of the configuration.
        self.assertEqual(daemon.end()[0], 0)
        daemon.start()
        self.assertEqual(daemon.ask("GET", "/v1/status")[1]["next_facts"], {"temperature": "73.4 degF", "shift": "3"})
        self.assertRegex(self.good("status"), r"(?m)^next facts +shift 3, temperature 73.4 degF$")

        def cli(*arguments):
            return subprocess.run([daemon.cli, *arguments], capture_output=True, text=True, timeout=TIMEOUT_S, check=True, cwd=daemon.folder).stdout

        self.assertEqual(cli("find", "records", "--fact", "lot=2", "--fact", "humidity=50 %:54 %", "--paths").split(), [f"records/{record.name}"])
        self.assertRegex(cli("report", str(record)), r"(?m)^lot +2$")
        self.assertRegex(cli("report", str(record)), r"(?m)^climate +52 %$")
        self.assertRegex(cli("show", str(record)), r"(?m)^ +metadata\.room +lab 2$")
        config = daemon.folder / "d.toml"
        config.write_text(config.read_text(encoding="utf-8").replace("73.4 degF", "warm"), encoding="utf-8")
        refused = subprocess.run([BUILD / "bin" / "stickslipd", "--check-config", config], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(refused.returncode, 2, refused.stdout)
        self.assertRegex(refused.stderr, 'facts.*temperature: "warm" does not begin with a decimal number.*degC, K, degF')

    @unittest.skipIf(MOSQUITTO is None, "no mosquitto: ./dev deps test")
    def test_that_a_logger_tells_the_broker_replace_those_of_the_plan_until_they_are_old(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        broker = Broker(self, temporary.name)

        def tell(text, *arguments):
            subprocess.run(["mosquitto_pub", "-V", "5", "-h", "127.0.0.1", "-p", str(broker.port), "-q", "1", "-t", "stickslip/bench-7/facts", "-m", text, *arguments],
                           check=True, timeout=TIMEOUT_S)

        # Its age is not known.
        tell('{"room": "old"}', "-r")
        daemon = self.begin(f'[test]\nbegins = "command"\n[sample]\nfacts = ["temperature=20 degC", "lot=1"]\n[fleet]\nbroker = "mqtt://127.0.0.1:{broker.port}"\n'
                             'tester = "bench-7"\nfacts_valid = "1 h"\n')
        wait_for(self.frames, lambda _: daemon.ask("GET", "/v1/status")[1]["fleet"]["state"] == "connected")
        tell('{"temperature": "23.1 degC", "humidity": "50 %"}')
        self.told({"temperature": "23.1 degC", "humidity": "50 %", "lot": "1"})
        tell('{"humidity": 51}')
        self.wait_for_log(daemon, "facts: humidity: must be text")
        tell('{"humidity": "51 %"}')
        self.told({"temperature": "23.1 degC", "humidity": "51 %", "lot": "1"})
        record = self.record()
        self.assertEqual(self.stated(record), {"temperature": "23.1 degC", "humidity": "51 %", "lot": "1"})
        self.assertEqual(self.numbers(record), {"temperature": (23.1, "degC"), "humidity": (0.51, "1")})
        # The plan is as it was said.
        self.assertEqual(daemon.ask("GET", "/v1/plan")[1]["facts"], {"temperature": "20 degC", "lot": "1"})
        self.good("plan", "--fact", "lot=2")
        self.told({"temperature": "23.1 degC", "humidity": "51 %", "lot": "2"})
        with h5py.File(record) as file:
            self.assertGreater(file["entry/instrument/tester/pull_speed"][()], 0.0)
        tell('{"humidity": null}')
        self.told({"temperature": "23.1 degC", "lot": "2"})
        tell(json.dumps({f"k{k}": "x" for k in range(20)}))
        self.wait_for_log(daemon, "21 facts, at most 20 are taken: tell fewer")
        tell("x" * 70_000)
        self.wait_for_log(daemon, "a message of 70000 bytes; send at most 65536")
        # The topic is asked for again where the broker has restarted.
        broker.stop()
        broker.start()
        wait_for(self.frames, lambda _: daemon.ask("GET", "/v1/status")[1]["fleet"]["state"] == "connected")
        tell('{"humidity": "55 %"}')
        self.told({"temperature": "23.1 degC", "humidity": "55 %", "lot": "2"})
        self.assertEqual(daemon.end()[0], 0)

        # What is too old is forgotten, in records as well; each fact by its own age.
        old = RunningDaemon(self, BUILD, SOURCE, f'[sample]\nfacts = ["lot=1"]\n[fleet]\nbroker = "mqtt://127.0.0.1:{broker.port}"\ntester = "bench-7"\nfacts_valid = "1 ms"\n[test]\nbegins = "command"\n',
                            speed=20, times=PATIENT)
        process, self.frames = old.watch()
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        wait_for(self.frames, lambda _: old.ask("GET", "/v1/status")[1]["fleet"]["state"] == "connected")
        tell('{"temperature": "23.1 degC"}')
        self.wait_for_log(old, "no message for 0.001 s about temperature: tests have the plan's facts")
        self.daemon = old
        self.assertEqual(self.stated(self.record()), {"lot": "1"})
        self.assertEqual(old.end()[0], 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""The control interface of the running daemon: commands, plan, leases, the live stream, and its OpenAPI description,
of which every path, method and answer is exercised and validated.

control_test.py BUILD_DIR SOURCE_DIR [unittest arguments]

Nothing here sleeps: each step waits for an answer or for a frame of the live stream.
"""

import contextlib
import csv
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

from hanging import Hanging, weighing_board
from running_daemon import PATIENT, TIMEOUT_S, RunningDaemon, UnixConnection, wait_for
from schema import complaints
from stored import stored as stored_in

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"


class Daemon(RunningDaemon):
    def __init__(self, test, config="", **options):
        # Half the frames of the other tests: a client that a sanitizer slows down reads them as they come.
        super().__init__(test, BUILD, SOURCE, config, speed=5, times=PATIENT, **options)


@contextlib.contextmanager
def unwritable(file):
    """A folder in its place: what is no file cannot be appended to, by root either."""
    kept = file.with_suffix(".kept")
    file.rename(kept)
    file.mkdir()
    yield
    file.rmdir()
    kept.rename(file)


class Commands(unittest.TestCase):
    def watching(self, daemon):
        process, frames = daemon.watch()
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        wait_for(frames, lambda frame: True)
        return frames

    def test_a_test_that_people_begin_mark_and_end_is_recorded_with_what_they_did_and_replays(self):
        daemon = Daemon(self, '[test]\nbegins = "command"\n')
        frames = self.watching(daemon)
        self.assertEqual(daemon.ask("GET", "/v1/status")[1]["bench"], "idle")
        status, plan = daemon.ask("PUT", "/v1/plan", {"name": "liner 42", "operator": "Ada", "replicate": 3, "pull_speed": "12 in/min"})
        self.assertEqual(status, 200, plan)
        daemon.wait_for_rest(frames)
        status, started = daemon.ask("POST", "/v1/start", {"test": 1}, key="k")
        self.assertEqual((status, started["test"], started["already"]), (200, 1, False))
        self.assertEqual(daemon.ask("POST", "/v1/start", {"test": 1}, key="k"), (200, started))
        self.assertEqual(daemon.reply.headers["Idempotency-Replayed"], "true")
        began = wait_for(frames, lambda frame: frame["type"] == "test-began")
        self.assertTrue(began["by_command"])
        self.assertEqual(daemon.ask("POST", "/v1/start", {"test": 1})[1]["already"], True)
        self.assertEqual(daemon.ask("POST", "/v1/start")[0], 409)
        # A slip is told as it begins, and again with all that is known when it is over.
        fell = wait_for(frames, lambda frame: frame["type"] == "fall")
        slipped = wait_for(frames, lambda frame: frame["type"] == "cycle")
        self.assertEqual((fell["test"], slipped["number"]), (1, 0))
        self.assertLessEqual(abs(fell["peak_scan"] - slipped["first_scan"]), 1)
        self.assertLess(fell["peak_scan"], fell["seen_scan"] - 3)
        wait_for(frames, lambda frame: frame["type"] == "cycle" and frame["number"] == 3)
        status, marked = daemon.ask("POST", "/v1/mark", {"text": "gewölbt"})
        self.assertEqual(status, 200)
        wait_for(frames, lambda frame: frame["type"] == "cycle" and frame["number"] == 5)
        status, stopped = daemon.ask("POST", "/v1/stop", {"test": 1})
        self.assertEqual((status, stopped["test"]), (200, 1))
        self.assertIn(stopped["bench"], ("finishing", "idle"))  # The record may be made before the answer is.
        ended = wait_for(frames, lambda frame: frame["type"] == "test-ended")
        self.assertEqual(ended["cause"], "command")
        self.assertEqual(daemon.ask("POST", "/v1/stop", {"test": 1})[1]["already"], True)
        file = daemon.record(1)
        code, log = daemon.end()
        self.assertEqual(code, 0, log)
        with h5py.File(file) as record:
            events = [(int(scan), text.decode()) for scan, text in zip(record["entry/events/scan"][()], record["entry/events/text"][()])]
            said = [event for event in events if event[1].startswith(("command", "mark"))]
            self.assertEqual(said, [(began["trigger_scan"], "command: start, by ada"), (marked["scan"], "mark: gewölbt"),
                                    (stopped["scan"], "command: stop, by ada")])
            self.assertEqual(record["entry/process/end_cause"].asstr()[()], "command")
            self.assertEqual(record["entry/process/status"].asstr()[()], "complete")
            self.assertEqual(record["entry/sample/name"].asstr()[()], "liner 42")
            self.assertEqual(record["entry/sample/replicate"][()], 3)
            self.assertEqual(record["entry/user/name"].asstr()[()], "Ada")
            self.assertAlmostEqual(record["entry/instrument/tester/pull_speed"][()], 0.00508, delta=1e-17)
            verdict = subprocess.run([str(CLI), "verify", str(file)], capture_output=True, text=True, check=False)
            self.assertEqual(verdict.returncode, 0, verdict.stdout)

        again = Daemon(self, board=f'[board]\ndriver = "replay"\nclock_speed = 50\n[board.replay]\nfile = "{file}"\n')
        again.process.wait(timeout=TIMEOUT_S)
        [copy] = (again.folder / "records").glob("*.h5")
        with h5py.File(file) as a, h5py.File(copy) as b:
            numpy.testing.assert_array_equal(a["entry/raw/counts"][()], b["entry/raw/counts"][()])
            for name, stored in stored_in(a).items():
                numpy.testing.assert_array_equal(stored[()], stored_in(b)[name][()], err_msg=name)
            self.assertEqual([event[1] for event in events], [text.decode() for text in b["entry/events/text"][()]])
            self.assertEqual([event[0] for event in events], [int(scan) for scan in b["entry/events/scan"][()]])

    def test_the_command_line_says_it_all_too(self):
        daemon = Daemon(self, '[test]\nbegins = "command"\n')
        frames = self.watching(daemon)
        planned = daemon.run("plan", "--name", "liner", "--replicate", "2", "--pull-speed", "12 in/min", "--as", "bob")
        self.assertEqual(planned.returncode, 0, planned.stderr)
        self.assertIn("0.00508 m/s", planned.stdout)
        kept = daemon.run("plan", "--side", "wire", "--as", "bob", "--json")
        told = json.loads(kept.stdout)
        self.assertAlmostEqual(told.pop("pull_speed"), 0.00508, delta=1e-17)
        self.assertEqual(told, {"name": "liner", "grade": None, "direction": None, "side": "wire", "operator": None, "replicate": 2, "facts": {}})
        refused = daemon.run("start", "--as", "ada")
        self.assertEqual(refused.returncode, 1)
        self.assertRegex(refused.stderr, r"^stickslip: refused: bob has the bench for another \d+ s")
        daemon.wait_for_rest(frames)
        started = daemon.run("start", "--as", "bob")
        self.assertEqual(started.returncode, 0, started.stderr)
        self.assertRegex(started.stdout, r"^start: loading; test 1, scan \d+\n$")
        wait_for(frames, lambda frame: frame["type"] == "cycle")
        self.assertEqual(daemon.run("mark", "here", "--as", "bob").returncode, 0)
        self.assertRegex(daemon.run("tare", "--as", "bob").stderr, "a test is running")
        self.assertEqual(json.loads(daemon.run("stop", "--as", "bob", "--json").stdout)["test"], 1)
        wait_for(frames, lambda frame: frame["type"] == "test-ended")
        self.assertRegex(daemon.run("list").stdout, r"\n +1 .* command ")
        self.assertEqual(len(json.loads(daemon.run("list", "--json").stdout)["tests"]), 1)
        shown = daemon.run("show", "1").stdout
        self.assertRegex(shown, r"(?m)^  mu_s +0\.\d+ ± ")
        self.assertRegex(shown, r"(?m)^rung: [a-z]")
        self.assertEqual(daemon.run("show", "2").returncode, 2)

    def test_the_status_says_where_the_page_is_and_tells_nobody_its_token(self):
        daemon = Daemon(self, 'http = "127.0.0.1:0"\ntoken_file = "token"\n')
        token_file = daemon.folder / "token"
        page = daemon.ask("GET", "/v1/status")[1]["page"]
        self.assertEqual(page, {"address": f"http://{daemon.port_line()}/", "token_file": str(token_file)})
        said = daemon.run("status").stdout
        token = token_file.read_text(encoding="ascii").strip()
        self.assertNotIn(token, said)
        # Pasted into a shell it is the whole address.
        pasted = re.search(r"(?m)^page +(\S.*)$", said)[1]
        shell = subprocess.run(["bash", "-c", f'echo "{pasted}"'], capture_output=True, text=True, check=True, timeout=TIMEOUT_S)
        self.assertEqual(shell.stdout, f"{page['address']}#token={token}\n")

    def test_the_page_opens_by_one_command(self):
        daemon = Daemon(self, 'http = "127.0.0.1:0"\ntoken_file = "token"\n')
        token = (daemon.folder / "token").read_text(encoding="ascii").strip()
        whole = f"http://{daemon.port_line()}/#token={token}"
        self.assertEqual(daemon.run("page", "--print").stdout, f"{whole}\n")
        # On a desktop its browser is started; this one writes down what it was given.
        browser, opened = daemon.folder / "xdg-open", daemon.folder / "opened"
        os.mkfifo(opened)
        browser.write_text(f'#!/bin/sh\nprintf %s "$1" > "{opened}"\n', encoding="ascii")
        browser.chmod(0o755)
        desktop = dict(os.environ, DISPLAY=":0", PATH=f"{daemon.folder}:{os.environ['PATH']}")
        done = daemon.run("page", environment=desktop)
        self.assertEqual(opened.read_text(encoding="ascii"), whole)
        self.assertNotIn(token, done.stdout)
        # Without one the address is printed.
        bare = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
        self.assertEqual(daemon.run("page", environment=bare).stdout, f"{whole}\n")

    def test_without_a_port_there_is_no_page(self):
        daemon = Daemon(self)
        refused = daemon.run("page")
        self.assertEqual(refused.returncode, 2)
        self.assertIn('set http = "127.0.0.1:8037" in [control]', refused.stderr)
        self.assertIsNone(daemon.ask("GET", "/v1/status")[1]["page"])
        self.assertNotRegex(daemon.run("status").stdout, "(?m)^page")

    def test_a_tare_moves_the_zero_of_all_tests_that_follow(self):
        daemon = Daemon(self, '[test]\nbegins = "command"\n[tester]\nload_cell_zero = "0.004 V"\n')
        frames = self.watching(daemon)
        # Before the pull the scene rests: the first scans are unloaded. Tried until enough of them have come.
        for frame in frames:
            status, tared = daemon.ask("POST", "/v1/tare")
            if status == 200:
                break
            self.assertRegex(tared["error"], "scans of the unloaded bench|that is a load")
        self.assertGreater(tared["scan_count"], 59)
        error = tared["zero_standard_error"]
        self.assertGreater(error, 0)
        self.assertEqual(daemon.ask("POST", "/v1/start")[0], 200)
        wait_for(frames, lambda frame: frame["type"] == "test-began")
        self.assertEqual(daemon.ask("POST", "/v1/stop")[0], 200)
        with h5py.File(daemon.record(1)) as record:
            self.assertEqual(record["entry/instrument/calibration/zero"][()], tared["zero"])
            texts = [text.decode() for text in record["entry/events/text"][()]]
        self.assertTrue(any(re.match(r"bench: zero of the load cell set from 0.004 V to .* by ada", text) for text in texts), texts)


class Description(unittest.TestCase):
    """Each answer that openapi.json promises is got from a running daemon and fits its schema."""

    def setUp(self):
        self.hanging = Hanging(self)
        # The reports of this daemon come from a program that can be held, by a pipe that it reads first, and broken.
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="stickslip-")))
        self.pipe, self.broken = folder / "pipe", folder / "broken"
        shutil.copy(BUILD / "bin" / "stickslipd", folder)
        (folder / "stickslip").write_text(f'#!/bin/sh\n[ -p {self.pipe} ] && /bin/cat {self.pipe}\n[ -e {self.broken} ] && echo "stickslip: broken" >&2 && exit 1\nexec {CLI} "$@"\n', encoding="utf-8")
        (folder / "stickslip").chmod(0o700)
        self.daemon = Daemon(self, '[test]\nbegins = "command"\n', board=weighing_board(self, SOURCE, speed=10), program=folder / "stickslipd")
        self.document = self.daemon.ask("GET", "/v1/openapi.json")[1]
        self.seen = set()
        self.keys = 0

    def check(self, method, path, *arguments, template=None, **options):
        if method == "GET" or options.get("who", "ada") is None:
            return self.check_once(method, path, *arguments, template=template, **options)
        # What was done is known by its key, and what was refused is not.
        self.keys += 1
        options.setdefault("key", f"own key {self.keys}")
        answered = self.check_once(method, path, *arguments, template=template, **options)
        if answered[0] == 200:
            self.assertEqual(self.check_once(method, path, '{"y": 1}', template=template, **options)[0], 422)
            self.assertEqual(self.check_once(method, path, *arguments, template=template, **options), answered)
        return answered

    def check_once(self, method, path, *arguments, template=None, **options):
        status, body = self.daemon.ask(method, path, *arguments, **options)
        described = self.document["paths"][template or path][method.lower()]["responses"]
        self.assertIn(str(status), described, f"{method} {path}: {body}")
        content = described[str(status)]["content"][self.daemon.reply.headers["Content-Type"].partition(";")[0]]
        self.assertEqual(complaints(body, content["schema"], self.document), [], f"{method} {path} {status}")
        self.seen.add((template or path, method.lower(), str(status)))
        return status, body

    def test_every_path_method_and_answer_is_as_described(self):
        for path in ("/v1/status", "/v1/openapi.json", "/v1/tests", "/v1/trend", "/v1/plan", "/v1/batch", "/v1/batches", "/v1/controller", "/v1/calibration", "/metrics"):
            self.assertEqual(self.check("GET", path)[0], 200)
        self.assertEqual(self.check("GET", "/v1/live")[0], 426)
        self.crowd()
        self.check("GET", "/v1/tests/1", template="/v1/tests/{number}")
        self.assertEqual(self.check("GET", "/v1/tests/1/trace", template=self.TRACE)[0], 404)
        changing = [("PUT", "/v1/plan", {"name": "x"}), ("PUT", "/v1/controller", {"seconds": 60}), ("POST", "/v1/arm", None),
                    ("POST", "/v1/stop", None), ("POST", "/v1/start", None), ("POST", "/v1/mark", {"text": "x"}), ("POST", "/v1/tare", None),
                    ("POST", "/v1/calibration", None), ("POST", "/v1/calibration/weight", {"mass": 0}), ("POST", "/v1/calibration/undo", None),
                    ("POST", "/v1/calibration/finish", None), ("DELETE", "/v1/calibration", None),
                    ("POST", "/v1/batch", {"name": "liner"}), ("POST", "/v1/void", {"test": 1, "reason": "torn"}), ("POST", "/v1/restore", {"test": 1}),
                    ("DELETE", "/v1/batch", None), ("DELETE", "/v1/controller", None)]
        for at, (method, path, body) in enumerate(changing):
            self.assertEqual(self.check(method, path, body, who=None)[0], 400)
            key = f"key {at}"
            self.check(method, path, body, key=key)
            # What cannot be done by anybody yet is refused for that.
            if path not in ("/v1/controller", "/v1/void", "/v1/restore") or method == "PUT":
                self.assertEqual(self.check(method, path, body, who="bob")[0], 409, path)
        # Back to ada, so that bob cannot give it away.
        self.check("PUT", "/v1/controller", {"seconds": 60})
        self.assertEqual(self.check("DELETE", "/v1/controller", None, who="bob")[0], 409)
        # Bob takes it over from who has it, and from nobody else.
        status, body = self.check("PUT", "/v1/controller", {"seconds": 60, "from": "eve"}, who="bob")
        self.assertEqual(status, 409)
        self.assertIn("ada has the bench", body["error"])
        self.assertEqual(self.check("PUT", "/v1/controller", {"seconds": 60, "from": "ada"}, who="bob")[1]["controller"], "bob")
        self.assertEqual(self.check("PUT", "/v1/controller", {"from": 1}, who="bob")[0], 400)
        self.assertEqual(self.check("PUT", "/v1/controller", {"seconds": 60, "from": "bob"})[1]["controller"], "ada")
        # What has been refused so far, granted: mark in a test, tare where the load cell is unloaded.
        process, frames = self.daemon.watch()
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        wait_for(frames, lambda frame: True)
        self.check("POST", "/v1/stop")
        self.calibrate(frames)
        self.daemon.wait_for_rest(frames)
        for _ in frames:
            if self.check("POST", "/v1/start", {})[0] == 200:
                break
        wait_for(frames, lambda frame: frame["type"] == "cycle")
        running = self.daemon.ask("GET", "/v1/status")[1]["current_test"]
        status, body = self.check("GET", f"/v1/tests/{running}/trace", template=self.TRACE)
        self.assertEqual(status, 409)
        self.assertIn(f"test {running} is running", body["error"])
        self.assertEqual(self.check("POST", "/v1/mark", {"text": "x"})[0], 200)
        self.assertEqual(self.check("POST", "/v1/stop", {})[0], 200)
        for _ in frames:
            if self.check("POST", "/v1/tare")[0] == 200:
                break
        record = self.daemon.record(1)
        self.traces(record)
        self.assertEqual(self.check("POST", "/v1/restore", {"test": 1})[0], 409)
        self.assertEqual(self.check("POST", "/v1/void", {"test": 1, "reason": "paper torn"})[0], 200)
        status, body = self.check("GET", "/v1/tests/1/trace", template=self.TRACE)
        self.assertEqual(status, 409)
        self.assertIn("test 1 is void: paper torn", body["error"])
        self.assertEqual(self.check("POST", "/v1/void", {"record": record.name, "reason": "again"})[0], 409)
        self.assertEqual(self.check("GET", "/v1/tests/1", template="/v1/tests/{number}")[1]["voided"]["reason"], "paper torn")
        self.assertEqual(self.check("GET", "/v1/tests")[0], 200)
        with unwritable(record.parent / "batches.jsonl"):
            self.assertEqual(self.check("POST", "/v1/restore", {"test": 1})[0], 507)
            self.assertEqual(self.check("POST", "/v1/batch", {"name": "liner"})[0], 507)
        self.assertEqual(self.check("POST", "/v1/restore", {"record": record.name})[0], 200)
        with unwritable(record.parent / "batches.jsonl"):
            self.assertEqual(self.check("POST", "/v1/void", {"test": 1, "reason": "paper torn"})[0], 507)
        self.assertEqual(self.check("POST", "/v1/batch", {"name": "liner", "limits": {"mu_k": {"highest": 0.4}}})[0], 200)
        self.assertEqual(self.check("GET", "/v1/status")[1]["batch"]["next"]["slide"], 1)
        self.assertEqual(self.check("PUT", "/v1/plan", {"name": "x"})[0], 409)
        with unwritable(record.parent / "batches.jsonl"):
            self.assertEqual(self.check("DELETE", "/v1/batch")[0], 507)
        self.reports(record)
        self.records(record)
        self.assertEqual(self.check("DELETE", "/v1/batch")[0], 200)
        status, body = self.check("GET", f"/v1/records/{record.name}", template="/v1/records/{name}")
        self.assertEqual((status, body), (200, record.read_bytes()))
        # Names are compared and open nothing.
        for name in ("x.h5", "..%2Fd.toml", "../d.toml", f"../records/{record.name}", f"./{record.name}", str(record), record.name + "%00", "."):
            self.assertEqual(self.check("GET", f"/v1/records/{name}", template="/v1/records/{name}")[0], 404, name)
        # 101 is what `watch` above got.
        self.seen.add(("/v1/live", "get", "101"))
        promised = {(path, method, status) for path, methods in self.document["paths"].items() for method, one in methods.items()
                    for status in one["responses"]}
        self.assertEqual(promised - self.seen, set())

    def crowd(self):
        """As many as there is room for listen, and one more asks."""
        listening = []
        for _ in range(24):
            one = UnixConnection(self.daemon.socket)
            one.request("GET", "/v1/live", headers={"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
                                                    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="})
            self.assertEqual(one.getresponse().status, 101)
            listening.append(one)
        while self.check("GET", "/v1/live")[0] != 503:
            pass
        for one in listening:
            one.close()
        while self.check("GET", "/v1/live")[0] != 426:
            pass

    TRACE = "/v1/tests/{number}/trace"

    def traces(self, record):
        """Lowest and highest of each bin are those of the record's scans; a span has each scan of its own."""
        with h5py.File(record) as file:
            scans, force = file["entry/raw/scan"][()], file["entry/raw/force"][()]
            tester = file["entry/instrument/tester"]
            coefficient = force / (tester["sled_mass"][()] * tester["gravity"][()])
            rate = float(file["entry/timing/scan_rate_granted"][()])
            cycles = {name: file[f"entry/cycles/{name}"][()] for name in ("peak_time", "peak", "trough")}
            cycles["captured"] = (file["entry/cycles/flags"][()] & 8) != 0
            levels = [float(file[f"entry/results/{name}"][()]) for name in ("mu_s", "mu_k")]
        at = scans - scans[0]

        def compare(told, first, end):
            width = told["scans_in_bin"]
            self.assertEqual(len(told["time"]), -(-(end - first) // width))
            for k, (time, low, high) in enumerate(zip(told["time"], told["lowest"], told["highest"], strict=True)):
                self.assertAlmostEqual(time, (first + k * width) / rate, delta=1e-6)
                part = coefficient[(at >= first + k * width) & (at < min(first + (k + 1) * width, end))]
                self.assertAlmostEqual(low, part.min(), delta=2e-6)  # Single precision in the record, six decimals on the way.
                self.assertAlmostEqual(high, part.max(), delta=2e-6)
        status, whole = self.check("GET", "/v1/tests/1/trace?points=50", template=self.TRACE)
        self.assertEqual((status, whole["scan_count"]), (200, len(scans)))
        self.assertEqual(whole["scans_in_bin"], -(-(at[-1] + 1) // 50))
        compare(whole, 0, at[-1] + 1)
        for value, told in zip(levels, (whole["mu_s"], whole["mu_k"]), strict=True):
            self.assertTrue(told is None if numpy.isnan(value) else abs(told - value) < 1e-6)
        # However long the test was on a busy machine: with fewer points than cycles these are left out.
        status, full = self.check("GET", "/v1/tests/1/trace?points=20000", template=self.TRACE)
        self.assertEqual((status, full["left_out_cycles"]), (200, 0))
        for name, column in cycles.items():
            numpy.testing.assert_allclose(numpy.array(full["cycles"][name], dtype=float), column, atol=1e-6, err_msg=name)
        first, end = len(scans) // 2, len(scans) // 2 + 40
        status, part = self.check("GET", f"/v1/tests/1/trace?from={first / rate:.6f}&to={(end - 1) / rate:.6f}", template=self.TRACE)
        self.assertEqual((status, part["scans_in_bin"], len(part["time"])), (200, 1, 40))
        compare(part, first, end)
        self.assertEqual(self.check("GET", "/v1/tests/1/trace?points=1", template=self.TRACE)[1]["left_out_cycles"], 0 if len(cycles["peak"]) < 2 else len(cycles["peak"]))
        for wrong in ("points=0", "points=1.5", "points=20001", "points=x", "from=-1", "from=x", "from=1&to=1", "to=nan", "x=1", "from=1&from=2"):
            self.assertEqual(self.check("GET", f"/v1/tests/1/trace?{wrong}", template=self.TRACE)[0], 400, wrong)
        status, body = self.check("GET", "/v1/tests/1/trace?from=1000", template=self.TRACE)
        self.assertEqual(status, 409)
        self.assertIn("the end of the record", body["error"])
        for number in ("99", "x", "1/x", "..", "-1"):
            self.assertEqual(self.check("GET", f"/v1/tests/{number}/trace", template=self.TRACE)[0], 404, number)
        os.mkfifo(self.pipe)
        held = UnixConnection(self.daemon.socket)
        held.request("GET", "/v1/tests/1/trace")
        with self.pipe.open("w", encoding="utf-8"):  # Opens when the program reads.
            self.assertEqual(self.check("GET", "/v1/tests/1/trace", template=self.TRACE)[0], 503)
        self.assertEqual(held.getresponse().status, 200)
        held.close()
        self.pipe.unlink()
        record.rename(record.with_suffix(".kept"))
        status, body = self.check("GET", "/v1/tests/1/trace", template=self.TRACE)
        self.assertEqual(status, 409)
        self.assertIn(f"{record.name}: there is no such file", body["error"])
        record.with_suffix(".kept").rename(record)

    def records(self, record):
        """The search, and trace and report of what it finds."""
        self.assertEqual(self.check("POST", "/v1/void", {"test": 1, "reason": "paper torn"})[0], 200)
        search = "/v1/records"
        status, found = self.check("GET", "/v1/records?sample=*&most=1000", template=search)
        self.assertEqual(status, 200)
        # Without HOME and XDG_CACHE_HOME this daemon keeps no index, and says so.
        self.assertRegex(found["notices"][0], "set XDG_CACHE_HOME")
        one = next(one for one in found["records"] if one["record"] == record.name)
        self.assertEqual(one["voided"]["reason"], "paper torn")
        self.assertEqual(self.check("GET", "/v1/records?sample=none%20such", template=search)[1]["count"], 0)
        for wrong in ("from=2026-13-01", "where=S", "where=x%3D1:2", "regime=slip", "finding=x", "fact=x", "most=0", "x=1", "to=now"):
            status, body = self.check("GET", f"/v1/records?{wrong}", template=search)
            self.assertEqual((status, body["error"].split("=")[0].split(" ")[0].rstrip(":")), (400, wrong.split("=")[0]), wrong)
        path, trace, report = f"/v1/records/{record.name}", "/v1/records/{name}/trace", "/v1/records/{name}/report"
        self.assertEqual(self.check("GET", f"{path}/trace", template=trace)[0], 409)
        self.assertEqual(self.check("POST", "/v1/restore", {"record": record.name})[0], 200)
        self.assertEqual(self.check("GET", f"{path}/trace?points=50", template=trace)[1], self.daemon.ask("GET", "/v1/tests/1/trace?points=50")[1])
        self.assertTrue(self.check("GET", f"{path}/report", template=report)[1].startswith("<!DOCTYPE html>"))
        self.assertEqual(len(self.check("GET", f"{path}/report?format=json", template=report)[1]["tests"]), 1)
        self.assertIn(record.name, self.check("GET", f"{path}/report?format=csv", template=report)[1])
        for what, template in (("trace", trace), ("report", report)):
            self.assertEqual(self.check("GET", f"{path}/{what}?x=1", template=template)[0], 400)
            for name in ("x.h5", "..%2Fd.toml", "../d.toml", f"../records/{record.name}", f"./{record.name}", str(record), "."):
                self.assertEqual(self.check("GET", f"/v1/records/{name}/{what}", template=template)[0], 404, name)
        for asked, template in (("/v1/records", None), (f"{path}/trace", trace), (f"{path}/report", report)):
            os.mkfifo(self.pipe)
            held = UnixConnection(self.daemon.socket)
            held.request("GET", asked)
            with self.pipe.open("w", encoding="utf-8"):  # Opens when the program reads.
                self.assertEqual(self.check("GET", asked, template=template)[0], 503)
            self.assertEqual(held.getresponse().status, 200)
            held.close()
            self.pipe.unlink()
        self.broken.touch()
        for asked, template in (("/v1/records", None), (f"{path}/report", report)):
            status, body = self.check("GET", asked, template=template)
            self.assertEqual((status, body["error"].partition(": ")[2]), (409, "broken"))
        self.broken.unlink()

    def reports(self, record):
        """On the batch that leads, which has no test yet, and on another; both compared."""
        template = "/v1/batches/{id}/report"
        batch = self.daemon.ask("GET", "/v1/batch")[1]["batch"]["id"]
        report = f"/v1/batches/{batch}/report"
        status, body = self.check("GET", report, template=template)
        self.assertEqual((status, body["error"]), (409, f"there is no report: batch {batch} has no test yet"))
        # As the daemon writes it when a test of the batch is recorded.
        with (record.parent / "batches.jsonl").open("a", encoding="utf-8") as journal:
            for event in ({"event": "begun", "batch": "b", "plan": {"name": "fluting"}},
                          *({"event": "recorded", "batch": of, "record": record.name, "replicate": 1, "slide": 1} for of in (batch, "b"))):
                journal.write(json.dumps({"at": "2026-11-22T18:03:01+00:00", "by": "ada", **event}) + "\n")
        listed = self.check("GET", "/v1/batches")[1]["batches"]
        self.assertEqual([(one["name"], one["counted"]) for one in listed[:2]], [("fluting", 1), ("liner", 1)])
        compare = f"/v1/compare?a={batch}&b=b"
        with h5py.File(record) as file:
            mu_s = file["entry/results/mu_s"][()]
        for path, described in ((report, template), (compare, "/v1/compare")):
            mark = "&" if "?" in path else "?"
            status, page = self.check("GET", path, template=described)
            self.assertEqual(status, 200)
            self.assertTrue(page.startswith("<!DOCTYPE html>"))
            self.assertEqual(self.check("GET", f"{path}{mark}format=html", template=described), (200, page))
            status, table = self.check("GET", f"{path}{mark}format=csv", template=described)
            self.assertEqual(status, 200)
            self.assertGreater(len(list(csv.DictReader(io.StringIO(table)))), 0)
            status, told = self.check("GET", f"{path}{mark}format=json", template=described)
            self.assertEqual(status, 200)
            self.assertEqual((told.get("a") or told)["tests"][0]["mu_s"], None if numpy.isnan(mu_s) else mu_s)
            for wrong in ("format=pdf", "x=1", "format=csv&format=csv", "pool=all", "pool=", "pool=grades&pool=regimes"):
                self.assertEqual(self.check("GET", f"{path}{mark}{wrong}", template=described)[0], 400, wrong)
        self.assertEqual([told[side]["label"] for side in ("a", "b")], [f"liner ({batch})", "fluting (b)"])
        self.pooled_reports(record)
        self.assertEqual(self.check("GET", "/v1/compare", template="/v1/compare")[0], 400)
        self.assertEqual(self.check("GET", f"/v1/compare?a={batch}&b={batch}", template="/v1/compare")[0], 400)
        for name in ("x", "..", "..%2Fd.toml", "../records", str(record.parent), "--json", "liner"):
            self.assertEqual(self.check("GET", f"/v1/batches/{name}/report", template=template)[0], 404, name)
            self.assertEqual(self.check("GET", f"/v1/compare?a={batch}&b={name}", template="/v1/compare")[0], 404, name)
        # One at a time; who reads and who measures is not held up by it.
        os.mkfifo(self.pipe)
        held = UnixConnection(self.daemon.socket)
        held.request("GET", report)
        with self.pipe.open("w", encoding="utf-8"):  # Opens when the program reads.
            for path, described in ((report, template), (compare, "/v1/compare")):
                self.assertEqual(self.check("GET", path, template=described)[0], 503)
            self.assertEqual(self.check("GET", "/v1/status")[0], 200)
        self.assertEqual(held.getresponse().status, 200)
        held.close()
        self.pipe.unlink()
        # A record that is gone is told; its page is not made of what is left.
        record.rename(record.with_suffix(".kept"))
        for path, described in ((report, template), (compare, "/v1/compare")):
            status, body = self.check("GET", path, template=described)
            self.assertEqual(status, 409)
            self.assertIn(f"{record.name}: there is no such file", body["error"])
        record.with_suffix(".kept").rename(record)

    def pooled_reports(self, record):
        """A batch of two grades, whose tests are averaged only if asked; and compared only then."""
        other = record.with_name("kraft.h5")
        shutil.copy(record, other)
        other.chmod(0o600)
        with h5py.File(other, "r+") as file:
            if "grade" in file["entry/sample"]:
                del file["entry/sample/grade"]
            file["entry/sample"].create_dataset("grade", data=numpy.bytes_("kraft"))
        with (record.parent / "batches.jsonl").open("a", encoding="utf-8") as journal:
            for event in ({"event": "begun", "batch": "c", "plan": {"name": "two grades"}},
                          *({"event": "recorded", "batch": "c", "record": name, "replicate": 1, "slide": 1} for name in (record.name, other.name))):
                journal.write(json.dumps({"at": "2026-11-22T18:03:02+00:00", "by": "ada", **event}) + "\n")

        def groups(pool):
            status, told = self.check("GET", f"/v1/batches/c/report?format=json{pool}", template="/v1/batches/{id}/report")
            self.assertEqual(status, 200)
            return [group["tests"] for group in told["groups"]]
        self.assertEqual([groups(pool) for pool in ("", "&pool=regimes")], 2 * [[[0], [1]]])
        self.assertEqual([groups(pool) for pool in ("&pool=grades", "&pool=grades,regimes")], 2 * [[[0, 1]]])
        status, refused = self.check("GET", "/v1/compare?a=c&b=b&format=json", template="/v1/compare")
        self.assertEqual(status, 409)
        self.assertIn("name the records of one grade", refused["error"])
        status, told = self.check("GET", "/v1/compare?a=c&b=b&format=json&pool=grades", template="/v1/compare")
        self.assertEqual((status, told["a"]["label"], [group["tests"] for group in told["a"]["groups"]]), (200, "two grades (c)", [[0, 1]]))

    def calibrate(self, frames):
        def weigh(mass):
            self.hanging.hang(mass)
            return self.check("POST", "/v1/calibration/weight", {"mass": f"{mass} kg"})
        self.hanging.hang(0)
        wait_for(frames, lambda frame: frame["type"] == "health" and frame["status"]["bench"] == "idle")
        for wrong in ({"settle": -1}, {"reading": "2 kg"}, {"reading": 61}, {"x": 1}):
            self.assertEqual(self.check("POST", "/v1/calibration", wrong)[0], 400, wrong)
        self.assertEqual(self.check("PUT", "/v1/controller", {"seconds": 3600})[0], 200)
        self.assertEqual(self.check("POST", "/v1/calibration", {"settle_s": 0.5, "reading": "0.5 s"})[0], 200)
        self.assertEqual(self.check("POST", "/v1/calibration/undo")[0], 409)
        for wrong in ({}, {"mass": -1}, {"mass": "1 V"}, {"mass": "1e5 kg"}, {"mass": 0.5}, {"mass": "500"}, {"mass": None}):
            self.assertEqual(self.check("POST", "/v1/calibration/weight", wrong)[0], 400, wrong)
        for mass in (0, 0.5, 1, 1.5, 1, 0.5, 0):
            self.assertEqual(weigh(mass)[0], 200)
            if mass == 0.5:
                self.assertEqual(self.check("POST", "/v1/calibration/undo")[0], 200)
                self.assertEqual(weigh(mass)[0], 200)
        for wrong in ({"certificate": 1}, {"valid_days": -1}, {"certificate": "\n"}):
            self.assertEqual(self.check("POST", "/v1/calibration/finish", wrong)[0], 400, wrong)
        self.assertEqual(self.check("POST", "/v1/calibration/finish", {"valid_days": 0})[0], 200)
        self.assertIsNone(self.check("GET", "/v1/calibration")[1]["in_use"]["expires"])
        # What is saved or given up gives the bench back, but for a lease that was asked for.
        lease = self.check("GET", "/v1/controller")[1]
        self.assertEqual(lease["controller"], "ada")
        self.assertGreater(lease["seconds_left"], 300)
        self.assertEqual(self.check("DELETE", "/v1/controller")[0], 200)
        self.assertEqual(self.check("POST", "/v1/calibration")[0], 200)
        self.assertEqual(self.check("GET", "/v1/controller")[1]["controller"], "ada")
        self.assertEqual(self.check("GET", "/v1/status")[1]["lease"]["controller"], "ada")
        self.assertEqual(self.check("DELETE", "/v1/calibration")[0], 200)
        self.assertIsNone(self.check("GET", "/v1/controller")[1]["controller"])
        self.assertEqual(self.check("GET", "/v1/status")[1]["lease"], {"controller": None, "seconds_left": 0.0})
        self.hanging.nothing()
        # What was sent meanwhile has been read, and the scene plays.
        scan = self.daemon.ask("GET", "/v1/status")[1]["scan_count"]
        wait_for(frames, lambda frame: frame["type"] == "scans" and frame["first_scan"] > scan)

    def test_other_methods_and_paths_are_refused(self):
        methods = {"GET", "PUT", "POST", "DELETE"}
        for path, described in self.document["paths"].items():
            if path == "/v1/live":
                continue
            allowed = {method.upper() for method in described}
            for method in methods - allowed:
                status, body = self.daemon.ask(method, path.replace("{number}", "1").replace("{name}", "x").replace("{id}", "x"))
                self.assertEqual(status, 405, (method, path))
                self.assertEqual(set(self.daemon.reply.headers["Allow"].split(", ")), allowed)
                self.assertIn("error", body)
        for path in ("/page/", "/page/../live.js", "/page/live.html", "/v1", "/v1/", "/v1/tests/", "/v1/../v1/status", "/v1/status/", "//v1/status", "/etc/passwd", "/v1/tests/../../etc/passwd"):
            self.assertEqual(self.daemon.ask("GET", path)[0], 404, path)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

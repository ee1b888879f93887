#!/usr/bin/env python3
"""Testers at a real MQTT 5 broker: state, last will, health, each result once; over restarts of the broker and kills
of the daemon; TLS and passwords; twenty of them at once.

fleet_test.py BUILD_DIR SOURCE_DIR [unittest arguments]   Exit status 77: no mosquitto.
"""

import json
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

import h5py

from broker import MOSQUITTO, TIMEOUT_S, Broker, Listener
from running_daemon import RunningDaemon
from stored import stored as stored_in
from stored import told

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
SCENE = SOURCE / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"

if MOSQUITTO is None:
    print("no mosquitto: ./dev deps test")
    sys.exit(77)


def fleet(port, tester="bench-7", more="", scheme="mqtt"):
    return f'[fleet]\nbroker = "{scheme}://127.0.0.1:{port}"\ntester = "{tester}"\nhealth_period = "1 s"\n{more}'


class Case(unittest.TestCase):
    def folder(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        return pathlib.Path(temporary.name)

    def broker(self, *arguments, **options):
        return Broker(self, self.folder(), *arguments, **options)

    def daemon(self, config, **options):
        return RunningDaemon(self, BUILD, SOURCE, config, **{"speed": 20, **options})

    def restart(self, daemon):
        """The same configuration and folders, once more."""
        process = subprocess.Popen([str(BUILD / "bin" / "stickslipd"), "--config", "d.toml"], cwd=daemon.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def fleet_of(self, daemon, wanted):
        """The status, once it is as wanted; the daemon is asked with each frame of its live stream."""
        process, frames = daemon.watch()
        try:
            for _ in frames:
                found = daemon.ask("GET", "/v1/status")[1]["fleet"]
                if wanted(found):
                    return found
        finally:
            process.kill()
            process.communicate()
        raise AssertionError("the stream ended")


def records(folder):
    """{uuid: path}"""
    found = {}
    for path in sorted(folder.glob("records/*.h5")):
        with h5py.File(path) as record:
            found[record["entry/entry_identifier_uuid"][()].decode()] = path
    return found


class Messages(Case):
    def test_state_health_and_results_have_the_names_and_the_numbers_of_the_record(self):
        broker = self.broker()
        listener = Listener(self, broker.port)
        daemon = self.daemon(fleet(broker.port), speed=50, repeats=2)
        state = listener.wait_for_state("bench-7", "acquiring")[2]
        self.assertEqual(set(state), {"tester", "time", "state", "bench", "detail", "version", "test_count", "current_test"})
        results = listener.results(2)
        self.assertEqual(daemon.end()[0], 0)
        listener.wait_for_state("bench-7", "stopped")  # The last word: it comes after the results.
        health = next(body for topic, retained, body in listener.seen if topic == "stickslip/bench-7/health" and not retained)
        self.assertEqual(health["status"]["fleet"]["tester"], "bench-7")
        made = records(daemon.folder)
        self.assertEqual([result["entry_identifier_uuid"] for result in results], list(made))
        for result in results:
            self.assertEqual(str(daemon.folder / result["file"]), str(made[result["entry_identifier_uuid"]]))
            with h5py.File(daemon.folder / result["file"]) as record:
                entry = record["entry"]
                self.assertEqual(result["start_time"], entry["start_time"][()].decode())
                self.assertEqual(result["end_time"], entry["end_time"][()].decode())
                self.assertEqual(result["status"], entry["process/status"][()].decode())
                values = told(result["results"])
                names = set(stored_in(record)) - {"findings"}
                self.assertEqual(set(values) - {"findings", "coded_findings", "details", "diagnostics"}, names)
                for name in names:
                    stored = stored_in(record)[name][()]
                    if isinstance(stored, bytes):
                        self.assertEqual(values[name], stored.decode(), name)
                    elif values[name] is None:
                        self.assertNotEqual(stored, stored, name)
                    else:
                        self.assertEqual(values[name], stored, name)
            # Read from the record it is the same message, but for whom it is from.
            read = subprocess.run([str(BUILD / "bin" / "stickslipd"), "--result", result["file"]], cwd=daemon.folder, capture_output=True, text=True,
                                  timeout=TIMEOUT_S, check=True)
            self.assertEqual({"tester": "bench-7", **json.loads(read.stdout)}, result)
        # The last state is retained: who comes later sees it at once.
        late = Listener(self, broker.port)
        topic, retained, body = late.wait_for(lambda *_: True)
        self.assertEqual((topic, retained, body["state"]), ("stickslip/bench-7/state", True, "stopped"))

    def test_a_daemon_that_dies_is_reported_lost_and_its_interrupted_test_is_told_by_the_next(self):
        broker = self.broker()
        listener = Listener(self, broker.port)
        # In the time of the scene: a test of 5 s, of which the daemon sees the beginning at once.
        daemon = self.daemon(fleet(broker.port), speed=1)
        listener.wait_for(lambda topic, _, body: topic.endswith("/state") and body["current_test"] == 1 and body["state"] == "acquiring")
        # A journal without its header would hold nothing, and leave no record.
        process, frames = daemon.watch()
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        next(frame for frame in frames if any(file.stat().st_size > 8192 for file in daemon.folder.glob("records/*.journal")))
        daemon.kill()
        lost = listener.wait_for_state("bench-7", "lost")[2]
        self.assertEqual(set(lost), {"tester", "connected_since", "state"})
        again = self.restart(daemon)
        [result] = listener.results(1)
        self.assertEqual(result["status"], "interrupted")
        self.assertEqual([result["entry_identifier_uuid"]], list(records(daemon.folder)))
        again.send_signal(signal.SIGTERM)
        self.assertEqual(again.wait(TIMEOUT_S), 0)


class Outbox(Case):
    def test_each_result_arrives_once_though_the_broker_restarts_and_the_daemon_is_killed(self):
        broker = self.broker()
        listener = Listener(self, broker.port)
        daemon = self.daemon(fleet(broker.port))
        listener.results(1)
        broker.stop()
        away = self.fleet_of(daemon, lambda found: found["outbox_count"] >= 2)
        self.assertEqual(away["state"] if away["state"] != "connecting" else "waiting", "waiting")
        # The first daemon is killed while all that it measured waits.
        daemon.kill()
        waiting = list((daemon.folder / "outbox").glob("*.json"))
        self.assertGreaterEqual(len(waiting), 2)
        again = self.restart(daemon)
        broker.start()
        # The listener of before comes back by itself; the records of both lives are what is to be told.
        first = len(waiting) + 1
        listener.results(first + 2)
        interruptions = 1
        while True:
            again.send_signal(signal.SIGTERM)
            again.communicate(timeout=TIMEOUT_S)
            made = records(daemon.folder)
            if not list((daemon.folder / "outbox").glob("*.json")):
                break
            # A stop does not wait for a slow broker: the next start tells what is left, and makes records of its own.
            interruptions += 1
            again = self.restart(daemon)
            listener.results(len(made))
        results = listener.results(len(made))
        told = [result["entry_identifier_uuid"] for result in results]
        self.assertEqual(set(told), set(made))
        # At least once; twice only what was on its way when the broker or the daemon went away.
        self.assertLessEqual(len(told) - len(set(told)), interruptions)

    def test_a_full_outbox_drops_the_oldest_and_counts_them(self):
        broker = self.broker()
        broker.stop()
        daemon = self.daemon(fleet(broker.port, more="outbox_results = 2\n"))
        full = self.fleet_of(daemon, lambda found: found["dropped_result_count"] >= 2)
        self.assertEqual(full["outbox_count"], 2)
        self.assertEqual(full["state"] in ("waiting", "connecting"), True)
        self.assertIn("refused", full["why"])
        _, page = daemon.ask("GET", "/metrics")
        self.assertRegex(page, r"\nstickslip_fleet_connected 0\n")
        self.assertRegex(page, r"\nstickslip_fleet_outbox_results 2\n")
        self.assertRegex(page, r"\nstickslip_fleet_dropped_results_total [2-9]\d*\n")
        status, errors = daemon.end()
        self.assertEqual(status, 0)
        self.assertEqual(errors.count("fleet:"), 1, errors)  # Told once, not at each try.
        self.assertEqual(len(list((daemon.folder / "outbox").glob("*.json"))), 2)

    def test_a_broker_that_never_answers_holds_up_nothing(self):
        with socket.create_server(("127.0.0.1", 0)) as deaf:
            daemon = self.daemon(fleet(deaf.getsockname()[1]), speed=50, repeats=2)
            daemon.process.wait(TIMEOUT_S)  # The scenes are over.
            status, errors = daemon.end()
            self.assertEqual(status, 0, errors)
            self.assertEqual(len(records(daemon.folder)), 2)
            self.assertEqual(len(list((daemon.folder / "outbox").glob("*.json"))), 2)


class Access(Case):
    def certificates(self, folder):
        def openssl(*arguments):
            subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True, timeout=TIMEOUT_S)

        openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=plant", "-days", "2", "-keyout",
                "ca.key", "-out", "ca.pem")
        openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=broker", "-addext",
                "subjectAltName=IP:127.0.0.1", "-keyout", "b.key", "-out", "b.csr")
        (folder / "ext").write_text("subjectAltName=IP:127.0.0.1\n", encoding="ascii")
        openssl("x509", "-req", "-in", "b.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2", "-extfile", "ext", "-out", "b.pem")

    def test_tls_and_password_are_asked_for_and_told_apart(self):
        folder = self.folder()
        self.certificates(folder)
        subprocess.run(["mosquitto_passwd", "-b", "-c", str(folder / "users"), "bench-7", "open sesame"], check=True, timeout=TIMEOUT_S)
        (folder / "acl").write_text("user bench-7\ntopic write stickslip/bench-7/#\ntopic read stickslip/#\n", encoding="ascii")
        broker = Broker(self, folder, f"allow_anonymous false\npassword_file {folder}/users\nacl_file {folder}/acl\n",
                        tls=f"certfile {folder}/b.pem\nkeyfile {folder}/b.key\n")
        listener = Listener(self, broker.port, arguments=("--cafile", str(folder / "ca.pem"), "-u", "bench-7", "-P", "open sesame"))
        password = folder / "password"
        password.write_text("open sesame\n", encoding="ascii")
        password.chmod(0o600)
        login = f'user = "bench-7"\npassword_file = "{password}"\nca_file = "{folder}/ca.pem"\n'
        daemon = self.daemon(fleet(broker.port, more=login, scheme="mqtts"), speed=50, repeats=1)
        listener.results(1)
        errors = daemon.end()[1]
        self.assertNotIn("sesame", errors)
        [record] = records(daemon.folder).values()
        self.assertNotIn(b"sesame", record.read_bytes())
        # A wrong password, a stranger's certificate, no TLS at all, a topic that is another's.
        wrong = folder / "wrong"
        wrong.write_text("mellon\n", encoding="ascii")
        wrong.chmod(0o600)
        (folder / "other").mkdir()
        self.certificates(folder / "other")
        for more, scheme, tester, why in (
                (login.replace(str(password), str(wrong)), "mqtts", "bench-7", "(?i)not authori[sz]ed|bad user"),
                (login.replace(f"{folder}/ca.pem", f"{folder}/other/ca.pem"), "mqtts", "bench-7", "(?i)certificate"),
                (login.replace(f'ca_file = "{folder}/ca.pem"\n', ""), "mqtt", "bench-7", "."),
                (login, "mqtts", "bench-8", "(?i)refuses what it is told: not authori[sz]ed")):
            with self.subTest(why=why):
                refused = self.daemon(fleet(broker.port, tester=tester, more=more, scheme=scheme))
                found = self.fleet_of(refused, lambda found: found["why"])
                self.assertRegex(found["why"], why)
                self.assertNotIn("mellon", refused.end()[1])

    def test_files_that_cannot_be_read_end_the_start_with_one_line(self):
        folder = self.folder()
        (folder / "d.toml").write_text(f'[board]\ndriver = "simulated"\n[board.simulated]\nscenes = ["{SCENE}"]\n'
                                       + fleet(1, more='user = "u"\npassword_file = "nowhere"\n'), encoding="utf-8")
        done = subprocess.run([str(BUILD / "bin" / "stickslipd"), "--config", "d.toml"], cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S,
                              check=False)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr, "stickslipd: password file nowhere: cannot be read: No such file or directory\n")

    def test_two_testers_of_one_name_are_told(self):
        broker = self.broker()
        first = self.daemon(fleet(broker.port))
        self.fleet_of(first, lambda found: found["state"] == "connected")
        self.daemon(fleet(broker.port))
        found = self.fleet_of(first, lambda found: found["why"] and "another" in found["why"])
        self.assertIn("is another tester called bench-7 as well?", found["why"])


class Many(Case):
    def test_twenty_testers_at_one_broker_that_restarts(self):
        broker = self.broker()
        listener = Listener(self, broker.port)
        processes = []
        for number in range(20):
            folder = self.folder()
            (folder / "d.toml").write_text(f'[board]\ndriver = "simulated"\nclock_speed = 10\n[board.simulated]\nscenes = ["{SCENE}"]\n'
                                           f'[record]\nfolder = "records"\n[log]\nlevel = "error"\n' + fleet(broker.port, tester=f"bench-{number}"),
                                           encoding="utf-8")
            process = subprocess.Popen([str(BUILD / "bin" / "stickslipd"), "--config", "d.toml"], cwd=folder, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.communicate)
            self.addCleanup(process.kill)
            processes.append((folder, process))
        for number in range(20):
            if not any(topic == f"stickslip/bench-{number}/state" for topic, _, _ in listener.seen):
                listener.wait_for(lambda topic, _, body, number=number: topic == f"stickslip/bench-{number}/state")
        broker.stop()
        broker.start()
        made = {}
        for folder, process in processes:
            _, errors = process.communicate(timeout=TIMEOUT_S)
            self.assertEqual(process.returncode, 0, errors)
            made.update(records(folder))
        self.assertEqual(len(made), 20)
        # Those whose broker was away at their end hold theirs; they tell it when they start again.
        for folder, process in processes:
            if list((folder / "outbox").glob("*.json")):
                again = subprocess.Popen([str(BUILD / "bin" / "stickslipd"), "--config", "d.toml"], cwd=folder, stderr=subprocess.PIPE, text=True)
                self.addCleanup(again.communicate)
                self.addCleanup(again.kill)
        results = listener.results(20)
        self.assertTrue(set(made) <= {result["entry_identifier_uuid"] for result in results})
        self.assertEqual({result["tester"] for result in results if result["entry_identifier_uuid"] in made}, {f"bench-{n}" for n in range(20)})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""The real programs, from outside: exit statuses, files, one-line errors, the sd_notify protocol.

stickslipd_test.py BUILD_DIR SOURCE_DIR [unittest arguments]

Nothing here sleeps: each step waits for an event (a notification, the end of a process).
"""

import json
import pathlib
import re
import signal
import stat
import subprocess
import sys
import tempfile
import unittest

from service_manager import TIMEOUT_S, Manager
from stored import stored as stored_in
from stored import told

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
DAEMON = BUILD / "bin" / "stickslipd"
CLI = BUILD / "bin" / "stickslip"
SCENES = SOURCE / "config" / "scenes"
STICK_SLIP = SCENES / "stick-slip-at-12-in-per-min.toml"


def run(*arguments, cwd=None):
    return subprocess.run([str(a) for a in arguments], cwd=cwd, capture_output=True, text=True,
                          timeout=TIMEOUT_S, check=False)


def holds_more_than_a_header(journal):
    """A whole first entry (core/record/journal_format.hpp) and something behind it."""
    head = journal.read_bytes()[:32]
    if len(head) < 32:
        return False
    payload_size = int.from_bytes(head[8:12], "little")
    return journal.stat().st_size > len(head) + payload_size


def entries(content):
    """Where each entry of a journal begins and ends, and its type."""
    begin = 0
    while begin + 32 <= len(content):
        end = begin + 32 + int.from_bytes(content[begin + 8:begin + 12], "little")
        if end > len(content):
            return
        yield begin, end, int.from_bytes(content[begin + 4:begin + 6], "little")
        begin = end


def ending(record):
    """Status, reasons and cause of the end."""
    import h5py
    with h5py.File(record) as file:
        process = file["entry/process"]
        return (process["status"].asstr()[()], [why.decode() for why in process["reasons"][()]],
                process["end_cause"].asstr()[()])


class Folder(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def config(self, text):
        file = self.folder / "test.toml"
        file.write_text(text, encoding="utf-8")
        return file

    def simulated(self, repeats=1, speed=50, more=""):
        return self.config(f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["{STICK_SLIP}"]
repeats = {repeats}
[record]
folder = "records"
{more}
""")

    def records(self):
        return sorted((self.folder / "records").glob("*.h5"))


class Demo(Folder):
    def test_ends_by_itself_with_ten_records_and_a_table(self):
        done = run(CLI, "demo", "--folder", "new/place", cwd=self.folder)
        self.folder = self.folder / "new" / "place"
        self.assertEqual(done.returncode, 0, done.stderr)
        records = sorted((self.folder / "records" / "demo").glob("*.h5"))
        self.assertEqual(len(records), 10)
        leftovers = [f.name for f in (self.folder / "records" / "demo").iterdir() if f.suffix != ".h5"]
        self.assertEqual(leftovers, ["tester-history.jsonl"])
        lines = done.stdout.splitlines()
        measured = [line for line in lines if re.match(r" *\d+  [a-z]", line)]
        truths = [line for line in lines if re.match(r"truth  .*\d", line)]  # The legend has one without numbers.
        self.assertEqual((len(measured), len(truths)), (10, 10))
        for found, truth in zip(measured, truths):
            # The regime found is the true one: "1 stick-slip …", and below its errors "truth stick-slip …".
            self.assertEqual(found.split()[1], truth.split()[1])
            # S - K has a standard error and a systematic part.
            own = lines.index(found)
            self.assertEqual([line.split()[:2] for line in lines[own + 1:own + 3]], [["±", "stat."], ["±", "syst."]])
            self.assertEqual(lines[own + 3], truth)
        for record in records:
            self.assertIn(record.name, done.stdout)
        self.assertIn(f"\nrecords in {self.folder / 'records' / 'demo'}\n", done.stdout)

    def test_records_analysed_again_give_the_stored_results_to_the_last_bit(self):
        import h5py
        done = run(DAEMON, "--config", self.simulated(repeats=2), cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.records()), 2)
        analysed = run(CLI, "analyze", "--json", *self.records())
        self.assertEqual(analysed.returncode, 0, analysed.stderr)
        compared = 0
        for test in map(told, json.loads(analysed.stdout)["tests"]):
            with h5py.File(test["file"]) as record:
                for name, stored in stored_in(record).items():
                    if name not in test or not hasattr(stored, "shape") or stored.dtype.kind != "f":
                        continue
                    again = test[name]
                    if again is None:
                        self.assertIn("reason", stored.attrs, name)
                    else:
                        self.assertEqual(float(stored[()]), again, name)
                        compared += 1
        self.assertGreater(compared, 10)

    def test_a_characterised_tester_is_known_and_kept_in_the_record(self):
        import h5py
        (self.folder / "tester.toml").write_text("""
[tester]
omega = "128 rad/s"
omega_standard_error = "0.01 rad/s"
gamma_over_2omega = 0.022
gamma_over_2omega_standard_error = 0.0001
""", encoding="utf-8")
        config = self.simulated(more="[tester]\ncharacterisation = \"tester.toml\"\n[report]\ntable = true")
        done = run(DAEMON, "--config", config, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        # The scene's spring has 125.66 rad/s: far off what is told here.
        self.assertIn("the tester or the paper has changed since the characterisation", done.stdout)
        [record] = self.records()
        with h5py.File(record) as file:
            kept = file["entry/process/characterisation"].asstr()[()]
            self.assertEqual(kept, (self.folder / "tester.toml").read_text(encoding="utf-8"))
            stored = [text.decode() for text in file["entry/results/findings"][()]]
        [again] = json.loads(run(CLI, "analyze", record, "--json").stdout)["tests"]
        self.assertEqual(again["findings"], stored)
        self.assertEqual(len(stored), 1)
        (self.folder / "tester.toml").write_text("[tester]\nomega = 3\n", encoding="utf-8")
        done = run(DAEMON, "--check-config", config, cwd=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("characterisation", done.stderr)

    def test_a_replayed_record_gives_the_same_record(self):
        import h5py
        import numpy
        done = run(DAEMON, "--config", self.simulated(), cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        [original] = self.records()
        replay = self.config(f"""
[board]
driver = "replay"
clock_speed = 50
[board.replay]
file = "{original}"
[record]
folder = "replayed"
""")
        done = run(DAEMON, "--config", replay, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        [copy] = sorted((self.folder / "replayed").glob("*.h5"))
        with h5py.File(original) as a, h5py.File(copy) as b:
            numpy.testing.assert_array_equal(a["entry/raw/counts"][()], b["entry/raw/counts"][()])
            self.assertEqual(set(stored_in(a)), set(stored_in(b)))
            for name, stored in stored_in(a).items():
                numpy.testing.assert_array_equal(stored[()], stored_in(b)[name][()], err_msg=name)
            for name, stored in a["entry/cycles"].items():
                numpy.testing.assert_array_equal(stored[()], b["entry/cycles"][name][()], err_msg=name)


class Signals(Folder):
    def end_with(self, number):
        manager = Manager(self, self.folder)
        # Slow enough that the signal surely comes inside the test of 7.5 s: 1.5 s of the wall.
        process = manager.start(DAEMON, self.simulated(repeats=0, speed=5), self.folder)
        self.addCleanup(process.kill)
        manager.wait_for(lambda text: "test 1 running" in text)
        process.send_signal(number)
        out, err = process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 0, err)
        self.assertIn("READY=1", manager.messages)
        manager.wait_for(lambda text: "STOPPING=1" in text)
        [record] = self.records()
        self.assertEqual([f for f in (self.folder / "records").iterdir() if f not in (record, record.with_name("tester-history.jsonl"))], [])
        self.assertEqual(ending(record), ("interrupted", ["the program stopped before the end of the test"], "stopped"))
        shown = run(CLI, "analyze", "--json", record)
        self.assertEqual(shown.returncode, 0, shown.stderr)

    def test_sigterm_inside_a_test_finishes_its_file(self):
        self.end_with(signal.SIGTERM)

    def test_sigint_inside_a_test_finishes_its_file(self):
        self.end_with(signal.SIGINT)

    def test_a_killed_daemon_leaves_a_journal_that_the_next_one_finishes(self):
        manager = Manager(self, self.folder)
        config = self.simulated(repeats=0, speed=5)
        process = manager.start(DAEMON, config, self.folder)
        manager.wait_for(lambda text: "test 1 running" in text)
        # The storage thread begins the journal at about the same time; nobody announces it. The first
        # entry is the header: kill once there is more than that.
        journals = []
        while not journals and process.poll() is None:
            journals = [j for j in (self.folder / "records").glob("*.journal") if holds_more_than_a_header(j)]
        process.kill()
        process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(len(journals), 1)
        manager = Manager(self, self.folder)
        process = manager.start(DAEMON, config, self.folder)
        manager.wait_for(lambda text: text == "READY=1")
        finished = journals[0].with_suffix(".h5")
        self.assertTrue(finished.exists())
        self.assertFalse(journals[0].exists())
        self.assertEqual(ending(finished),
                         ("interrupted", ["the program stopped before the end of the test"], "program-died"))
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 0)

    def test_a_damaged_journal_becomes_a_record_of_the_rest_and_stays(self):
        import h5py
        manager = Manager(self, self.folder)
        process = manager.start(DAEMON, self.simulated(repeats=0, speed=5), self.folder)
        self.addCleanup(process.kill)
        scans = []
        while len(scans) < 9 and process.poll() is None:
            for journal in (self.folder / "records").glob("*.journal"):
                scans = [entry for entry in entries(journal.read_bytes()) if entry[2] == 2]
        process.kill()
        process.communicate(timeout=TIMEOUT_S)
        [journal] = (self.folder / "records").glob("*.journal")
        whole = journal.read_bytes()
        scans = [entry for entry in entries(whole) if entry[2] == 2]
        begin, end, _ = scans[4]
        content = bytearray(whole)
        content[end - 1] ^= 4
        journal.write_bytes(content)

        done = run(CLI, "recover", "records", cwd=self.folder)
        self.assertEqual(done.returncode, 3, done.stderr)
        record = journal.with_suffix(".h5")
        kept = journal.with_name(journal.name + ".damaged")
        self.assertIn(f"{end - begin} bytes of its journal could not be read", done.stdout)
        self.assertIn(kept.name, done.stdout)
        self.assertFalse(journal.exists())
        self.assertEqual(kept.read_bytes(), content)
        count = {place: (stop - place - 32) // 2 for place, stop, _ in scans}
        with h5py.File(record) as file:
            self.assertEqual(file["entry/raw/scan"].shape[0], sum(count.values()) - count[begin])
            self.assertEqual(file["entry/gaps/scan_count"][()].tolist(), [count[begin]])
            self.assertEqual(file["entry/gaps/cause"].asstr()[()].tolist(), ["damaged"])
        self.assertEqual(run(CLI, "verify", record).returncode, 1)
        self.assertEqual(run(CLI, "verify", kept).returncode, 3)
        again = run(CLI, "recover", "records", cwd=self.folder)
        self.assertEqual((again.returncode, again.stdout), (0, ""), again.stderr)

        # What cannot be printed stops no recovery.
        others = self.folder / "others"
        others.mkdir()
        for number in (1, 2):
            (others / f"20260101T000000Z-000{number}.journal").write_bytes(whole)
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([CLI, "recover", others], stdout=full, stderr=subprocess.PIPE, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertIn("the output cannot be written: No space left on device", done.stderr)
        self.assertEqual(sorted(path.name for path in others.iterdir()), ["20260101T000000Z-0001.h5", "20260101T000000Z-0002.h5"])

        # Without the header nobody knows what the counts mean.
        lost = bytearray(whole)
        lost[40] ^= 4
        (self.folder / "lost.journal").write_bytes(lost)
        done = run(CLI, "recover", "lost.journal", cwd=self.folder)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("its header, at byte 0, is damaged", done.stdout)
        self.assertEqual((self.folder / "lost.journal").read_bytes(), lost)

        # The daemon does the same at its start, and warns.
        other = self.folder / "records" / "20260101T000000Z-0001.journal"
        other.write_bytes(content)
        done = run(DAEMON, "--config", self.simulated(), cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the record lacks what could not be read", done.stderr)
        self.assertEqual(other.with_name(other.name + ".damaged").read_bytes(), content)

    def test_records_stand_in_dated_folders_read_only_and_are_recovered_there(self):
        manager = Manager(self, self.folder)
        config = self.simulated(repeats=0, speed=5)
        config.write_text(config.read_text().replace('folder = "records"',
                                                     'folder = "records"\ndated_folders = "month"\nread_only = true'))
        process = manager.start(DAEMON, config, self.folder)
        manager.wait_for(lambda text: "test 1 running" in text)
        journals = []
        while not journals and process.poll() is None:
            journals = [j for j in (self.folder / "records").rglob("*.journal") if holds_more_than_a_header(j)]
        process.kill()
        process.communicate(timeout=TIMEOUT_S)
        self.assertRegex(str(journals[0].relative_to(self.folder)), r"^records/\d{4}/\d{2}/\d{8}T\d{6}Z-0001\.journal$")
        recovered = run(CLI, "recover", "records", cwd=self.folder)
        self.assertEqual(recovered.returncode, 0, recovered.stderr)
        self.assertEqual(recovered.stdout, f"made     {journals[0].with_suffix('.h5').relative_to(self.folder)}\n")
        finished = journals[0].with_suffix(".h5")
        self.assertTrue(finished.exists())
        verdict = run(CLI, "verify", finished)
        self.assertEqual(verdict.returncode, 1, verdict.stdout)
        self.assertIn("interrupted: the program stopped before the end of the test", verdict.stdout)

        manager = Manager(self, self.folder)
        config = self.simulated(repeats=1)
        config.write_text(config.read_text().replace('folder = "records"', 'folder = "closed"\nread_only = true'))
        done = run(DAEMON, "--config", config, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        [record] = (self.folder / "closed").glob("*.h5")
        self.assertEqual(stat.S_IMODE(record.stat().st_mode), 0o444)
        self.assertEqual(run(CLI, "verify", record).returncode, 0)


class Service(Folder):
    def test_a_missing_board_is_a_state_and_not_an_end(self):
        manager = Manager(self, self.folder)
        config = self.config("""
[board]
driver = "comedi"
[board.comedi]
device = "/dev/comedi-that-is-not-there"
[tester]
sled_mass = "2331 g"
load_cell_gain = "2 N/V"
[record]
folder = "records"
[control]
socket = "control.sock"
""")
        process = manager.start(DAEMON, config, self.folder)
        self.addCleanup(process.kill)
        manager.wait_for(lambda text: text == "READY=1")
        told = [text for text in manager.messages if text.startswith("STATUS=board missing: ")]
        self.assertTrue(told, manager.messages)
        self.assertIn("/dev/comedi-that-is-not-there", told[0])

        control = self.folder / "control.sock"
        self.assertEqual(stat.S_IMODE(control.stat().st_mode), 0o660)
        status = run(CLI, "status", "--json", "--socket", control)
        self.assertEqual(status.returncode, 0, status.stderr)
        self.assertEqual(json.loads(status.stdout)["state"], "board missing")

        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 0)
        self.assertFalse(control.exists())

    def test_boards_that_cannot_be_used_are_listed_with_the_reason(self):
        listed = run(CLI, "boards", "--json", "/dev/comedi-that-is-not-there")
        self.assertEqual(listed.returncode, 1, listed.stderr)
        [board] = json.loads(listed.stdout)["boards"]
        self.assertFalse(board["usable"])
        self.assertIn("no such device", board["problem"])
        text = run(CLI, "boards", "/dev/comedi-that-is-not-there")
        self.assertEqual(text.returncode, 1)
        self.assertIn("/dev/comedi-that-is-not-there: no such device", text.stdout)

    def test_the_machine_is_asked_for_real_time_and_answers_in_status_and_record(self):
        import h5py
        manager = Manager(self, self.folder)
        process = manager.start(DAEMON, self.simulated(repeats=0, speed=1, more='[control]\nsocket = "c.sock"\n'),
                                self.folder)
        self.addCleanup(process.kill)
        manager.wait_for(lambda text: "test 1 running" in text)
        status = json.loads(run(CLI, "status", "--json", "--socket", self.folder / "c.sock").stdout)
        self.assertRegex(status["scheduling"], r"^SCHED_(FIFO|OTHER).*memory (not )?locked.*RLIMIT_RTTIME")
        self.assertEqual(status["board_loss_count"], 0)
        # The daemon's promise is 40 MB; a sanitizer brings its own. Locked on fault: stacks count as touched, the
        # ring as a whole.
        if BUILD.name in ("release", "dev"):
            lines = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8").splitlines()
            sizes_kB = {line.split(":")[0]: int(line.split()[1]) for line in lines if line.endswith(" kB")}
            threads = pathlib.Path(f"/proc/{process.pid}/task").glob("*/schedstat")
            cpu_s = sum(int(thread.read_text(encoding="utf-8").split()[0]) for thread in threads) / 1e9
            print(f"resident {sizes_kB['VmRSS']} kB, locked {sizes_kB['VmLck']} kB, processor {cpu_s:.3f} s, "
                  f"{status['scheduling']}", file=sys.stderr)
            self.assertLess(sizes_kB["VmRSS"], 40_000)
            self.assertEqual("memory locked" in status["scheduling"], sizes_kB["VmLck"] > 0)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_S)
        [record] = self.records()
        with h5py.File(record) as file:
            self.assertEqual(file["entry/process/realtime"].asstr()[()], status["scheduling"])

    def test_status_tells_the_running_test(self):
        manager = Manager(self, self.folder)
        process = manager.start(DAEMON, self.simulated(repeats=0, speed=5, more='[control]\nsocket = "c.sock"\n'),
                                self.folder)
        self.addCleanup(process.kill)
        manager.wait_for(lambda text: "test 1 running" in text)
        status = json.loads(run(CLI, "status", "--json", "--socket", self.folder / "c.sock").stdout)
        self.assertEqual(status["state"], "acquiring")
        self.assertEqual(status["board"]["scan_rate_granted"], 350.0)
        self.assertGreater(status["scan_count"], 0)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 0)


class Refusals(Folder):
    def refused(self, status, *arguments, cwd=None):
        done = run(*arguments, cwd=cwd)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def test_a_wrong_configuration_ends_with_2_before_anything_happens(self):
        for text, expected in [
            ('[bord]\n', "test.toml:1: [bord]: unknown table; did you mean board?"),
            ('[board]\ndriver = "simulatd"\n', 'test.toml:2: board.driver = "simulatd": must be one of'),
            ('[board]\ndriver = "simulated"\n', "board.simulated.scenes: needs at least one scene"),
            ('[board]\ndriver = "simulated"\nscan_rate = "0 Hz"\n', 'test.toml:3: board.scan_rate = "0 Hz"'),
            ('[board\n', "test.toml:1: "),
            ('[board]\ndriver = "simulated"\nsimulated = { scenes = ["no.toml"] }\n', "no.toml: there is no such file"),
            ('[board]\ndriver = "replay"\nreplay = { file = "no.h5" }\n', "no.h5"),
        ]:
            with self.subTest(text):
                config = self.config(text)
                for option in ("--check-config", "--config"):
                    message = self.refused(2, DAEMON, option, config, cwd=self.folder)
                    self.assertIn(expected, message)
                    self.assertEqual([f.suffix for f in self.folder.rglob("*.h5")], [])

    def test_wrong_usage_ends_with_2(self):
        self.refused(2, DAEMON)
        self.refused(2, DAEMON, "--nonsense")
        self.refused(2, CLI)
        self.refused(2, CLI, "analyse", "x.h5")
        self.refused(2, CLI, "analyze", self.folder / "absent.h5")
        self.assertIn("--folder", self.refused(2, CLI, "demo", "--folder", "/dev/null/demo"))
        self.refused(1, CLI, "status", "--socket", self.folder / "absent.sock")

    def test_a_record_folder_that_cannot_be_written_ends_with_1(self):
        (self.folder / "records").write_text("a file, not a folder")
        message = self.refused(1, DAEMON, "--config", self.simulated(more='[log]\nlevel = "error"\n'),
                               cwd=self.folder)
        self.assertIn("records", message)

    def test_the_shipped_configurations_are_good(self):
        for name in ("stickslipd.toml", "demo.toml", "bench.toml"):
            done = run(DAEMON, "--check-config", SOURCE / "config" / name)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_refused_import_leaves_no_file(self):
        csv = self.folder / "x.csv"
        csv.write_text("t_s,mu\n0,0.1\n0.5,nan\n")
        out = self.folder / "x.h5"
        for arguments in (["--column", "force", "--rate", "2 Hz", "--unit", "coefficient"],
                          ["--column", "mu", "--rate", "0 Hz", "--unit", "coefficient"],
                          ["--column", "mu", "--rate", "2 Hz", "--unit", "kg"],
                          ["--column", "mu", "--rate", "2 Hz", "--unit", "coefficient"]):
            with self.subTest(arguments):
                self.refused(2, CLI, "import", csv, *arguments, "-o", out)
                self.assertEqual(list(self.folder.iterdir()), [csv])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

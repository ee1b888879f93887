#!/usr/bin/env python3
"""stickslip bundle: one file for support, whatever is broken. It begins with what is wrong, each part that cannot be had
says why, and no secret is in it.

bundle_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from running_daemon import RunningDaemon, wait_for

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SCENE = SOURCE / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml"
TIMEOUT_S = 240

SIMULATED = f'[board]\ndriver = "simulated"\n[board.simulated]\nscenes = ["{SCENE}"]\n'
HEADINGS = ["What is wrong", "System", "Checks of stickslip doctor", "Configuration", "Files that it names", "Status of the daemon", "Log", "Record folder",
            "Last records"]
# Stands wherever a secret may be, each time with another number.
SECRET = "Hunter2-secret"
NAME = "Ada-Typed"
LOG = f"""2026-11-28T10:00:00+00:00 stickslipd[7]: load cell calibrated by {NAME}@pc: 2.0 N/V, kept in calibrations
2026-11-28T10:00:01+00:00 stickslipd[7]: fleet: mqtt://user:{SECRET}-1@broker: refused
2026-11-28T10:00:02+00:00 stickslipd[7]: reload: the configuration stays as it was: d.toml:9: fleet.pin = "{SECRET}-2": unknown key; there are broker
2026-11-28T10:00:03+00:00 stickslipd[7]: password: {SECRET}-3 {"{"}"token": "{SECRET}-4"{"}"} Authorization: Bearer {SECRET}-5
2026-11-28T10:00:04+00:00 stickslipd[7]: test 7 began: trigger at scan 10, record from scan 3
"""


class Bundle(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-", dir="/tmp")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def tools(self, **programs):
        """A PATH with these programs before the others."""
        tools = self.folder / "tools"
        tools.mkdir(exist_ok=True)
        for name, script in programs.items():
            (tools / name).write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
            (tools / name).chmod(0o755)
        return {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}

    def bundle(self, *options, folder=None, environment=None):
        """({heading: text}, whole text)"""
        folder = folder or self.folder
        output = folder / "b.txt"
        output.unlink(missing_ok=True)
        done = subprocess.run([str(CLI), "bundle", "-o", "b.txt", *options], cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False,
                              env=environment or self.tools(journalctl=f"cat <<'END'\n{LOG}END", systemctl="echo ActiveState=failed"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"^b\.txt: \d+ kB; read it")
        self.assertEqual(output.stat().st_mode & 0o777, 0o600)
        text = output.read_text(encoding="utf-8")
        parts = re.split(r"(?m)^== (.*)\n", text)
        found = dict(zip(parts[1::2], parts[2::2]))
        self.assertEqual(len(found), len(HEADINGS))
        for begins, heading in zip(HEADINGS, found):
            self.assertTrue(heading.startswith(begins), heading)
        return {begins: part for begins, part in zip(HEADINGS, found.values())}, text

    def test_a_running_daemon_with_its_records(self):
        daemon = RunningDaemon(self, BUILD, SOURCE, config=f'[sample]\nname = "{NAME}-1"\noperator = "{NAME}-2"\n')
        daemon.ask("PUT", "/v1/plan", {"name": f"{NAME}-3", "operator": f"{NAME}-4"}, who=f"{NAME}-5")
        daemon.ask("POST", "/v1/batch", {"name": f"{NAME}-6", "replicates": 3}, who=f"{NAME}-5")
        process, frames = daemon.watch()
        wait_for(frames, lambda frame: frame["type"] == "test-ended")
        process.kill()
        process.communicate()
        record = daemon.record(1)
        parts, text = self.bundle("--config", "d.toml", folder=daemon.folder)
        self.assertNotIn(NAME, text)
        self.assertEqual(json.loads(parts["Status of the daemon"])["state"], "acquiring")
        self.assertIn("name left out", json.loads(parts["Status of the daemon"])["batch"]["name"])
        self.assertEqual(json.loads(parts["Status of the daemon"])["board"]["name"], "simulated tester")
        checks = {finding["check"] for finding in json.loads(parts["Checks of stickslip doctor"])["findings"]}
        self.assertLessEqual({"config", "daemon", "board", "disk"}, checks)
        self.assertRegex(parts["What is wrong"], "(?m)^warning  calibration  none")
        self.assertNotRegex(parts["What is wrong"], "(?m)^(good|unknown)")
        self.assertIn("ActiveState=failed", parts["System"])
        self.assertRegex(parts["Record folder"], r"(?m)^[1-9]\d* records, [1-9]\d+ bytes$")
        self.assertIn("test 7 began", parts["Log"])
        # The first record, as `show` has it, but for names.
        shown = json.loads(subprocess.run([str(CLI), "show", str(record), "--json"], capture_output=True, check=True, timeout=TIMEOUT_S).stdout)
        parts, text = self.bundle("--config", "d.toml", "--records", "100", "--with-names", folder=daemon.folder)
        first, _ = json.JSONDecoder().raw_decode(parts["Last records"])
        self.assertEqual(first["results"], shown["results"])
        self.assertEqual(first["facts"], shown["facts"])
        for number in (1, 2, 6):
            self.assertIn(f"{NAME}-{number}", text)
        parts, text = self.bundle("--config", "d.toml", "--records", "0", folder=daemon.folder)
        self.assertNotIn("{", parts["Last records"])

    def test_nothing_secret_of_a_configuration_that_is_wrong(self):
        for name, number in (("password", 10), ("token", 11), ("bench.key", 12)):
            (self.folder / name).write_text(f"{SECRET}-{number}\n", encoding="ascii")
            (self.folder / name).chmod(0o600)
        (self.folder / "d.toml").write_text(f"""# the old password: {SECRET}-20
{SIMULATED}clock_spead = "{SECRET}-21"
[method]
file = "bench.key"
[tester]
calibration = "token"
characterisation = "c.toml"
sled_mass = "2331 g"  # {SECRET}-22
[control]
token_file = "token"
password = "{SECRET}-23"
[fleet]
broker = "mqtts://u:{SECRET}-24@broker.plant"
tester = "bench-7"
user = "{SECRET}-25"
password_file = "{SECRET}-26"
key_file = "bench.key"
hosts = [
  "{SECRET}-27",
]
nested = {"{"} password = "{SECRET}-28" {"}"}
text = '''
{SECRET}-29
'''
[sample]
operator = "{NAME}"
""", encoding="utf-8")
        (self.folder / "c.toml").write_text(f'# {SECRET}-30\nprogram = "stickslip"\npassword = "{SECRET}-31"\n', encoding="utf-8")
        for options in ([], ["--with-names"]):
            with self.subTest(options=options):
                parts, text = self.bundle("--config", "d.toml", *options)
                self.assertEqual(re.findall(rf"{SECRET}\S*", text), [])
                self.assertEqual(NAME in text, bool(options))
                # What support needs is there.
                configuration = parts["Configuration"]
                for line in ('driver = "simulated"', 'sled_mass = "2331 g"', 'tester = "bench-7"', "broker = [removed]", "key_file = [removed]", "[fleet]", "user = [removed]", "password_file = [removed]"):
                    self.assertIn(f"{line}\n", configuration)
                self.assertRegex(parts["What is wrong"], r"(?m)^bad +config +d\.toml:\d+: ")
                self.assertEqual(parts["Files that it names"].count("names it for a secret"), 2)
                self.assertIn("test 7 began", parts["Log"])
                self.assertIn("[removed]@broker: refused", parts["Log"])
                self.assertIn("fleet.pin = [removed]\n", parts["Log"])

    def test_nothing_secret_however_it_was_typed(self):
        log = self.folder / "old.log"
        log.write_text(f"fleet: mqtts://b: password file /etc/stickslip/{SECRET} 1: cannot be read\nAuthorization: Basic {SECRET}\n"
                       f"stickslip --password {SECRET}\npassword: correct horse {SECRET}\n" + f'{{"msg":"{{\\"password\\":\\"{SECRET}\\"}}"}}\n' + "x" * 100_000 + SECRET + "\n",
                       encoding="utf-8")
        forms = [f'fleet = {{ broker = "mqtts://b", tester = "t", user = "u", password_file = "{SECRET}" }}\n',
                 f'[fleet]\npassword_file = """\n{SECRET} = x\n"""\n', f'[fleet]\npassword_file = \'\'\'\n{SECRET}=\n\'\'\'\n',
                 f'[fleet]\npassword_file = ["{SECRET}"]\n', f'[fleet]\nbroker = "u:{SECRET}@b"\n', f'[fleet]\nbroker = "mqtts:u:{SECRET}@b"\n',
                 f'[fleet]\nbroker = "{SECRET}"\n', f'[control]\nhttp = "u:{SECRET}@127.0.0.1:8080"\n', f'"pin!" = "{SECRET}"\n', f"control = ['{SECRET}']\n",
                 f'[sample.metadata]\n{SECRET} = "x"\n', f'[sample]\nfacts = [\n  "{SECRET}=1",\n]\n', f'{SECRET}==\n', f'[record]\nfolder = "smb://u:{SECRET}@nas/records"\n',
                 f'[fleet]\ntester = "t"  pin "{SECRET}"\n', f'[board]\nclock_speed = 1\r[fleet]\rpassword_file = "{SECRET}"\n']
        for form in forms:
            for first in ("", "\ufeff"):
                with self.subTest(form=form, first=first):
                    (self.folder / "d.toml").write_text(first + form, encoding="utf-8")
                    _, text = self.bundle("--config", "d.toml", "--log", str(log))
                    self.assertNotIn(SECRET, text)

    def test_a_part_that_cannot_be_made_leaves_the_others(self):
        (self.folder / "d.toml").write_text(f'{SIMULATED}[control]\nsocket = "{"s" * 120}"\n', encoding="utf-8")
        parts, _ = self.bundle("--config", "d.toml")
        self.assertRegex(parts["Status of the daemon"], "^missing: ")
        self.assertIn('driver = "simulated"\n', parts["Configuration"])

    def test_a_name_of_a_password_file_that_is_none_may_be_the_password(self):
        (self.folder / "d.toml").write_text(f'{SIMULATED}[fleet]\nbroker = "mqtts://b"\ntester = "t"\nuser = "u"\npassword_file = "{SECRET}"\n', encoding="utf-8")
        parts, text = self.bundle("--config", "d.toml")
        self.assertNotIn(SECRET, text)
        self.assertRegex(parts["What is wrong"], r"(?m)^bad +fleet +password file \[removed\]: ")

    def test_a_configuration_that_is_no_toml(self):
        (self.folder / "records").mkdir()
        (self.folder / "records" / "20261122T101500Z-0001.journal.damaged").write_bytes(b"1234")
        (self.folder / "d.toml").write_text(f'{SIMULATED}[record\nfolder = "records"\n[log]\nlevel = "info  # {SECRET}\n{SECRET}\n', encoding="utf-8")
        parts, text = self.bundle("--config", "d.toml")
        self.assertNotIn(SECRET, text)
        self.assertRegex(parts["What is wrong"], r"^bad +config +d\.toml:\d+: ")
        self.assertIn('driver = "simulated"\n', parts["Configuration"])
        self.assertIn("level = [removed]\n[removed]\n", parts["Configuration"])
        self.assertRegex(parts["Files that it names"], r"^missing: the configuration cannot be read: d\.toml:\d+: ")
        self.assertRegex(parts["Record folder"], r"1 damaged journals, 4 bytes\n  records/20261122T101500Z-0001\.journal\.damaged, 4 bytes")

    def test_nothing_is_there(self):
        parts, text = self.bundle("--config", "none.toml", environment={**os.environ, "PATH": str(self.folder)})
        self.assertRegex(parts["What is wrong"], r"^bad +config +none\.toml: there is no such file")
        self.assertRegex(parts["Configuration"], "^missing: none.toml: there is no such file")
        self.assertRegex(parts["Status of the daemon"], "^missing: /run/stickslip/control.sock: nobody answers")
        self.assertRegex(parts["Log"], "^missing: there is no program journalctl")
        self.assertRegex(parts["Record folder"], "^missing: there is no such folder")
        self.assertRegex(parts["Last records"], "^missing: ")
        self.assertIn("missing: there is no program df", parts["System"])

    def test_a_journal_that_may_not_be_read_says_so(self):
        parts, text = self.bundle("--config", "none.toml", environment=self.tools(journalctl="echo 'insufficient permissions' >&2; exit 1"))
        self.assertRegex(parts["Log"], "^insufficient permissions\nmissing: journalctl ended with 1\n")

    def test_a_log_in_a_file_is_taken_from_its_end(self):
        lines = [f"line {number} of the log\n" for number in range(20_000)]
        (self.folder / "bench.log").write_text("".join(lines) + "x" * 5000 + "\nlast\n", encoding="ascii")
        parts, text = self.bundle("--config", "none.toml", "--log", "bench.log")
        self.assertTrue(parts["Log"].endswith("line 19999 of the log\n[a line of 5000 bytes is left out]\nlast\n\n"))
        self.assertRegex(parts["Log"], r"^line \d+ of the log\n")
        self.assertLess(len(parts["Log"]), 262_144)
        parts, text = self.bundle("--config", "none.toml", "--log", "none.log")
        self.assertRegex(parts["Log"], "^missing: .*none.log: there is no such file")

    def test_a_damaged_record_is_named(self):
        (self.folder / "records").mkdir()
        (self.folder / "records" / "20261122T101500Z-0001.h5").write_bytes(b"no record")
        (self.folder / "d.toml").write_text(SIMULATED, encoding="utf-8")
        parts, text = self.bundle("--config", "d.toml")
        self.assertRegex(parts["Last records"], "^missing: records/20261122T101500Z-0001.h5: ")

    def test_no_file_is_overwritten(self):
        (self.folder / "kept.txt").write_text("kept", encoding="ascii")
        done = subprocess.run([str(CLI), "bundle", "--config", "none.toml", "-o", "kept.txt"], cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S,
                              check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("kept.txt", done.stderr)
        self.assertEqual((self.folder / "kept.txt").read_text(encoding="ascii"), "kept")
        done = subprocess.run([str(CLI), "bundle", "--config", "none.toml"], cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=True)
        [file] = self.folder.glob("stickslip-bundle-*.txt")
        self.assertRegex(file.name, r"^stickslip-bundle-\d{8}T\d{6}Z\.txt$")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

"""The package upgraded under a daemon that measures, in a whole Debian 12. The package before is the one that the environment variable
STICKSLIP_VM_OLD_PACKAGE names (./dev upgrade-test), else the present one."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import debian
import guest
import kernel
import support
import verdict

SCENE = support.SCENES / "stick-slip-at-12-in-per-min.toml"
CONFIG = """
[board]
driver = "simulated"
[board.simulated]
scenes = ["short.toml", "long.toml"]
repeats = 0
[tester]
load_cell_gain = "2 N/V"
calibration = "/var/lib/stickslip/calibrations"
[record]
folder = "/var/lib/stickslip/records"
dated_folders = "month"
[control]
socket = "/run/stickslip/control.sock"
http = "127.0.0.1:8037"
token_file = "/var/lib/stickslip/token"
[fleet]
broker = "mqtt://127.0.0.1:1"
tester = "bench-7"
"""


def newer(package, folder):
    """The same, as of a later version that ships another configuration."""
    unpacked, made = folder / "unpacked", folder / "newer.deb"
    subprocess.run(["dpkg-deb", "-R", package, unpacked], check=True)
    control = unpacked / "DEBIAN" / "control"
    text = control.read_text()
    control.write_text(text.replace("\nVersion: ", "\nVersion: 1000."))
    with (unpacked / "etc" / "stickslip" / "stickslipd.toml").open("a") as shipped:
        shipped.write("# Of a later version.\n")
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Znone", "-b", unpacked, made], check=True, stdout=subprocess.DEVNULL)
    return made


class Upgrade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        found = kernel.find_kernel()
        disk = support.or_skip(debian.disk_image, found, [support.DAEMON, support.CLI])
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            [package] = support.PACKAGE.glob("*.deb")
            (folder / "stickslipd.toml").write_text(CONFIG)
            scene = SCENE.read_text(encoding="utf-8")
            (folder / "short.toml").write_text(scene, encoding="utf-8")
            assert scene.count('\npull = "5 s"') == 1
            (folder / "long.toml").write_text(scene.replace('\npull = "5 s"', '\npull = "600 s"'), encoding="utf-8")
            files = {"run.sh": support.HERE / "guest" / "upgrade.sh", "unit.sh": support.HERE / "guest" / "unit.sh",
                     "old.deb": pathlib.Path(os.environ.get("STICKSLIP_VM_OLD_PACKAGE", package)), "new.deb": newer(package, folder),
                     **{name: folder / name for name in ("stickslipd.toml", "short.toml", "long.toml")}}
            cls.results = debian.run_full_guest(guest.folder_for(support.FOLDER, "upgrade"), found, disk, files)

    def read(self, name):
        return json.loads((self.results / name).read_text())

    def test_the_new_version_measures(self):
        self.assertTrue((self.results / "version").read_text().startswith("1000."))
        self.assertEqual(support.status(self.results, ".", "after")["state"], "acquiring")

    def test_the_test_under_way_is_recorded_as_interrupted(self):
        running = verdict.judge(self.results / "records" / "running.h5")
        self.assertEqual((running.status, running.gaps), ("interrupted", []))

    def test_the_journal_of_a_killed_daemon_before_becomes_a_record(self):
        killed = verdict.judge(self.results / "records" / "killed.h5")
        self.assertEqual((killed.status, killed.gaps, killed.end_cause), ("interrupted", [], "program-died"))
        self.assertGreater(len(killed.scan), 350)

    def test_no_record_is_damaged(self):
        files = self.read("verify.json")["files"]
        self.assertGreaterEqual(len(files), 5)
        self.assertLessEqual({file["judgement"] for file in files}, {"complete", "incomplete"})

    def test_the_batch_goes_on(self):
        before, after = self.read("batch-before.json")["batch"], self.read("batch-after.json")["batch"]
        self.assertEqual((after["id"], {key: after["plan"][key] for key in before["plan"]}), (before["id"], before["plan"]))
        # Besides those of before the two interrupted ones.
        self.assertGreaterEqual(after["done"], before["done"] + 2)
        for test in before["tests"]:
            self.assertIn(test, after["tests"])

    def test_results_that_wait_for_the_broker_still_do(self):
        before, after = (set((self.results / f"outbox-{when}").read_text().split()) for when in ("before", "after"))
        self.assertIn("told", before)
        self.assertGreater(len(before), 2)
        self.assertLess(before, after)


if __name__ == "__main__":
    unittest.main()

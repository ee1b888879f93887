"""The unit in a whole Debian 12: its user and groups, a board that goes and returns, an orderly end."""

import pathlib
import tempfile
import unittest

import codes
import debian
import guest
import kernel
import support
import verdict

SCENE = "stick-slip-at-12-in-per-min"
CONFIGURATION = """[board]
driver = "comedi"
[tester]
sled_mass = "2331 g"
load_cell_gain = "2 N/V"
[record]
folder = "/var/lib/stickslip/records"
[control]
socket = "/run/stickslip/control.sock"
"""


def lines(path):
    return path.read_text().splitlines()


class Unit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        found = kernel.find_kernel()
        disk = support.or_skip(debian.disk_image, found, [support.DAEMON, support.CLI])
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            # A pull longer than the guest looks at it.
            played = codes.write_codes(folder, codes.simulate(folder, SCENE, "--duration", "5 min"))
            configuration = folder / "stickslipd.toml"
            configuration.write_text(CONFIGURATION)
            files = {"run.sh": support.HERE / "guest" / "service.sh", "stickslipd": support.DAEMON,
                     "stickslip": support.CLI, "stickslip_tester.ko": support.tester_module(found),
                     "stickslipd.service": support.SOURCE / "systemd" / "stickslipd.service",
                     "stickslipd.toml": configuration, "codes.bin": played}
            cls.results = debian.run_full_guest(guest.folder_for(support.FOLDER, "service"), found, disk, files)

    def status(self, when):
        return support.status(self.results, ".", when)

    def test_the_board_belongs_to_group_iocard(self):
        self.assertEqual(lines(self.results / "device"), ["660 root iocard"])

    def test_the_daemon_runs_as_its_own_user_in_group_iocard_without_privilege(self):
        process = dict(line.split(":", 1) for line in lines(self.results / "process"))
        [user] = lines(self.results / "user")
        self.assertNotEqual(user, "0")
        self.assertEqual(set(process["Uid"].split()), {user})
        self.assertIn(lines(self.results / "iocard")[0], process["Groups"].split())
        self.assertEqual(int(process["CapEff"], 16), 0)
        self.assertEqual(process["NoNewPrivs"].strip(), "1")

    def test_it_acquires_in_real_time(self):
        status = self.status("started")
        self.assertEqual(status["state"], "acquiring")
        self.assertTrue(status["scheduling"].startswith("SCHED_FIFO"), status["scheduling"])

    def test_it_survives_removal_and_return(self):
        self.assertEqual(self.status("gone")["state"], "board missing")
        self.assertIn("board missing", (self.results / "text-gone").read_text())
        self.assertEqual(self.status("returned")["state"], "acquiring")
        self.assertIn("acquiring", (self.results / "text-returned").read_text())

    def test_it_stops_in_order(self):
        self.assertEqual(lines(self.results / "end"),
                         ["ActiveState=inactive", "Result=success", "ExecMainStatus=0", "NRestarts=0"])

    def test_every_scan_is_in_records_of_its_user(self):
        files = lines(self.results / "files")
        # The test that the removal ended, and the one that the end of the daemon ended.
        self.assertEqual(len(files), 2, files)
        for file in files:
            self.assertRegex(file, r"^640 stickslip stickslip /.*\.h5$")
        for path in support.records(self.results, "."):
            verdict.judge(path)


if __name__ == "__main__":
    unittest.main()

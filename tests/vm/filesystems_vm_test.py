"""Records on ext4 and vfat: the daemon, its finaliser, recover, verify and doctor make and judge them on both."""

import gzip
import json
import pathlib
import subprocess
import tempfile
import unittest

import codes
import support
import verdict

SYSTEMS = ("ext4", "vfat")
SCENE = "stick-slip-at-12-in-per-min"
# Room for more than ten minutes of tests (11.5 MB) and for the ballast.
SIZE = "64M"
MAKE_TIMEOUT_S = 60
INCOMPLETE = 1


def ext4_image(folder):
    """A new file system, compressed: it is nearly all zeros."""
    plain = folder / "ext4.img"
    subprocess.run(["/sbin/mke2fs", "-q", "-t", "ext4", plain, SIZE], check=True, stdout=subprocess.DEVNULL, timeout=MAKE_TIMEOUT_S)
    packed = folder / "ext4.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes(), 1))
    return packed


def long_scene(folder):
    """The same with a pull that nothing in the guest outlasts."""
    text = codes.scene_file(SCENE).read_text(encoding="utf-8")
    assert text.count('\npull = "5 s"') == 1
    path = folder / "long.toml"
    path.write_text(text.replace('\npull = "5 s"', '\npull = "600 s"'), encoding="utf-8")
    return path


class FileSystems(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            cls.results = support.or_skip(support.small_guest, "filesystems", {
                "/filesystems/scene.toml": codes.scene_file(SCENE), "/filesystems/long.toml": long_scene(folder),
                "/filesystems/ext4.gz": ext4_image(folder)})

    def told(self, system, what):
        """(exit status, what it said)"""
        folder = self.results / system
        return int((folder / f"{what}.status").read_text()), (folder / what).read_text()

    def verdicts(self, system, what):
        return {pathlib.Path(file["file"]).name: file for file in json.loads(self.told(system, what)[1])["files"]}

    def for_each(self, check):
        for system in SYSTEMS:
            with self.subTest(system):
                check(system)

    def test_a_test_is_recorded_whole(self):
        def check(system):
            status, said = self.told(system, "recorded.json")
            self.assertEqual(status, 0, said)
            self.assertEqual(len(self.verdicts(system, "recorded.json")), 1)
        self.for_each(check)

    def test_neither_lacks_anything(self):
        def check(system):
            findings = json.loads(self.told(system, "doctor.json")[1])["findings"]
            [found] = [finding for finding in findings if finding["check"] == "filesystem"]
            self.assertEqual(found["verdict"], "good", found)
            self.assertEqual(support.status(self.results, system, "at-work")["storage"]["lacks"], [])
            self.assertNotIn("the file system", (self.results / system / "daemon.log").read_text())
        self.for_each(check)

    def test_a_journal_that_is_written_is_left_alone(self):
        def check(system):
            status, said = self.told(system, "live")
            self.assertNotEqual(status, 0)
            self.assertIn("is being written or finished by another process", said)
        self.for_each(check)

    def test_a_killed_test_is_recovered_as_interrupted(self):
        def check(system):
            self.assertEqual(self.told(system, "journal.json")[0], INCOMPLETE)
            [journal] = self.verdicts(system, "journal.json").values()
            self.assertEqual(journal["judgement"], "incomplete", journal)
            status, said = self.told(system, "recovered")
            self.assertEqual(status, 0, said)
            status, said = self.told(system, "all.json")
            self.assertEqual(status, INCOMPLETE, said)
            interrupted = [file for file in self.verdicts(system, "all.json").values() if file["judgement"] != "complete"]
            self.assertEqual([file["status"] for file in interrupted], ["interrupted"])
            self.assertEqual(interrupted[0]["scans_present"], journal["scans_present"])
        self.for_each(check)

    def test_nothing_is_left_beside_the_records(self):
        def check(system):
            names = (self.results / system / "names").read_text().split()
            # The ballast is the killed daemon's.
            others = [name for name in names if not name.endswith(".h5") and name not in (".", "..", ".stickslip-ballast", "tester-history.jsonl")]
            self.assertEqual(others, [])
        self.for_each(check)

    def test_they_are_read_here_too(self):
        def check(system):
            for path in support.records(self.results, system):
                self.assertEqual(verdict.judge(path).gaps, [])
        self.for_each(check)


if __name__ == "__main__":
    unittest.main()

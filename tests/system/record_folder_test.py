#!/usr/bin/env python3
"""The real daemon, whose journals and folder of records vanish in mid-test: what it says at its end is what files hold.

record_folder_test.py BUILD_DIR SOURCE_DIR [unittest arguments]

Where nothing may be mounted, the file system that vanishes is skipped, and says so. Nothing sleeps.
"""

import errno
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from running_daemon import PATIENT, RunningDaemon
from service_manager import TIMEOUT_S
from small_disk import mount, own_mounts

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
DISK_MIB = 64
MANY_LINES = 40
WHY_NO_MOUNTS = None


def rows_in(*folders):
    import h5py
    rows = 0
    for folder in folders:
        for path in folder.rglob("*.h5"):
            with h5py.File(path) as file:
                rows += len(file["entry/data/scan"] if "entry/data/scan" in file else file["entry/raw/scan"])
    return rows


def remove(folder):
    """As rm -r does it, called again where a journal was made anew between the removal of the files and that of the folder."""
    while True:
        try:
            return shutil.rmtree(folder)
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.ENOENT):
                raise


class RecordFolder(unittest.TestCase):
    def start(self, prepare=lambda folder: (folder / "disk").mkdir()):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, records="disk/records", prepare=prepare, times=PATIENT)
        self.records = self.daemon.folder / "disk" / "records"

    def told(self, wanted):
        """The next line of the log that has it."""
        for _ in range(MANY_LINES):
            if found := re.search(wanted, self.daemon.unread.get(timeout=TIMEOUT_S)):
                return found
        raise AssertionError(f"not told: {wanted}: {self.daemon.log}")

    def journal(self):
        """That of the running test, once it grows by scans."""
        process, frames = self.daemon.watch()
        try:
            sizes = {}
            for _ in frames:
                for path in self.records.glob("*.journal"):
                    if path.stat().st_size > sizes.setdefault(path, path.stat().st_size):
                        return path
        finally:
            process.kill()
            process.communicate()
        raise AssertionError("the stream ended")

    def account(self, *folders, removed=0):
        """The daemon ends, and has counted the scans that the files hold."""
        code, log = self.daemon.end()
        self.assertEqual(code, 0, log)
        found = re.search(r"scans: (\d+) indices = (\d+) in records \+ (\d+) between tests \+ (\d+) in gaps$", log, re.MULTILINE)
        self.assertTrue(found, log)
        self.assertGreater(int(found[2]), 0)
        self.assertEqual(int(found[2]), rows_in(*folders) + removed, log)
        self.assertEqual(list(self.records.glob("*.journal")), [])
        return log

    def test_a_journal_that_is_removed_is_written_anew(self):
        self.start()
        self.told("test 1 began")
        self.journal().unlink()
        self.told("test 1: the journal was removed, renamed or replaced while it was open: ")
        self.told(r"test 1: .*\.h5")
        self.account(self.records)

    def test_a_journal_that_is_replaced_stands_beside_what_replaced_it(self):
        self.start()
        self.told("test 1 began")
        journal = self.journal()
        notes = self.records / "notes"
        notes.write_text("somebody's", encoding="utf-8")
        name = self.records / "notes.txt"
        notes.rename(journal)
        self.told("all of it was written anew")
        journal.rename(name)
        self.told(r"test 1: .*-0001-2\.h5")
        self.account(self.records)
        self.assertEqual(name.read_text(encoding="utf-8"), "somebody's")

    def test_a_folder_that_is_renamed_is_made_again(self):
        self.start()
        self.told(r"test 1: .*\.h5")
        self.journal()
        elsewhere = self.daemon.folder / "elsewhere"
        self.records.rename(elsewhere)
        self.told("test 2: the journal was removed, renamed or replaced while it was open: ")
        self.told(r"test 2: .*\.h5")
        self.account(self.records, elsewhere)
        self.assertEqual(len(list(elsewhere.glob("*.h5"))), 1)

    def test_a_folder_that_is_removed_is_made_again(self):
        self.start()
        self.told(r"test 1: .*\.h5")
        self.journal()
        removed = rows_in(self.records)
        remove(self.records)
        self.told("test 2: the journal was removed, renamed or replaced while it was open: ")
        self.told(r"test 2: .*\.h5")
        self.account(self.records, removed=removed)

    def test_a_file_system_that_is_unmounted_is_waited_for(self):
        if WHY_NO_MOUNTS:
            self.skipTest(WHY_NO_MOUNTS)

        def bind(folder):
            subprocess.run(["mount", "--bind", str(folder / "real"), str(folder / "disk")], check=True)

        def prepare(folder):
            (folder / "disk").mkdir()
            (folder / "real").mkdir()
            mount(folder / "real", DISK_MIB)
            self.addCleanup(lambda: subprocess.run(["umount", "-l", str(folder / "real")], check=False))
            bind(folder)
            self.addCleanup(lambda: subprocess.run(["umount", "-l", str(folder / "disk")], check=False))
        self.start(prepare)
        self.told("test 1 began")
        self.journal()
        subprocess.run(["umount", "-l", str(self.daemon.folder / "disk")], check=True)
        self.told("storage waiting: the folder of the records is away, .* not mounted any more; mount the file system of ")
        # The test ends and others begin meanwhile; what is asked for is refused, with the remedy.
        self.told("test 2 ended")
        status = self.daemon.ask("GET", "/v1/status")[1]
        self.assertEqual(status["storage"]["state"], "waiting")
        self.assertIn("is away", status["detail"])
        self.assertEqual(status["scans"]["recorded"], 0)
        code, refused = self.daemon.ask("POST", "/v1/arm", {})
        self.assertEqual(code, 409, refused)
        self.assertFalse(self.records.exists())
        bind(self.daemon.folder)
        self.told("all that waited is written")
        self.told(r"test 2: .*\.h5")
        self.account(self.records)


if __name__ == "__main__":
    WHY_NO_MOUNTS = own_mounts(needed=False)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

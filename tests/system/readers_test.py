#!/usr/bin/env python3
"""Analysts at home: records are read with h5py, pandas, silx, GNU Octave and h5dump as Debian packages them, by the
lines that docs/record-file.md shows, and plot by default as NeXus asks.

A tool that is not installed is skipped with its package's name, except where CI=true.

readers_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import importlib.util
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
TIMEOUT_S = 300


def needs(package, here):
    """Skips the test where the tool is missing, but not in CI."""
    return unittest.skipUnless(here or os.environ.get("CI") == "true", f"{package} is not installed")


def module(name):
    return importlib.util.find_spec(name) is not None


def blocks(language):
    """The blocks of that language among the readers."""
    text = (SOURCE / "docs" / "record-file.md").read_text(encoding="utf-8")
    section = text[text.index("## Reading it"):text.index("## Conventions")]
    return re.findall(rf"^```{language}\n(.*?)^```$", section, re.DOTALL | re.MULTILINE)


def dumped(path, record="TEST.h5"):
    """A scalar as h5dump prints it, all digits of it."""
    done = subprocess.run(["h5dump", "-m", "%.17g", "-d", path, record], capture_output=True, text=True, check=True,
                          timeout=TIMEOUT_S)
    return float(re.search(r"DATA \{\s*\(0\): ([^\s]+)", done.stdout)[1])


class Readers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory(prefix="stickslip-")
        cls.addClassCleanup(cls.place.cleanup)
        cls.before = os.getcwd()
        os.chdir(cls.place.name)
        cls.addClassCleanup(os.chdir, cls.before)
        subprocess.run([BUILD / "bin" / "stickslip", "simulate", "stick-slip-at-12-in-per-min", "-o", "TEST.h5",
                        "--folder", SOURCE / "config" / "scenes"], check=True, capture_output=True, timeout=TIMEOUT_S)

    def run_python(self, block, checks):
        """In an interpreter of its own, as a user would."""
        done = subprocess.run([sys.executable, "-c", block + checks], capture_output=True, text=True, check=False,
                              timeout=TIMEOUT_S, env=dict(os.environ, QT_QPA_PLATFORM="offscreen"))
        self.assertEqual(done.returncode, 0, block + done.stderr)
        return done.stdout

    def python_block(self, word):
        [block] = [block for block in blocks("python") if word in block]
        return block

    @needs("python3-h5py", module("h5py"))
    def test_h5py(self):
        self.run_python(self.python_block("# Python"), "\nassert force.shape == (2800,) and 0.34 < mu_s < 0.36, mu_s\n")

    @needs("python3-pandas", module("pandas"))
    def test_pandas(self):
        self.run_python(self.python_block("pandas"),
                        "\nassert len(cycles) > 90 and abs(cycles.delta_mu.median() - 0.05) < 0.001, cycles\n")

    @needs("python3-silx", module("silx"))
    def test_silx_plots_force_against_time_by_default(self):
        self.run_python(self.python_block("silx"), """
assert plot.is_valid and plot.signal_dataset_name == "force" and plot.axes_dataset_names == ["time"], plot
assert len(time) == len(force) == 2800 and 0 < force[1000] < 12
assert plot.signal.attrs["units"] == "N" and plot.axes[0].attrs["units"] == "s"
""")

    @needs("octave", shutil.which("octave-cli"))
    def test_octave(self):
        [block] = blocks("octave")
        done = subprocess.run(["octave-cli", "--norc", "--eval", block + "\nprintf('%.17g %.17g %d', mu_s, "
                               "max(force), numel(time));"], capture_output=True, text=True, check=False,
                              timeout=TIMEOUT_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        mu_s, largest, count = done.stdout.split()[-3:]
        self.assertEqual(float(mu_s), dumped("/entry/results/mu_s"))
        self.assertTrue(5 < float(largest) < 12, largest)
        self.assertEqual(int(count), 2800)

    @needs("hdf5-tools", shutil.which("h5dump"))
    def test_h5dump(self):
        [block] = blocks("shell")
        subprocess.run(["bash", "-euc", block], check=True, capture_output=True, timeout=TIMEOUT_S)
        column = [float(value) for value in pathlib.Path("force.txt").read_text(encoding="ascii").split(",")]
        self.assertEqual(len(column), 2800)
        self.assertFalse(any(math.isnan(value) for value in column))
        # Everything, with all attributes.
        done = subprocess.run(["h5dump", "TEST.h5"], capture_output=True, check=True, timeout=TIMEOUT_S)
        self.assertGreater(len(done.stdout), 100_000)

    @needs("python3-h5py", module("h5py"))
    def test_hdf5_1_8_knows_every_part_of_the_file(self):
        import h5py
        import hdf5_1_8
        objects, messages, indexes = hdf5_1_8.check("TEST.h5")
        self.assertGreater(objects, 60)
        self.assertGreater(messages, 5 * objects)
        self.assertGreater(indexes, 10)
        # The check can fail: what 1.10 writes if it may is refused, its superblock and the index of its chunks.
        with h5py.File("new.h5", "w", libver="v110") as file:
            file.create_dataset("column", data=range(100), chunks=(10,), maxshape=(None,), compression="gzip")
            address = h5py.h5o.get_info(file["column"].id).addr
        with self.assertRaisesRegex(hdf5_1_8.NotForOldReaders, "superblock of version 3"):
            hdf5_1_8.check("new.h5")
        with self.assertRaisesRegex(hdf5_1_8.NotForOldReaders, "column: message of type 0x8 and version 4"):
            hdf5_1_8.File(pathlib.Path("new.h5").read_bytes()).check_object(address, "column")

    def test_nexus_rules(self):
        import h5py

        sys.path.insert(0, str(SOURCE / "tests" / "system"))
        import nexus

        self.assertEqual(nexus.check("TEST.h5"), [])
        # The checker itself sees what it is for.
        for damage, told in (("entry/raw/@signal", "signal"), ("entry/@default", "default leads"),
                             ("entry/raw/force/@units", "has no units"), ("entry/@NX_class", "NX_class")):
            shutil.copy("TEST.h5", "damaged.h5")
            place, _, name = damage.partition("/@")
            with h5py.File("damaged.h5", "r+") as record:
                del record[place].attrs[name]
            self.assertTrue(any(told in sentence for sentence in nexus.check("damaged.h5")), damage)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

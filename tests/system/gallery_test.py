#!/usr/bin/env python3
"""`stickslip plot` from outside, and the gallery that is made with it: each shipped scene has in docs/gallery.md a
picture and the command that draws it, and the committed pictures show what the program draws now.

gallery_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI = BUILD / "bin" / "stickslip"
SCENES = SOURCE / "config" / "scenes"
GALLERY = SOURCE / "docs" / "gallery.md"
PICTURES = SOURCE / "docs" / "gallery"
SCENE = "stick-slip-at-12-in-per-min"
SVG = "{http://www.w3.org/2000/svg}"

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600
LARGEST_PICTURE = 150_000

# gnuplot writes hundredths of a pixel. Another processor may differ in the last bits of the scans, which moves a
# reading by one step of the converter at most: 16 bits over 20 V are 2.7e-5 in the force, less than a tenth of a
# pixel in every picture, and so for the numbers that the detector takes from them.
TOLERANCE_PX = 0.2


def run(*arguments, cwd=None, environment=None):
    return subprocess.run([str(a) for a in arguments], cwd=cwd, capture_output=True, text=True, env=environment,
                          timeout=TIMEOUT_S, check=False)


def texts(svg):
    return [text for text in ("".join(node.itertext()).strip() for node in svg.iter(f"{SVG}text")) if text]


def numbers(svg):
    """All coordinates of curves, points and shades, element by element."""
    found = []
    for node in svg.iter():
        for name in ("d", "points", "transform"):
            if name in node.attrib:
                found.append([float(n) for n in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", node.attrib[name])])
    return found


def drawn_by(svg):
    return svg.find(f"{SVG}desc").text


class Folder(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def plot(self, *arguments):
        done = run(CLI, "plot", *arguments, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        [name] = re.findall(r"^(.*): \d+ scans$", done.stdout, re.MULTILINE)
        return xml.etree.ElementTree.parse(self.folder / name)

    def simulate(self, *options):
        done = run(CLI, "simulate", SCENE, "-o", self.folder / "x.h5", *options)
        self.assertEqual(done.returncode, 0, done.stderr)


class Plot(Folder):
    def test_a_record_of_a_scene_looks_like_the_scene(self):
        self.simulate()
        record = self.plot("x.h5", "--from", "2", "--to", "2500 ms")
        scene = self.plot(SCENE, "--from", "2", "--to", "2500 ms")
        self.assertEqual(sorted(f.name for f in self.folder.glob("*.svg")), [f"{SCENE}.svg", "x.svg"])
        self.assertEqual(numbers(record), numbers(scene))
        shown = texts(scene)
        for text in ("stick", "slip", "time (s)", "force / weight", "S of each slip (truth)",
                     "Fig. 3: sticks and slips for ever (Baie Comeau, 12 in/min)"):
            self.assertIn(text, shown)
        self.assertNotIn("slack", shown)  # Not in this part.
        self.assertIn(SCENE, texts(record))  # The title of the record.

    def test_a_measured_trace_has_no_truth_to_show(self):
        (self.folder / "trace.csv").write_text(
            "t,mu\n" + "".join(f"{i / 100},{0.3 + 0.05 * (i % 10)}\n" for i in range(300)), encoding="ascii")
        done = run(CLI, "import", "trace.csv", "--column", "mu", "--rate", "100 Hz", "--unit", "coefficient", "-o",
                   "trace.h5", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        shown = texts(self.plot("trace.h5", "--derivative"))
        self.assertIn("force at each scan", shown)
        self.assertIn("rate of force / weight (1/s)", shown)
        for text in ("stick", "slip", "S of each slip (truth)"):
            self.assertNotIn(text, shown)

    def test_panels_come_with_their_options(self):
        self.assertNotIn("whole record", texts(self.plot(SCENE, "-o", "a.svg")))
        both = texts(self.plot(SCENE, "-o", "b.svg", "--from", "1", "--to", "2", "--overview", "--derivative"))
        self.assertIn("whole record", both)
        self.assertIn("stretching (mm/s)", both)

    def test_a_long_record_gives_a_small_picture(self):
        # 105 000 scans, 5 700 slips; a line in a picture 900 wide has at most two points for each column.
        self.simulate("--duration", "300 s")
        shown = texts(self.plot("x.h5"))
        self.assertIn("modes change too often to be shaded here: show a part of the record", shown)
        self.assertLess((self.folder / "x.svg").stat().st_size, 3 * LARGEST_PICTURE)
        self.assertIn("stick", texts(self.plot("x.h5", "-o", "part.svg", "--from", "100", "--to", "101")))

    def refused(self, status, expected, *arguments, environment=None):
        before = sorted(self.folder.rglob("*"))
        done = run(CLI, "plot", *arguments, cwd=self.folder, environment=environment)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertTrue(done.stderr.startswith(f"stickslip: {expected}"), done.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_what_cannot_be_drawn_is_named_and_leaves_nothing(self):
        (self.folder / "there.svg").write_text("mine", encoding="ascii")
        (self.folder / "text.h5").write_text("no record", encoding="ascii")
        for expected, *arguments in [
            ("there.svg: exists", SCENE, "-o", "there.svg"),
            ("no/x.svg: there is no folder", SCENE, "-o", "no/x.svg"),
            ("--from: ", SCENE, "--from", "early"),
            (f"{SCENE}: from 8 s: ", SCENE, "--from", "8"),
            (f"{SCENE}: from -1 s: ", SCENE, "--from=-1"),
            (f"{SCENE}: to 1 s: ", SCENE, "--from", "1", "--to", "1"),
            ("stick: is neither a file nor a scene", "stick"),
            ("missing.h5: there is no such file", "missing.h5"),
            ("text.h5: ", "text.h5"),
        ]:
            with self.subTest(arguments):
                self.refused(2, expected, *arguments)
        self.assertEqual((self.folder / "there.svg").read_text(encoding="ascii"), "mine")

    def test_without_gnuplot_the_package_is_named(self):
        environment = dict(os.environ, PATH=str(self.folder))
        self.refused(1, "pictures are drawn by gnuplot, which is not installed; on Debian: apt-get install gnuplot-nox",
                     SCENE, environment=environment)


class Gallery(Folder):
    def commands(self):
        """The words after stickslip plot, by picture."""
        lines = re.findall(r"^stickslip plot (.*)$", GALLERY.read_text(encoding="utf-8"), re.MULTILINE)
        found = {f"{words[0]}.svg": words for words in map(shlex.split, lines)}
        self.assertEqual(len(found), len(lines))
        return found

    def test_each_scene_has_its_picture_and_each_picture_its_scene(self):
        scenes = sorted(file.stem for file in SCENES.glob("*.toml"))
        self.assertGreaterEqual(len(scenes), 15)
        self.assertEqual(sorted(self.commands()), [f"{name}.svg" for name in scenes])
        self.assertEqual(sorted(file.name for file in PICTURES.iterdir()), [f"{name}.svg" for name in scenes])
        shown = re.findall(r"^!\[[^\]]{20,}\]\(gallery/(.*)\)$", GALLERY.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(sorted(shown), [f"{name}.svg" for name in scenes])

    def test_committed_pictures_show_what_the_program_draws_now(self):
        for picture, words in self.commands().items():
            with self.subTest(picture):
                now = self.plot(*words)
                committed = xml.etree.ElementTree.parse(PICTURES / picture)
                self.assertLess((PICTURES / picture).stat().st_size, LARGEST_PICTURE)
                self.assertEqual(texts(committed), texts(now), "draw it anew: ./dev gallery")
                if drawn_by(committed) != drawn_by(now):
                    continue  # Another gnuplot may write the same curves in another way.
                expected, drawn = numbers(committed), numbers(now)
                self.assertEqual([len(element) for element in expected], [len(element) for element in drawn])
                for before, after in zip(expected, drawn):
                    for a, b in zip(before, after):
                        self.assertAlmostEqual(a, b, delta=TOLERANCE_PX, msg="draw it anew: ./dev gallery")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

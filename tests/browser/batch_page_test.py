#!/usr/bin/env python3
"""A whole batch on the simulated tester, run from the live page by keyboard in a real browser: begun, led from test to
test, one test void, ended, reported, compared with another; each number shown against the records'.

batch_page_test.py BUILD_DIR CHROMIUM SOURCE_DIR [unittest arguments]

With STICKSLIP_SCREENSHOTS=FOLDER in the environment pictures of the page are left there.
"""

import csv
import io
import json
import os
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

import h5py
import numpy

from chromium import Chromium
from contrast import contrast, rgb

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from running_daemon import RunningDaemon  # noqa: E402
import uncertain  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()
CHROMIUM = shutil.which(sys.argv[2])
SOURCE = pathlib.Path(sys.argv[3]).resolve()

MESSAGE = "document.getElementById('message').textContent"
FINISHED = "Now: the batch is finished, all 4 tests are made"
OF_BATCH = 4  # Columns that the table of tests has more while there is a batch: sample, grade, speed, replicate.
SCENES = SOURCE / "config" / "scenes"


class BatchPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Chromium(CHROMIUM, BUILD))

    def open(self, config='[test]\nbegins = "command"\n', speed=2, dark=False, **options):
        self.daemon = RunningDaemon(self, BUILD, SOURCE, speed=speed, **options, config=f'http = "127.0.0.1:0"\ntoken_file = "token"\n{config}')
        self.records = self.daemon.folder / "records"
        token = (self.daemon.folder / "token").read_text().strip()
        self.page = self.browser.open(f"http://{self.daemon.port_line()}/#token={token}", dark=dark)
        self.addCleanup(self.page.close)
        self.page.resize(1280, 720)
        self.page.until("document.querySelectorAll('#health dd').length > 5 && Scope.data.scan.length > 100")

    def text(self, name):
        return self.page.value(f"document.getElementById('{name}').textContent")

    def enter(self, selector, key="Enter", settle=True):
        """By keyboard: what cannot be reached cannot be pressed."""
        self.page.value(f"document.querySelector(\"{selector}\").focus()")
        self.assertTrue(self.page.value(f"document.activeElement === document.querySelector(\"{selector}\")"), selector)
        self.page.press(key, settle)

    def type(self, selector, text):
        self.page.value(f"document.querySelector(\"{selector}\").focus()")
        self.page.value(f"document.querySelector(\"{selector}\").select()")
        self.page.type(text)

    def begin(self, **fields):
        self.enter("#batch-open")
        if any("." in name for name in fields):
            self.enter("#batch-limits summary")
        for name, typed in fields.items():
            self.type(f"#batch-begin [name='{name}']", typed)
        self.page.press("Enter")
        self.page.until("!document.getElementById('batch-dialog').open")
        batch = self.batch()
        self.assertIn(batch["id"], self.text("message"))
        return batch

    def batch(self):
        return self.daemon.ask("GET", "/v1/batch")[1]["batch"]

    def step(self, step):
        speed = "" if step["pull_speed"] is None else f"{1000 * step['pull_speed']:.6g} mm/s, "
        return f"{speed}sheet {step['replicate']}, slide {step['slide']}"

    def measure(self):
        """The next test, begun and ended at the page. Returns its record, once its batch knows of it."""
        number = max((test["number"] for test in self.daemon.ask("GET", "/v1/tests")[1]["tests"]), default=0) + 1
        known = len(self.batch()["tests"])
        while True:
            self.page.until("Scope.data.highest.slice(-50).every(force => force < 0.02)")  # A whole pull is to come.
            self.page.value("document.getElementById('message').textContent = ''")
            self.enter("[data-command=start]")
            self.page.until(f"{MESSAGE} !== ''")
            # Other remarks may come over the page's own.
            if self.text("message").startswith("start: test") or self.daemon.ask("GET", "/v1/status")[1]["bench"] != "idle":
                break
        self.page.until(f"Scope.slips.filter(slip => slip.test === {number}).length > 15 || document.getElementById('bench-word').textContent === 'idle'")
        self.enter("[data-command=stop]")
        self.page.until(f"document.getElementById('record-{number}') && document.querySelectorAll('#batch-rows tr').length === {known + 1}")
        return self.records / self.page.value(f"document.getElementById('record-{number}').textContent")

    @staticmethod
    def facts(record):
        with h5py.File(record) as file:
            sample = file["entry/sample"]
            return (sample["batch"][()].decode(), sample["name"][()].decode(), round(float(file["entry/instrument/tester/pull_speed"][()]), 9),
                    int(sample["replicate"][()]), int(sample["slide"][()]))

    @staticmethod
    def with_errors(record, name, decimals=4):
        with h5py.File(record) as file:
            return uncertain.of(file, name, decimals)

    @staticmethod
    def results(records, name):
        values = []
        for record in records:
            with h5py.File(record) as file:
                values.append(float(file[f"entry/results/{name}"][()]))
        return numpy.array(values)

    def row(self, number):
        return self.page.value(f"(r => [r.className, ...[...r.cells].map(c => c.textContent)])(document.getElementById('void-{number}').closest('tr'))")

    def shown(self, selector):
        """The window that a button opens, with its report."""
        self.enter(selector, settle=False)
        shown = self.browser.opened("/page/report")
        shown.until("window.stickslip?.data")
        return shown

    def close(self, shown):
        self.assertEqual(shown.complaints(), [])
        shown.close()
        self.page.bring_to_front()
        self.page.until("document.getElementById('batches-dialog').getAttribute('aria-busy') === 'false'")

    def picture(self, name):
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            self.page.screenshot(pathlib.Path(folder) / f"{name}.png")

    def saved(self, act, name):
        """What a click saves, as text."""
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            self.browser.save_downloads(folder)
            act()
            self.page.until(f"document.getElementById('batches-message').textContent === 'saved {name}'")
            self.browser.wait_for_download()
            return (pathlib.Path(folder) / name).read_text(encoding="utf-8")

    def test_a_whole_batch_by_keyboard_from_its_plan_to_its_comparison(self):
        self.open()
        self.assertIn("no batch", self.text("batch-name"))
        batch = self.begin(name="liner 42", grade="kraft", pull_speeds="6 in/min, 12 in/min", replicates="1", slides="2")
        self.assertEqual([round(speed, 9) for speed in batch["plan"]["pull_speeds"]], [0.00254, 0.00508])
        asked = [(batch["id"], "liner 42", speed, 1, slide) for speed in (0.00254, 0.00508) for slide in (1, 2)]
        records = []
        for at, wanted in enumerate(asked):
            self.page.until(f"document.getElementById('next').textContent.includes('{self.step(self.batch()['next'])}')")
            self.assertEqual(self.text("batch-name"), f"liner 42, kraft: {at} of 4 tests made")
            records.append(self.measure())
            self.assertEqual(self.facts(records[-1]), wanted)
        self.page.until(f"document.getElementById('now').textContent === '{FINISHED}'")
        # Torn: it is struck out, says why, counts in no number, and is asked for again.
        self.enter("#void-2")
        self.page.type("paper torn")
        self.page.press("Enter")
        self.page.until("document.querySelector('#tests tr.void #void-2')")
        self.assertIn("void: paper torn", self.row(2))
        self.page.until("document.activeElement.id === 'void-2'")
        self.assertIn("line-through", self.page.value("getComputedStyle(document.querySelector('#tests tr.void td')).textDecorationLine"))
        self.assertEqual(self.text("next"), "Next: 2.54 mm/s, sheet 1, slide 2: leave the sheet on, then Arm or Start")
        self.assertIn("3 of 4", self.text("batch-name"))
        # Voided by mistake, and then again.
        self.enter("#void-2")
        self.page.until("!document.querySelector('#tests tr.void')")
        self.page.until(f"document.getElementById('now').textContent === '{FINISHED}'")
        self.enter("#void-2")
        self.page.type("paper torn")
        self.page.press("Enter")
        self.page.until("document.querySelector('#tests tr.void #void-2')")
        untouched = records[1].read_bytes()
        records.append(self.measure())
        self.assertEqual(self.facts(records[-1]), asked[1])
        self.assertEqual(records[1].read_bytes(), untouched)
        self.page.until(f"document.getElementById('now').textContent === '{FINISHED}'")
        counted = [records[0], *records[2:]]
        self.page.until("document.querySelectorAll('#tests tfoot tr').length >= 6")
        mean = self.page.value("[...document.querySelector('#tests thead tr:nth-child(2)').cells].map(c => c.textContent)")
        for cell, name in zip(mean[OF_BATCH + 2:], ("delta_mu", "mu_s", "mu_k"), strict=False):
            self.assertAlmostEqual(float(cell), self.results(counted, name).mean(), delta=0.5001e-4, msg=name)
        # The tests of the batch, as the daemon lists them.
        self.page.value("document.getElementById('batch-tests').open = true")
        rows = self.page.value("[...document.querySelectorAll('#batch-rows tr')].map(r => [...r.cells].map(c => c.textContent))")
        for row, test in zip(rows, self.batch()["tests"], strict=True):
            self.assertEqual(row[1:4], [self.step(test), test["record"], "void: paper torn, by " + test["voided"]["by"] if test["voided"] else "counts"])
        self.picture("batch")
        self.end()

        other = self.begin(**{"name": "liner 43", "grade": "", "pull_speeds": "12 in/min", "replicates": "2", "slides": "1",
                              "delta_mu.lowest": "0.03", "delta_mu.highest": "0.07", "mu_k.highest": "0.2"})
        self.assertEqual(other["plan"]["limits"], {"delta_mu": {"lowest": 0.03, "highest": 0.07}, "mu_k": {"lowest": None, "highest": 0.2}})
        others = [self.measure(), self.measure()]
        # The scene has S - K 0.05 and K 0.3.
        self.page.until("document.querySelectorAll('#tests tbody td.outside').length === 2")
        outside = self.page.value("[...document.querySelectorAll('#tests tbody td.outside')].map(c => [c.cellIndex, c.textContent])")
        self.assertEqual([(column, " ✗" in text) for column, text in outside], 2 * [(OF_BATCH + 4, True)])
        limits = self.page.value("[...document.querySelectorAll('#tests thead tr')].map(r => [...r.cells].map(c => c.textContent)).find(r => r[0].startsWith('limits'))")
        self.assertEqual(limits[OF_BATCH + 2:OF_BATCH + 5], ["0.0300 … 0.0700 ✓ kept", "", "≤ 0.2000 ✗ missed"])
        self.end()
        self.assertEqual(self.batch(), None)
        self.report(batch["id"], counted, records[1])
        self.compare(batch["id"], counted, other["id"], others)
        self.assertEqual(self.page.complaints(), [])

    def end(self):
        self.enter("#batch-end")
        self.enter("#end-sure")
        self.page.until("!document.getElementById('end-dialog').open && document.getElementById('batch-end').hidden")

    def report(self, batch, counted, voided):
        self.enter("#batches-open")
        self.page.until("document.querySelectorAll('#batches-rows tr').length === 2")
        rows = self.page.value("[...document.querySelectorAll('#batches-rows tr')].map(r => [...r.cells].slice(2, 7).map(c => c.textContent))")
        self.assertEqual([row[:2] + row[3:] for row in rows], [["liner 43", "–", "2", "0"], ["liner 42", "kraft", "4", "1"]])
        self.assertEqual(rows[1][2], batch)
        button = "#batches-rows tr:nth-child(2) button"
        shown = self.shown(f"{button}:nth-of-type(1)")
        quantities = shown.value("stickslip.data.quantities")
        own = shown.value("[...document.querySelectorAll('#tests-0 tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual([pathlib.Path(row[1]).name for row in own], [record.name for record in counted])
        # S - K first, then what it is made of.
        leading = ["delta_mu", "mu_s", "mu_k"]
        for k, quantity in enumerate(sorted(quantities, key=lambda q: leading.index(q["name"]) if q["name"] in leading else len(leading))):
            self.assertEqual([row[4 + k] for row in own], [self.with_errors(record, quantity["name"], quantity["decimals"]) for record in counted],
                             quantity["name"])
        self.assertIn("paper torn", shown.value("document.body.textContent"))
        # It has no origin, and so nothing of the daemon's page.
        self.assertEqual(shown.value("self.origin"), "null")
        self.close(shown)
        self.assertIn("</html>", self.saved(lambda: self.enter(f"{button}:nth-of-type(2)"), f"{batch}-report.html"))
        table = list(csv.DictReader(io.StringIO(self.saved(lambda: self.enter(f"{button}:nth-of-type(3)"), f"{batch}-report.csv"))))
        self.assertEqual([row["voided"] for row in table], 4 * [""] + ["paper torn"])
        numpy.testing.assert_array_equal([float(row["mu_k"]) for row in table[:4]], self.results(counted, "mu_k"))
        told = json.loads(self.saved(lambda: self.enter(f"{button}:nth-of-type(4)"), f"{batch}-report.json"))
        self.assertEqual([pathlib.Path(test["file"]).name for test in told["voided"]], [voided.name])
        self.assertEqual([group["quantities"]["mu_k"]["count"] for group in told["groups"]], [2, 2])

    def decimals(self, shown):
        """As many as the uncertainty leaves; at least one, as the coefficients here are known to a tenth."""
        decimals = len(shown.partition(".")[2])
        self.assertGreaterEqual(decimals, 1, shown)
        return decimals

    def compare(self, a, of_a, b, of_b):
        self.enter("#compare-show")
        self.page.until("document.getElementById('batches-message').textContent.startsWith('choose two batches')")
        self.enter(f"#batches-rows [name=a][value='{a}']", " ")
        self.enter(f"#batches-rows [name=b][value='{b}']", " ")
        self.picture("batches")
        shown = self.shown("#compare-show")
        self.assertEqual(shown.value("document.getElementById('title').textContent"), f"liner 42 ({a}) against liner 43 ({b})")
        self.assertEqual(shown.value("document.getElementById('comparison-0').textContent"), "no test of B at this speed")
        fast = [record for record in of_a if self.facts(record)[2] == 0.00508]
        quantities = shown.value("stickslip.data.quantities")
        rows = shown.value("[...document.querySelectorAll('#comparison-1 tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual(rows[0][0], "S−K by cycle")
        for row, quantity in zip(rows[1:], quantities, strict=True):
            difference = self.results(fast, quantity["name"]).mean() - self.results(of_b, quantity["name"]).mean()
            # As many digits as its uncertainty leaves.
            self.assertAlmostEqual(float(row[1]), difference, delta=0.5001 * 10.0 ** -self.decimals(row[1]), msg=quantity["name"])
        # Fig. 1: coefficient against speed, with a picture and its numbers.
        self.assertGreater(shown.value("document.querySelector('#figure canvas').width"), 300)
        means = shown.value("[...document.querySelectorAll('#speeds tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        # The speed as it was planned, and the group's grade and regime.
        self.assertEqual([(re.search(r"[\d.]+ in/min", row[0])[0], row[2]) for row in means], [("6 in/min", "2"), ("12 in/min", "2"), ("12 in/min", "2")])
        mean = means[2][4].split(" ± ")[0]
        self.assertAlmostEqual(float(mean), self.results(of_b, quantities[0]["name"]).mean(), delta=0.5001 * 10.0 ** -self.decimals(mean))
        if folder := os.environ.get("STICKSLIP_SCREENSHOTS"):
            shown.resize(1280, 720)
            shown.settle()
            shown.screenshot(pathlib.Path(folder) / "comparison.png", height=1400)
        self.close(shown)
        told = json.loads(self.saved(lambda: self.enter("#compare-json"), f"{a}-{b}-comparison.json"))
        self.assertEqual([len(told[side]["tests"]) for side in "ab"], [4, 2])

    def test_a_daemon_that_comes_back_goes_on_with_the_batch(self):
        self.open()
        batch = self.begin(name="liner 44", grade="kraft", pull_speeds="12 in/min", replicates="3")
        records = [self.measure(), self.measure()]
        self.enter("#void-2")
        self.page.type("sled askew")
        self.page.press("Enter")
        self.page.until("document.querySelector('#tests tr.void #void-2') && document.querySelector('#batch-rows tr.void')")
        self.assertEqual(self.text("verdict").strip(), "void: sled askew")
        shown = """({name: document.getElementById('batch-name').textContent, answer: document.getElementById('answer').textContent,
          rows: [...document.querySelectorAll('#batch-rows tr')].map(r => [...r.cells].map(c => c.textContent)),
          tests: [...document.querySelectorAll('#tests tbody tr')].map(r => [...r.cells].map(c => c.textContent))})"""
        before = self.page.value(shown)
        self.assertEqual(len(before["rows"]), 2)
        config = self.daemon.folder / "d.toml"
        port = self.page.value("location.port")
        config.write_text(config.read_text(encoding="utf-8").replace("127.0.0.1:0", f"127.0.0.1:{port}"), encoding="utf-8")
        self.daemon.end()
        self.page.until("document.getElementById('trouble').textContent.startsWith('the daemon does not answer')")
        # What is shown is the past, and stays.
        self.assertEqual(self.page.value(shown), before)
        self.daemon.start()
        # The scope begins anew when all else has been asked for.
        self.page.until("document.getElementById('trouble').hidden && document.getElementById('bench-word').textContent === 'idle' && Scope.slips.length === 0 && Scope.data.scan.length > 0")
        after = self.page.value(shown)
        for name in ("name", "rows"):
            self.assertEqual(after[name], before[name], name)
        # The tests of before are read from their records; mean and limits are of all of them again.
        self.page.until("document.querySelectorAll('#tests tbody tr').length >= 2 && !Tables.lacks()")
        after = self.page.value(shown)
        own = [row for row in after["tests"] if int(row[0]) > 2]
        self.assertEqual(after["tests"][len(own):], before["tests"])
        self.assertEqual(self.text("counted"), f"● mean and limits of batch {batch['id']}")
        # It goes on where it was, and ends with the sheets that were planned.
        records += [self.measure(), self.measure()]
        self.assertEqual([self.facts(record)[0] for record in records], 4 * [batch["id"]])
        self.assertEqual([self.facts(record)[3] for record in records], [1, 2, 2, 3])
        self.page.until("document.getElementById('now').textContent.startsWith('Now: the batch is finished')")
        self.assertEqual(self.text("batch-name"), "liner 44, kraft: 3 of 3 tests made")
        after = self.page.value(shown)
        self.assertEqual(after["rows"][:2], before["rows"])
        self.assertEqual([row[2] for row in after["rows"]], [record.name for record in records])
        for row, record in zip(after["tests"], reversed(records), strict=False):
            self.assertEqual(row[-1], record.name)
            for cell, name in zip(row[OF_BATCH + 2:OF_BATCH + 5], ("delta_mu", "mu_s", "mu_k"), strict=True):
                # Of three tests one may stand out.
                self.assertEqual(cell.replace(" !", ""), self.with_errors(record, name), name)
        self.end()

    # Each text of the band, whenever one changes, beside the state of the bench.
    BAND = """(() => { window.band = []; const texts = () => ['bench-word', 'now', 'next', 'answer-test', 'regime-word', 'verdict', 'answer-value', 'answer-errors', 'answer-more'].map(id => document.getElementById(id).checkVisibility() ? document.getElementById(id).textContent : '');
      new MutationObserver(() => window.band.push(texts())).observe(document.getElementById('band'), {childList: true, characterData: true, subtree: true, attributes: true}); })()"""

    def test_now_and_next_are_right_at_every_moment_of_a_batch(self):
        times = {"idle": "6 s", "pull": "5 s", "rest": "1 s"}  # The verdict comes up to a second after a test.
        self.open(config="", speed=3, times=times)
        self.page.value(self.BAND)
        self.begin(name="liner", replicates="3", slides="1", **{"delta_mu.lowest": "0.03", "mu_k.highest": "0.2"})
        self.page.until("document.getElementById('now').textContent === 'Now: the batch is finished, all 3 tests are made'")
        tests = [test["record"] for test in self.batch()["tests"]]
        sheet = {int(record.split("-")[-1].removesuffix(".h5")): at + 1 for at, record in enumerate(tests)}
        title = f"Test {max(sheet)}:"
        self.page.until(f"window.band.some(texts => texts[3] === '{title}' && texts[5] !== '' && texts[5].trim() !== 'limits not judged yet')")
        log = self.page.value("window.band")
        seen = {(bench, now, following) for bench, now, following, *_ in log}
        measuring = sorted((test, sheet[test]) for test in sheet)
        for test, own in measuring:
            now = f"Now: test {test}, sheet {own}, slide 1: measuring"
            following = {after for _, said, after in seen if said == now}
            # Before the daemon has told what comes after this test, nothing is said of it.
            wanted = f"Next: let it pull to its end, then sheet {own + 1}, slide 1" if own < 3 else "Next: let it pull to its end; it is the last of the batch"
            self.assertIn(wanted, following, seen)
            self.assertLessEqual(following, {wanted, "Next: let it pull to its end"}, now)
            if own > 1:
                self.assertIn(("armed", "Now: waiting for a pull", f"Next: sheet {own}, slide 1: lay on the sheet and pull"), seen)
        self.assertIn("Next: show the report, or end the batch", {after for _, said, after in seen if said.startswith("Now: the batch is finished")})
        # The answer of the last test, in text that can be read from afar, with the daemon's verdict; K is above its limit.
        record = self.records / tests[-1]
        told = [texts[5:] for texts in log if texts[0] != "running" and texts[3] == title][-1]
        self.assertEqual(told[0].strip(), "outside limits: K")
        self.assertEqual(f"{told[1]} {told[2]}".strip(), self.with_errors(record, "delta_mu"))
        self.assertEqual(told[3], " · ".join(f"{label} {self.with_errors(record, name)}" for name, label in (
            ("mu_s", "S"), ("mu_k", "K"), ("static_coefficient", "static"), ("kinetic_coefficient", "kinetic"))))
        self.assertGreaterEqual(float(self.page.value("getComputedStyle(document.getElementById('answer-value')).fontSize").removesuffix("px")), 48)

    def test_the_batch_is_summed_up_above_its_rows_which_are_marked_and_the_first_is_above_the_fold(self):
        self.open(config="", speed=10)
        self.page.until("document.querySelectorAll('#tests tbody tr').length >= 1")
        self.assertEqual(self.daemon.ask("POST", "/v1/batch", {"name": "liner 42", "grade": "kraft", "pull_speeds": ["12 in/min"], "replicates": 1000,
                                                               "limits": {"delta_mu": {"lowest": 0.03, "highest": 0.07}}})[0], 200)
        self.page.until("document.querySelectorAll('#tests tbody tr.own').length >= 3 && document.querySelectorAll('#tests thead tr').length === 3")
        head, top = self.page.value("[document.getElementById('tests').tHead.getBoundingClientRect(), document.querySelector('#tests tbody tr').getBoundingClientRect()].map(r => [r.top, r.bottom])")
        self.assertLessEqual(head[1], top[0] + 1)
        self.assertLessEqual(top[1], 720)
        shown = self.page.value("[...document.querySelectorAll('#tests tr')].map(r => [r.className, ...[...r.cells].slice(0, 5).map(c => c.textContent)])")
        self.assertEqual(shown[0][1:], ["test", "sample", "grade", "speed", "replicate"])
        self.assertRegex(shown[1][1], r"^mean, n = \d+$")
        self.assertEqual(shown[2][1], "limits")
        steps = {int(test["record"].split("-")[-1].removesuffix(".h5")): test for test in self.batch()["tests"]}
        for kind, number, *place in [row for row in shown[3:] if row[1].isdigit() and int(row[1]) in steps]:
            self.assertEqual((kind, place), ("own", ["liner 42", "kraft", "5.08 mm/s", str(steps[int(number)]["replicate"])]))
        self.assertEqual([row for row in shown if row[1] == "1"], [["", "1", "–", "–", "–", "–"]])
        # The summary stays where the rows are scrolled below it.
        self.page.until("document.querySelectorAll('#tests tbody tr').length > 8")
        above = self.page.value("(box => { box.scrollTop = 200; const head = document.getElementById('tests').tHead.getBoundingClientRect(); return [box.scrollTop, head.top - box.getBoundingClientRect().top]; })(document.getElementById('tests').parentElement)")
        self.assertGreater(above[0], 100)
        self.assertLess(abs(above[1]), 2)
        self.enter("#only", " ")
        self.page.until("[...document.querySelectorAll('#tests tbody tr')].every(r => r.classList.contains('own'))")
        self.enter("#only", " ")
        self.page.until("[...document.querySelectorAll('#tests tbody tr')].some(r => !r.classList.contains('own'))")

    def test_the_regime_of_a_running_test_is_preliminary_and_never_contradicts_the_final_one(self):
        scenes = json.dumps([str(SCENES / "ring-down-at-12-in-per-min.toml")])
        self.open(config="", board=f'[board]\ndriver = "simulated"\nclock_speed = 5\n[board.simulated]\nscenes = {scenes}\nrepeats = 0\n')
        self.page.value(self.BAND)
        # Two tests that the band has seen from their beginning; on a busy machine the page opens after some.
        before = self.page.value("document.querySelectorAll('#tests tbody tr').length")
        self.page.until(f"document.querySelectorAll('#tests tbody tr').length >= {before + 3}")
        regimes = dict(self.page.value("[...document.querySelectorAll('#tests tbody tr')].map(r => [r.cells[0].textContent, r.cells[1].textContent.split(' · ')[0]])"))
        told = {(title, regime) for _, _, _, title, regime, *_ in self.page.value("window.band")}
        self.assertEqual(set(regimes.values()), {"ring-down"})
        self.assertTrue(any("preliminary" in title and regime == "ring-down" for title, regime in told), told)
        self.assertEqual([one for one in told if one[1] == "steady-sliding"], [])
        self.assertTrue(any(title.removeprefix("Test ").removesuffix(":") in regimes for title, _ in told))
        for title, regime in told:
            if (number := title.removeprefix("Test ").removesuffix(":")) in regimes:
                self.assertEqual(regime, regimes[number], title)

    def test_what_is_refused_is_told_where_it_was_asked(self):
        self.open()
        offered = self.page.value("[...document.querySelectorAll('#batch-methods option')].map(o => o.value)")
        self.assertEqual(sorted(offered), sorted(method.stem for method in (SOURCE / "config" / "methods").glob("*.toml")))
        self.enter("#batch-open")
        self.page.press("Enter")
        self.assertTrue(self.page.value("document.getElementById('batch-dialog').open && document.querySelector('#batch-begin :invalid').name === 'name'"))
        self.type("#batch-begin [name=name]", "liner")
        self.type("#batch-begin [name=pull_speeds]", "12")
        self.page.press("Enter")
        self.page.until("document.getElementById('batch-message').textContent !== ''")
        self.assertIn("pull_speeds", self.text("batch-message"))
        self.type("#batch-begin [name=pull_speeds]", "12 in/min")
        self.type("#batch-begin [name=method]", "iso")
        self.page.press("Enter")
        self.page.until("document.getElementById('batch-message').textContent.startsWith('method: ')")
        self.type("#batch-begin [name=method]", "iso-8295")
        self.page.press("Enter")
        self.page.until("!document.getElementById('batch-dialog').open")
        # There is nothing to report yet: said in the dialog.
        self.enter("#batches-open")
        self.page.until("document.querySelectorAll('#batches-rows tr').length === 1")
        self.enter("#batches-rows button", settle=False)
        while "has no test yet" not in self.text("batches-message"):
            pass
        self.page.bring_to_front()
        self.assertEqual(self.page.complaints(), [f for f in self.page.complaints() if "409" in f or "400" in f])  # The browser's own words for a refusal.

    def test_what_stands_out_is_marked_and_counts(self):
        # One alone: a second that is as far off would hide the first. The last is still being pulled when all is looked at.
        usual, other = (SCENES / f"{name}-at-12-in-per-min.toml" for name in ("stick-slip", "ring-down"))
        endless = usual.read_text(encoding="utf-8").replace('pull = "5 s"', 'pull = "20000 s"')
        scenes = json.dumps([*map(str, 8 * [usual] + [other] + 3 * [usual]), "endless.toml"])
        board = f'[board]\ndriver = "simulated"\nclock_speed = 40\n[board.simulated]\nscenes = {scenes}\n'
        self.open(config="", board=board, prepare=lambda folder: (folder / "endless.toml").write_text(endless, encoding="utf-8"))
        self.page.until("document.getElementById('record-12')")
        told = self.daemon.ask("GET", "/v1/tests")[1]
        names = ["delta_mu", "mu_s", "mu_k", "static_coefficient", "kinetic_coefficient", "amplitude", "oscillation_frequency"]
        far = {(quantity["name"], quantity["outlier_test"]) for quantity in told["summary"]["quantities"] if quantity["outlier_test"] and quantity["name"] in names}
        marked = self.page.value("[...document.querySelectorAll('#tests td.far, #tests td.outside')].filter(c => c.textContent.includes(' !')).map(c => [c.cellIndex, Number(c.parentNode.cells[0].textContent)])")
        self.assertEqual({(names[column - 2], number) for column, number in marked}, far)
        self.assertGreater(len(far), 0)
        self.assertIn("counts all the same", self.text("counted"))
        self.assertEqual(len(told["summary"]["tests"]), len(told["tests"]))

    def test_it_can_be_read_and_reached_in_both_colours(self):
        for dark in (False, True):
            self.open(dark=dark)
            self.begin(name="liner", replicates="2")
            self.measure()
            self.page.value("document.getElementById('batch-tests').open = true")
            self.legible("#batch", dark)
            for opener, dialog, shut in (("#void-1", "void-dialog", "void-close"), ("#batch-end", "end-dialog", "end-leave"), ("#batches-open", "batches-dialog", "batches-close")):
                self.enter(opener)
                self.page.until(f"document.getElementById('{dialog}').matches(':modal')")
                if dialog == "batches-dialog":
                    self.page.until("document.querySelectorAll('#batches-rows tr').length === 1")
                self.legible(f"#{dialog}", dark)
                self.enter(f"#{shut}")
                self.page.until(f"!document.getElementById('{dialog}').open")
            self.end()
            self.enter("#batch-open")
            self.legible("#batch-dialog", dark)

    def legible(self, within, dark):
        """Each text in it on its ground, each control by keyboard and with a label, at the bench's screen and a tablet's."""
        self.assertEqual(self.page.value(f"[...document.querySelectorAll('{within} button, {within} input')].filter(e => e.tabIndex < 0).length"), 0)
        self.assertEqual(self.page.value(f"[...document.querySelectorAll('{within} input')].filter(e => !e.labels.length).length"), 0)
        for width, height in ((820, 1180), (1280, 720)):
            self.page.resize(width, height)
            self.page.settle()
            box = self.page.value(f"(r => [r.left, r.top, r.right, r.bottom])(document.querySelector('{within}').getBoundingClientRect())")
            self.assertTrue(0 <= box[0] and box[2] <= width, (within, box, width))
            self.assertTrue(within == "#batch" or (0 <= box[1] and box[3] <= height), (within, box, height))
        pairs = self.page.value(f"""[...document.querySelectorAll('{within} *')].filter(e => e.offsetParent && e.textContent.trim() + (e.value ?? '')).map(e => {{
          let back = e;
          while (getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
          return [e.tagName + '.' + e.className, getComputedStyle(e).color, getComputedStyle(back).backgroundColor];
        }})""")
        self.assertGreater(len(pairs), 3)
        for name, front, back in pairs:
            self.assertGreaterEqual(contrast(rgb(front), rgb(back)), 4.5, f"{within} {name} {front} on {back}, dark {dark}")


if __name__ == "__main__":
    if CHROMIUM is None:
        sys.exit(f"{sys.argv[2]} is not installed; ./dev deps test installs it")
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

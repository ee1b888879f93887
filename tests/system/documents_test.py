#!/usr/bin/env python3
"""What the documents tell people to type works: every line of a ```sh block that begins with stickslip or
stickslipd is run and must end with 0. The lines of one document run in order in one folder, which holds what
a clone holds (config/) and a measured trace.

A block that needs more has a line above it:

  <!-- with a daemon -->                its lines, those of curl too, run beside a daemon that plays tests, in its folder; all such blocks of
                                        a document beside the same one
  <!-- with a daemon and a broker -->   the same; the daemon tells a broker its results, and mosquitto_sub is run too
  <!-- not run: needs a board -->       it cannot be run here; the reason is said

A ```toml block is a configuration that is good, once it has a board where it names none. The table of requests in
docs/control.md says what openapi.json says, that of events in docs/reliability.md what the daemon logs. Links lead somewhere, docs/README.md
lists each page, and README's figures stand in the pages that it names for them.

documents_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy
import scipy.io

from broker import MOSQUITTO, Broker
from running_daemon import RunningDaemon

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 600

BLOCK = re.compile(r"(?:<!-- (?P<remark>[^>]*?) -->\n+)?```(?P<language>sh|toml)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
NOT_RUN = re.compile(r"not run: \S")
ALONE, DAEMON, BROKER = "", "with a daemon", "with a daemon and a broker"
#: Programs whose lines are run.
RUN = {ALONE: "stickslipd?", DAEMON: "stickslipd?|curl", BROKER: "stickslipd?|curl|mosquitto_sub"}
#: What a configuration in a document may leave to the reader.
LEAST_CONFIGURATION = '[board]\ndriver = "simulated"\n[board.simulated]\nscenes = ["config/scenes/ring-down-at-12-in-per-min.toml"]\n'
USUAL_SOCKET = "/run/stickslip/control.sock"
USUAL_FOLDER = "/var/lib/stickslip/"
#: Words that whoever comes first has patience for.
SHORT_PAGE_WORDS = 600

LINK = re.compile(r"\]\(([^()\s]+)\)")
NUMBER = re.compile(r"\d+(?:\.\d+)?")


def blocks(document, language):
    """(remark above it, text) of each block."""
    for block in BLOCK.finditer(document.read_text(encoding="utf-8")):
        if block["language"] == language:
            yield (block["remark"] or "").strip(), block["text"]


def commands(text, programs):
    return [line for line in text.replace("\\\n", " ").splitlines() if re.match(rf"(?:{programs})\s", line)]


def without_code(text):
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE))


def anchors(text):
    """Of each heading, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def section(text, heading):
    return re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", text, re.DOTALL | re.MULTILINE)[1]


def documents():
    return [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


def write_trace(file, rate_hz=2000, duration_s=2):
    """A sawtooth like that of sticking paper, for the lines about measured traces."""
    with file.open("w", encoding="ascii") as out:
        out.write("t_s,mu\n")
        for scan in range(rate_hz * duration_s):
            phase = scan * 20 / rate_hz
            out.write(f"{scan / rate_hz:.4f},{0.25 + 0.1 * (phase - math.floor(phase)):.5f}\n")


def write_foreign_traces(folder, rate_hz=350, duration_s=4):
    """A pull of a sled of 2331 g as other programs export it, for docs/importing.md: rest, loading, sawtooth, rest."""
    def force(scan):
        time_s = scan / rate_hz
        if not 0.5 <= time_s < duration_s - 0.5:
            return 0.002 * math.sin(scan)
        phase = (time_s - 0.5) * 10
        return min(phase * 4, 6.9 + 1.1 * (phase - math.floor(phase))) + 0.01 * math.sin(7 * scan)

    scans = [(scan / rate_hz, force(scan)) for scan in range(rate_hz * duration_s)]
    comma = lambda text: text.replace(".", ",")  # noqa: E731
    files = {
        "bluehill.csv": ("utf-8", '"Specimen","1"\n"Time","Load"\n"(s)","(N)"\n' + "".join(f'"{t:.5f}","{f:.4f}"\n' for t, f in scans)),
        "testxpert.txt": ("utf-16", '"Prüfzeit"\t"Standardkraft"\n"s"\t"N"\n' + "".join(comma(f"{t:.5f}\t{f:.4f}\n") for t, f in scans)),
        "labview.lvm": ("utf-8", "LabVIEW Measurement\nSeparator\tTab\n***End_of_Header***\n\nX_Value\tForce\tComment\n"
                        + "".join(f"{t:.6f}\t{f:.6f}\t\n" for t, f in scans)),
        "pasco.csv": ("utf-8", "Time (s) Run #1,Force (N) Run #1,Time (s) Run #2,Force (N) Run #2\n"
                      + "".join(f"{t:.4f},{f:.3f},{t:.4f},{f:.3f}\n" for t, f in scans)),
        "tribometer.txt": ("latin-1", "Time [s]\tDistance [m]\tµ []\r\n" + "".join(f"{t:.4f}\t{t * 0.005:.6f}\t{f / 22.86:.5f}\r\n" for t, f in scans)),
        "labjack.dat": ("utf-8", "Time\tv0\ty0\n" + "".join(f"{t:.6f}\t{f / 2:.6f}\t0\n" for t, f in scans)),
        "codes.csv": ("utf-8", "Time (s),Code\n" + "".join(f"{t:.6f},{f / 2 / 0.5e-3:.0f}\n" for t, f in scans)),
        "hx711.log": ("utf-8", "HX711 tare done\nReady\n" + "".join(f"{t * 1e6:.0f},{f / 0.00980665:.2f}\n" for t, f in scans)),
    }
    for name, (encoding, text) in files.items():
        (folder / name).write_bytes(text.encode(encoding))
    table = numpy.array(scans)
    scipy.io.savemat(folder / "run.mat", {"run": {"Time": table[:, 0], "Data": table[:, 1]}, "unit": "N"})
    with h5py.File(folder / "daq.h5", "w") as daq:
        daq["run1/force"] = table[:, 1]
        daq["run1/force"].attrs["units"] = "N"
        daq["run1/time"] = table[:, 0]
        daq["scan"] = table


def run(command, folder, path):
    environment = dict(os.environ, PATH=f"{path}:{os.environ['PATH']}")
    return subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment,
                          capture_output=True, text=True, timeout=TIMEOUT_S, check=False)


def requests_of_table(text):
    """(method, path) of each row's first cell: `GET`, `PUT /v1/plan`; `POST /v1/arm`, `stop`."""
    found = set()
    for cell in re.findall(r"^\| (`(?:GET|PUT|POST|DELETE)\b[^|]*?) \|", text, re.MULTILINE):
        for part in cell.split(";"):
            methods, path = [], None
            for token in re.findall(r"`([^`]*)`", part):
                method, _, rest = token.rpartition(" ")
                if token.isupper():
                    methods.append(token)
                    continue
                if method:
                    methods.append(method)
                # A word alone is a sibling of the path before it.
                path = rest if rest.startswith("/") else f"{path.rpartition('/')[0]}/{rest}"
                found |= {(one, path.partition("?")[0]) for one in methods}
    return found


class Documents(unittest.TestCase):
    def with_broker(self, document):
        """Settings of a daemon for a broker that runs; None where there is none."""
        if MOSQUITTO is None:
            self.assertNotEqual(os.environ.get("CI"), "true", f"{document.name} needs mosquitto")
            return None
        broker = Broker(self, self.enterContext(tempfile.TemporaryDirectory(prefix="stickslip-")))
        return broker.port

    def daemon_for(self, document, remark):
        """The daemon, its tools and the port of its broker; None where a broker is needed and there is none."""
        port = self.with_broker(document) if remark == BROKER else None
        if remark == BROKER and port is None:
            return None
        fleet = f'[fleet]\nbroker = "mqtt://127.0.0.1:{port}"\ntester = "bench-7"\n' if port else ""
        # A test a second: a busy machine makes their records as they come.
        daemon = RunningDaemon(self, BUILD, SOURCE, config=fleet, speed=8)
        # The documents speak of an installed daemon, at the usual place.
        tools = daemon.folder / "tools"
        tools.mkdir()
        cli = BUILD / "bin" / "stickslip"
        # A simulated tester has no calibration: a warning of the doctor, status 3.
        (tools / "stickslip").write_text(f'#!/bin/sh\nif [ "$*" = doctor ]; then {cli} doctor --config {daemon.folder}/d.toml || [ $? -eq 3 ]; exit; fi\n'
                                         f'if {cli} "$1" --help | grep -q -e "--socket"; then set -- "$@" --socket {daemon.socket}; fi\n'
                                         f'exec {cli} "$@"\n', encoding="utf-8")
        (tools / "stickslip").chmod(0o700)
        (tools / "stickslipd").symlink_to(BUILD / "bin" / "stickslipd")
        return daemon, tools, port

    def run_beside_a_daemon(self, document, running, lines):
        daemon, tools, port = running
        for line in lines:
            command = line.replace(USUAL_SOCKET, str(daemon.socket)).replace(USUAL_FOLDER, f"{daemon.folder}/").replace("-h broker.plant", f"-h 127.0.0.1 -p {port} -C 1")
            if re.search(r"\d{8}T\d{6}Z-\d{4}\.h5", command):
                command = re.sub(r"\S*\d{8}T\d{6}Z-\d{4}\.h5", str(daemon.record(1)), command)
            with self.subTest(document=document.name, command=line):
                # A bench refuses what does not suit the moment: a tare in a pull, a test that has not been made yet. Asked until it does.
                until = time.monotonic() + TIMEOUT_S / 10
                while (done := run(command, daemon.folder, tools)).returncode != 0 and time.monotonic() < until:
                    pass
                self.assertEqual(done.returncode, 0, done.stderr)

    def run_document(self, document):
        ran, running = 0, {}
        with tempfile.TemporaryDirectory(prefix="stickslip-") as name:
            folder = pathlib.Path(name)
            shutil.copytree(SOURCE / "config", folder / "config")
            write_trace(folder / "trace.csv")
            write_foreign_traces(folder)
            for remark, text in blocks(document, "sh"):
                if NOT_RUN.match(remark):
                    continue
                self.assertIn(remark, RUN, f"{document.name}: a remark that means nothing here")
                lines = commands(text, RUN[remark])
                ran += len(lines)
                if remark != ALONE:
                    if remark not in running:
                        running[remark] = self.daemon_for(document, remark)
                    if running[remark]:
                        self.run_beside_a_daemon(document, running[remark], lines)
                    continue
                for line in lines:
                    with self.subTest(document=document.name, command=line):
                        done = run(line, folder, BUILD / "bin")
                        self.assertEqual(done.returncode, 0, done.stderr)
        for daemon, *_ in filter(None, running.values()):
            daemon.end()
        return ran

    def test_every_command_in_the_documents_works(self):
        ran = {str(document.relative_to(SOURCE)): self.run_document(document) for document in documents()}
        print(f"{sum(ran.values())} commands:", ", ".join(f"{name} {count}" for name, count in ran.items() if count))
        # So that a change of the style of blocks does not make the test empty.
        for name in ("README.md", "docs/first-day.md", "docs/simulate.md", "docs/control.md", "docs/batches.md"):
            self.assertGreater(ran[name], 4, name)

    def test_every_configuration_in_the_documents_is_good(self):
        checked = 0
        for document in documents():
            for _, text in blocks(document, "toml"):
                with self.subTest(document=document.name, configuration=text), tempfile.TemporaryDirectory(prefix="stickslip-") as name:
                    folder = pathlib.Path(name)
                    shutil.copytree(SOURCE / "config", folder / "config")
                    (folder / "d.toml").write_text(text if "[board]" in text else LEAST_CONFIGURATION + text, encoding="utf-8")
                    done = run("stickslipd --check-config d.toml", folder, BUILD / "bin")
                    self.assertEqual(done.returncode, 0, done.stderr)
                checked += 1
        self.assertGreater(checked, 1)

    def test_every_link_leads_somewhere(self):
        for document in [*documents(), SOURCE / "CONTRIBUTING.md", SOURCE / "CHANGELOG.md", SOURCE / "examples" / "README.md"]:
            text = document.read_text(encoding="utf-8")
            for link in LINK.findall(without_code(text)):
                if re.match(r"https?:", link):
                    continue
                with self.subTest(document=document.name, link=link):
                    path, _, anchor = link.partition("#")
                    target = document.parent / path if path else document
                    self.assertTrue(target.exists(), "no such file")
                    if anchor:
                        self.assertIn(anchor, anchors(target.read_text(encoding="utf-8")))

    def test_the_index_lists_each_page_once(self):
        docs = SOURCE / "docs"
        listed = re.findall(r"^- \[[^\]]+\]\(([^()\s]+)\): \S", (docs / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(sorted(listed), sorted(page.name for page in docs.glob("*.md") if page.name != "README.md"))

    def test_the_first_pages_are_short(self):
        for page in ("README.md", "docs/first-day.md"):
            self.assertLessEqual(len((SOURCE / page).read_text(encoding="utf-8").split()), SHORT_PAGE_WORDS, page)

    def test_the_figures_of_readme_stand_in_the_pages(self):
        figures = re.split(r"^- ", section((SOURCE / "README.md").read_text(encoding="utf-8"), "Figures"), flags=re.MULTILINE)[1:]
        self.assertGreaterEqual(len(figures), 3)
        for figure in figures:
            pages = "\n".join((SOURCE / link.partition("#")[0]).read_text(encoding="utf-8") for link in LINK.findall(figure))
            numbers = NUMBER.findall(LINK.sub("", figure))
            self.assertTrue(numbers, figure)
            for number in numbers:
                with self.subTest(figure=figure, number=number):
                    self.assertRegex(pages, rf"(?<![\d.]){re.escape(number)}(?!\.?\d)")

    def test_the_table_of_events_is_that_of_the_log(self):
        logged = set(re.findall(r'\.event = "([a-z-]+)"', (SOURCE / "daemon" / "app" / "log.cpp").read_text(encoding="utf-8")))
        [table] = re.findall(r"^\| `STICKSLIP_EVENT` \| priority .*\n\|---.*\n((?:\|.*\n)*)", (SOURCE / "docs" / "reliability.md").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual({name for row in table.splitlines() for name in re.findall("`([a-z-]+)`", row.split("|")[1])}, logged)

    def test_the_table_of_requests_is_that_of_the_description(self):
        described = set()
        parameters = {"{number}": "N", "{name}": "NAME", "{id}": "ID"}
        for path, methods in json.loads((SOURCE / "daemon" / "control" / "openapi.json").read_text(encoding="utf-8"))["paths"].items():
            for parameter, placeholder in parameters.items():
                path = path.replace(parameter, placeholder)
            described |= {(method.upper(), path) for method in methods}
        self.assertEqual(requests_of_table((SOURCE / "docs" / "control.md").read_text(encoding="utf-8")), described)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""Figures of many random tests: `./dev evidence [NAME...] [--seed N] [--tests N] [--write]`.

Runs the programs NAME of bench/ and tests/independent (all unless named; hours) and prints what they print, under program, commit, count and seed.
--write puts it into docs/evidence.md, in place of what stands there of the same program.
"""

import argparse
import pathlib
import re
import subprocess
import sys

# Tests of one row, unless told, as the documents quote them.
COUNTS = {"estimator": 4000, "escape": 10000, "regime": 10000, "promise": 1000, "scatter": 1000, "ramp": 400, "consistency": 100000, "trend": 4000,
          "instrument": 60, "rungs": 100}
ROOT = pathlib.Path(__file__).parents[1]
BUILD = ROOT / "build/bench"
# (what is built, what is run) where it is no program of bench/ that is called NAME_limits.
SCRIPTS = {name: ("stickslip", ["/usr/bin/python3", ROOT / f"tests/independent/{file}.py", BUILD]) for name, file in (("instrument", "instruments"), ("rungs", "rungs"))}


def program(name):
    return SCRIPTS.get(name, (f"{name}_limits", [BUILD / f"bench/{name}_limits"]))


def main():
    parser = argparse.ArgumentParser(prog="./dev evidence")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(COUNTS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tests", type=int, help="of one row")
    parser.add_argument("--write", action="store_true", help="into docs/evidence.md")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in COUNTS]:
        parser.error(f"no evidence is called {unknown[0]!r}; known: {', '.join(COUNTS)}")
    if asked.seed < 1 or (asked.tests is not None and asked.tests < 2):
        parser.error("--seed takes a number from 1, --tests one from 2")
    names = asked.names or list(COUNTS)
    targets = [program(name)[0] for name in names]
    subprocess.run(["cmake", "--build", BUILD, "--target", *targets], stdout=sys.stderr, check=True)
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True).stdout.strip() or "unknown"
    for name in names:
        count = asked.tests or COUNTS[name]
        done = subprocess.run([*program(name)[1], str(count), str(asked.seed)], stdout=subprocess.PIPE, text=True, check=True)
        # A program's own bars would make its lines a table of Markdown; a block of text stays as it is printed.
        section = f"## {name}\n\nCommit {commit}, {count} tests a row, seed {asked.seed}.\n\n```text\n{done.stdout.strip()}\n```\n"
        print(section, flush=True)
        if asked.write:
            write(name, section)


def write(name, section):
    document = ROOT / "docs/evidence.md"
    text = document.read_text(encoding="utf-8")
    old = re.compile(rf"^## {name}\n.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)
    if old.search(text):
        text = old.sub(lambda _: section + "\n", text)
    else:
        text = text.rstrip("\n") + "\n\n" + section
    document.write_text(text.rstrip("\n") + "\n", encoding="utf-8")


main()

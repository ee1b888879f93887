#!/usr/bin/env python3
"""Do the tests protect the rules? `./dev mutate [N] [--seed S] [--in FOLDER]... [--build FOLDER] [TEST...]`.

Draws N small changes (mutants) of the sources in core/, builds each by itself, and runs the tests of its folder, or the TESTs named,
until one fails [DeMillo, Lipton, Sayward, Computer 11(4):34-41, 1978]. A mutant that no test kills survives: its rule lacks a test,
or is none. "same program" means that the compiler makes the same bits of it, so that no test can see it. The source is restored
after each mutant and after Ctrl-C; a tree with uncommitted changes is refused.
"""

import argparse
import hashlib
import pathlib
import random
import re
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
# The tests of each folder, the fast ones first.
TESTS = {
    "signal": "unit_signal unit_falls unit_pipeline property_analysis numeric_analysis",
    "detect": "unit_falls unit_analysis unit_pipeline property_analysis property_pipeline numeric_estimate numeric_analysis",
    "estimate": "unit_falls numeric_estimate property_analysis numeric_analysis",
    "analysis": "unit_falls unit_analysis unit_pipeline property_analysis numeric_analysis",
    "pipeline": "unit_pipeline property_pipeline",
}
# Operators as clang-format writes them; each becomes one of the others.
OPERATORS = {"<": "<= >", "<=": "< >=", ">": ">= <", ">=": "> <=", "==": "!=", "!=": "==", "+": "-", "-": "+", "&&": "||", "||": "&&"}
OPERATOR = re.compile(r"(?<= )(<=|>=|==|!=|&&|\|\||<|>|\+|-)(?= )")
CONSTANT = re.compile(r"\bconstexpr [\w: ]+ k\w+ = ([^;{}\"]+);")
CONDITION = re.compile(r"^\s*return ([^;?]* (?:<|<=|>|>=|==|!=|&&|\|\|) [^;?]*|![^;?]*);$")
ASSIGNMENT = re.compile(r"^\s*[\w.\[\]>-]+ [-+*/|]?= [^;]+;$")


def code_of(text):
    """The text with comments and literals blanked, of the same length."""
    blank = lambda found: re.sub(r"[^\n]", " ", found[0])
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", blank, text, flags=re.DOTALL)


def mutants_of(path):
    """(path, offset, old, new) of every change that is known."""
    offset = 0
    for line in code_of(path.read_text(encoding="utf-8")).splitlines(keepends=True):
        code = line.rstrip()
        if not code.lstrip().startswith(("#", "template", "static_assert", "using")) and "operator" not in code:
            for found in OPERATOR.finditer(code):
                for new in OPERATORS[found[1]].split():
                    yield path, offset + found.start(1), found[1], new
            if found := CONSTANT.search(code):
                for by in (" / 2", " * 2"):
                    yield path, offset + found.start(1), found[1], f"({found[1]}){by}"
            if found := CONDITION.search(code):
                yield path, offset + found.start(1), found[1], f"!({found[1]})"
            if found := ASSIGNMENT.search(code):
                statement = found[0].strip()
                yield path, offset + code.index(statement), statement, ";"
        offset += len(line)


class Mutated:
    """The tree with one mutant in it. The restored source is newer than what was built of the mutant, so it is built again."""

    def __init__(self, mutant):
        self.path, self.offset, self.old, self.new = mutant

    def __enter__(self):
        self.text = self.path.read_text(encoding="utf-8")
        assert self.text[self.offset :].startswith(self.old)
        self.path.write_text(self.text[: self.offset] + self.new + self.text[self.offset + len(self.old) :], encoding="utf-8")

    def __exit__(self, *_):
        self.path.write_text(self.text, encoding="utf-8")

    def __str__(self):
        line = self.path.read_text(encoding="utf-8").count("\n", 0, self.offset) + 1
        return f"{self.path.relative_to(ROOT)}:{line}: {self.old} -> {self.new if self.new != ';' else 'nothing'}"


def built(build, tests):
    return subprocess.run(["cmake", "--build", build, "--target", *tests], cwd=ROOT, capture_output=True).returncode == 0


def bits_of(build, test):
    """A digest of the test's program."""
    for path in build.glob(f"tests/*/{test}"):
        return hashlib.sha256(path.read_bytes()).digest()
    sys.exit(f"mutate: {build} has no test {test}")


def passes(build, test):
    return not subprocess.run(["ctest", "--test-dir", build, "--no-tests=error", "-R", f"^{test}(_[0-9]+)?$"], capture_output=True).returncode


def verdict_on(build, tests, before):
    """Each test is built when its turn comes: most mutants do not live to see the last."""
    verdict = "same program"
    for test in tests:
        if not built(build, [test]):
            return "does not build"
        if bits_of(build, test) == before[test]:
            continue
        if not passes(build, test):
            return f"killed by {test}"
        verdict = "survived"
    return verdict


def main():
    parser = argparse.ArgumentParser(prog="./dev mutate")
    parser.add_argument("count", nargs="?", type=int, default=20, metavar="N", help="mutants, 20 unless said")
    parser.add_argument("--seed", type=int, default=None, help="drawn and printed unless given")
    parser.add_argument("--in", dest="folders", action="append", choices=TESTS, help="folder of core/; all unless said")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("tests", nargs="*", metavar="TEST", help="instead of the tests of the folder")
    asked = parser.parse_args()
    build = asked.build.resolve()
    if subprocess.run(["git", "diff", "--quiet", "HEAD"], cwd=ROOT).returncode:
        sys.exit("mutate: the tree has uncommitted changes; commit or stash them first")
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # As Ctrl-C: the source is restored.
    folders = asked.folders or list(TESTS)
    seed = asked.seed if asked.seed is not None else random.SystemRandom().randrange(1_000_000)
    sources = sorted(path for folder in folders for path in (ROOT / "core" / folder).glob("*.[ch]pp"))
    every = [mutant for path in sources for mutant in mutants_of(path)]
    drawn = random.Random(seed).sample(every, min(asked.count, len(every)))
    print(f"mutate: {len(drawn)} of {len(every)} mutants, seed {seed}", flush=True)
    tests = {folder: asked.tests or TESTS[folder].split() for folder in folders}
    wanted = sorted(set(sum(tests.values(), [])))
    if not built(build, wanted):
        sys.exit("mutate: the tree does not build as it is")
    before = {test: bits_of(build, test) for test in wanted}
    if failing := [test for test in wanted if not passes(build, test)]:
        sys.exit(f"mutate: {', '.join(failing)} fail as they are")
    verdicts = []
    try:
        for mutant in drawn:
            began = time.monotonic()
            label = str(Mutated(mutant))
            with Mutated(mutant):
                verdicts.append(verdict_on(build, tests[mutant[0].parent.name], before))
            print(f"{verdicts[-1]}: {label} ({time.monotonic() - began:.0f} s)", flush=True)
    except KeyboardInterrupt:
        print("mutate: ended early; the source is restored", file=sys.stderr)
    counts = [sum(verdict.startswith(kind) for verdict in verdicts) for kind in ("killed", "survived", "same", "does not")]
    print("mutate: {} killed, {} survived, {} the same program, {} do not build".format(*counts))


main()

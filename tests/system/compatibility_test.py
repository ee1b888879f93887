#!/usr/bin/env python3
"""What versions before could be given, asked and told, this one can: tests/golden/vMAJOR.MINOR holds what they read, wrote and
answered (tests/golden/freeze_version.py). A name of the command line or of the configuration that has changed is accepted
with a warning that names the new one.

compatibility_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import contextlib
import json
import math
import pathlib
import re
import shutil
import sys
import tempfile
import tomllib
import unittest

import interface
from described import worse

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
CLI, DAEMON = BUILD / "bin" / "stickslip", BUILD / "bin" / "stickslipd"
GOLDEN = SOURCE / "tests" / "golden"
sys.path.append(str(GOLDEN))

import list_record

VERSIONS = sorted(folder.name for folder in GOLDEN.glob("v*.*"))
NOBODY_KNOWS = "--nobody-knows-this"
# As above all numbers of results, whose last bits another processor's mathematics may change.
CLOSE = 1e-9
# A fit may stop elsewhere within its convergence: estimates agree within this part of their standard errors.
ESTIMATE = 0.01
ERRORS = ("standard_error", "systematic_uncertainty")
# Results that went from among the others into `diagnostics`: records of version 3, and all JSON. CSV has them no more.
DIAGNOSTICS = ("delta_mu_from_amplitude", "delta_mu_from_timing", "delta_mu_from_slip_speed", "delta_mu_combined", "mu_k_from_mean", "mu_s_from_amplitude")
A_DIAGNOSTIC = "|".join(DIAGNOSTICS)


def kept(version, name):
    return json.loads((GOLDEN / version / name).read_text(encoding="utf-8"))


def moved(place):
    """Where in a document stands now what stood at a place: tests[].details.mu_k_from_mean.unit → tests[].diagnostics.mu_k_from_mean.unit."""
    found = re.fullmatch(rf"(.*?)(details\.)?({A_DIAGNOSTIC})(\..*)?", place)
    if not found:
        return place
    before, detail, name, member = found.groups()
    return f"{before}diagnostics.{name}" + (member or "" if detail else ".value")


def config_keys(text):
    return set(re.findall(r"(?m)^(?:# )?([a-z_]+) = ", text))

def same(then, now):
    if isinstance(then, dict) and isinstance(now, dict):
        error = then.get("standard_error")
        if isinstance(error, float) and isinstance(then.get("value"), float):
            if not abs(then["value"] - now.get("value", math.nan)) <= ESTIMATE * error:
                return False
            return all(math.isclose(value, now.get(key, math.nan), rel_tol=ESTIMATE) if key in ERRORS else key == "value" or same(value, now.get(key))
                       for key, value in then.items())
        return all(key in now and same(value, now[key]) for key, value in then.items())
    if isinstance(then, list) and isinstance(now, list):
        return len(then) == len(now) and all(map(same, then, now))
    if isinstance(then, float) and isinstance(now, (int, float)):
        return math.isclose(then, now, rel_tol=CLOSE, abs_tol=1e-300)
    return then == now


class Compatibility(unittest.TestCase):
    @contextlib.contextmanager
    def copy(self, version):
        with self.subTest(version=version), tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            yield pathlib.Path(shutil.copytree(GOLDEN / version, pathlib.Path(folder) / version))

    def expect_warned(self, told, old, new):
        """A name that is gone has to be told, and one that is there now beside it."""
        warnings = [line for line in told.splitlines() if "warning: " in line and re.search(rf"(?<![\w-]){old}(?![\w-])", line)]
        self.assertTrue(any(re.search(rf"(?<![\w-]){name}(?![\w-])", line) for line in warnings for name in new),
                        f"{old} is gone, and no warning names what it is called now: {told}")

    def test_there_are_versions(self):
        self.assertIn("v0.1", VERSIONS)

    def test_each_key_of_a_configuration_is_taken(self):
        now = config_keys((SOURCE / "config" / "stickslipd.toml").read_text(encoding="utf-8"))
        for version in VERSIONS:
            with self.copy(version) as folder:
                (folder / "config" / "password").chmod(0o600)
                for file in (folder / "config").glob("*.toml"):
                    if file.stem == "tester":
                        continue
                    checked = interface.run(DAEMON, "--check-config", file)
                    self.assertEqual(checked.returncode, 0, checked.stderr)
                    for key in config_keys(file.read_text(encoding="utf-8")) - now:
                        self.expect_warned(checked.stdout + checked.stderr, key, now)

    def test_each_scene_and_method_is_read(self):
        for version in VERSIONS:
            with self.copy(version) as folder:
                for scene in (folder / "scenes").glob("*.toml"):
                    config = folder / "scene.toml"
                    config.write_text(f'[board]\ndriver = "simulated"\n[board.simulated]\nscenes = ["{scene}"]\n', encoding="utf-8")
                    checked = interface.run(DAEMON, "--check-config", config)
                    self.assertEqual(checked.returncode, 0, checked.stderr)
                methods = json.loads(interface.printed(CLI, "methods", "--folder", folder / "methods", "--json"))["methods"]
                self.assertEqual([method["name"] for method in methods], sorted(file.stem for file in (folder / "methods").glob("*.toml")))
                for method in methods:
                    with (folder / "methods" / f"{method['name']}.toml").open("rb") as file:
                        written = tomllib.load(file)
                    self.assertEqual(method["replicates"], written["test"]["replicates"])

    def test_each_command_and_option_is_taken(self):
        for version in VERSIONS:
            with self.copy(version):
                for program, commands in kept(version, "interface.json")["command_line"].items():
                    now = interface.command_line(BUILD / "bin" / program)
                    names_now = {command: {name for option in words["options"] for name in option[0]} for command, words in now.items()}
                    for command, words in commands.items():
                        self.expect_taken(program, command, words, names_now)

    def expect_taken(self, program, command, words, names_now):
        """Each option beside one that nobody knows: all that is not expected is told, and nothing is done."""
        needed = {option[0][-1]: [option[0][-1], interface.VALUES.get(option[1], "x")] for option in words["options"] if option[2]}
        given = [interface.VALUES.get(value, "x") for value, required in words["positionals"] if required]
        if program == "stickslipd":
            needed["--config"] = ["--config", "x"]
        # The command itself, and each option. Without a command the program does nothing.
        for names, value, _ in [*words["options"], *([[[""], None, False]] if command else [])]:
            for name in names:
                if name in ("-h", "--help", "--version"):
                    continue
                option = [name, *([interface.VALUES.get(value, "x")] if value else [])] if name else []
                others = [word for key, pair in needed.items() if key not in names for word in pair]
                # An option that may stand more than once takes what follows it: it comes last but for the unknown one.
                line = [*command.split(), *given, *others, *option, NOBODY_KNOWS]
                done = interface.run(BUILD / "bin" / program, *line)
                with self.subTest(line=" ".join([program, *line])):
                    unexpected = re.search(r"(?:not expected:|has no option) (.*?)(?:;|$)", done.stderr)
                    # Refused with another option or for its value: it is known.
                    known = unexpected is None and re.search(rf"{names[-1]}(?![\w-])", done.stderr) if name else False
                    self.assertTrue(known or unexpected and unexpected[1] == NOBODY_KNOWS, done.stderr)
                    self.assertNotIn("is required", done.stderr)
                    gone = command if command not in names_now else name if name and name not in names_now[command] else None
                    if gone:
                        self.expect_warned(done.stderr, gone, names_now.get(command, names_now))

    def test_what_is_printed_has_each_name(self):
        for version in VERSIONS:
            with self.copy(version) as folder:
                then = kept(version, "interface.json")
                [record] = (folder / "state" / "records").glob("*.h5")
                now = interface.outputs(BUILD, record)
                for what, names in then["names"].items():
                    self.assertLessEqual(set(names), set(now["names"][what]))
                for what, columns in then["columns"].items():
                    self.assertEqual([name for name in now["columns"][what] if name in columns], [name for name in columns if name not in DIAGNOSTICS], what)
                self.expect_places(then["documents"], now["documents"])

    def expect_places(self, then, now):
        for what, places in then.items():
            for place, kinds in ((moved(place), kinds) for place, kinds in places.items()):
                self.assertIn(place, now.get(what, {}), what)
                self.assertFalse(kinds and now[what][place] and set(now[what][place]) - set(kinds), f"{what}: {place} is {now[what][place]}, was {kinds}")

    def test_a_daemon_goes_on_where_one_before_was_killed(self):
        for version in VERSIONS:
            with self.copy(version) as folder:
                then, facts = kept(version, "goes-on.json"), kept(version, "interface.json")
                answers, [record], asked = interface.goes_on(self, BUILD, SOURCE, folder / "state")
                self.assertLessEqual(set(then.pop("outbox")), set(answers["outbox"]))
                for what, answer in then.items():
                    self.assertTrue(same(answer, answers[what]), f"{what}: {answers[what]}, was {answer}")
                self.expect_record(kept(version, "goes-on-record.json"), list_record.listing(record))
                for name, compare in (("openapi", lambda: self.expect_described(kept(version, "openapi.json"), asked["openapi"])),
                                      ("live", lambda: self.expect_places(facts["live"], asked["live"])),
                                      ("metrics", lambda: self.assertLessEqual(set(facts["metrics"]), set(asked["metrics"])))):
                    with self.subTest(part=name):
                        compare()

    def expect_described(self, then, now):
        gone = re.compile(rf"\.({A_DIAGNOSTIC}) is (gone|not always there)$")
        self.assertEqual("\n".join(line for line in worse(then, now) if not gone.search(line)), "")
        self.assertLessEqual(set(DIAGNOSTICS), set(now["components"]["schemas"]["Results"]["properties"]["diagnostics"]["required"]))

    def expect_record(self, then, now):
        """The record of a journal, as the version before made it itself."""
        self.assertEqual(now["root"]["format"], then["root"]["format"])
        for name, data in then["datasets"].items():
            name = re.sub(rf"^(entry/results)/({A_DIAGNOSTIC})$", r"\1/diagnostics/\2", name)
            self.assertIn(name, now["datasets"])
            if name == "entry/process/file_sha256":
                continue  # Of all bits of the file; those of the raw values are compared.
            found = now["datasets"][name]
            if data["type"] in ("f4", "f8"):
                data.pop("sha256", None)  # Another processor's mathematics may differ in the last bits.
            self.assertTrue(same(data, found), f"{name}: {found}, was {data}")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""Manual pages, completion and colours: made from the parsers, compared here with what --help says, both ways, and read
by the programs that they are for.

manual_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from running_daemon import RunningDaemon
from terminal import run_at_a_terminal

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
PROGRAMS = {"stickslip": BUILD / "bin" / "stickslip", "stickslipd": BUILD / "bin" / "stickslipd"}
PAGES = {"stickslip": 1, "stickslipd": 8, "stickslipd.toml": 5}
TIMEOUT_S = 120


def run(*words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=TIMEOUT_S, check=False, **options)


def printed(*words):
    done = run(*words)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Help:
    """What --help of a program, or of one of its commands, lists."""

    def __init__(self, *words):
        text = printed(*words, "--help")
        self.options = set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", "\n".join(re.findall(r"(?m)^  (-\S*)", text))))
        listed = re.search(r"(?ms)^Subcommands:\n(.*?)(?:\n\n|\Z)", text)
        self.commands = re.findall(r"(?m)^  ([a-z]+)", listed[1]) if listed else []


class Manual(unittest.TestCase):
    def page(self, name):
        return printed(PROGRAMS["stickslip"], "man", name)

    def test_pages_are_read_without_a_warning(self):
        for name, section in PAGES.items():
            with self.subTest(page=name), tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / f"{name}.{section}"
                file.write_text(self.page(name), encoding="utf-8")
                read = run("man", "--warnings=w", "-E", "UTF-8", "-l", file, env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8", "MANPAGER": "cat"})
                self.assertEqual((read.returncode, read.stderr), (0, ""))
                self.assertGreater(len(read.stdout), 1000)
                # They have no date: they are as old as the program that prints them.
                lint = run("mandoc", "-Tlint", "-W", "warning", file).stdout.splitlines()
                self.assertEqual([line for line in lint if not line.endswith('missing date, using "": TH')], [])

    def test_each_command_and_option_of_the_help_is_in_the_page_and_no_other(self):
        for program, path in PROGRAMS.items():
            text = self.page(program).replace("\\-", "-")
            top = Help(path)
            parts = re.split(r"(?m)^\.SS (\S+)\n", text)
            self.assertEqual(set(parts[1::2]), set(top.commands))
            described = {"": parts[0], **dict(zip(parts[1::2], parts[2::2]))}
            for command, part in described.items():
                with self.subTest(program=program, command=command):
                    options = set(re.findall(r"\\fB(--[a-z0-9-]+)\\fR", part.split(".SH EXAMPLES")[0]))
                    self.assertEqual(options, (Help(path, command) if command else top).options)

    def test_each_key_of_the_configuration_is_in_its_page_and_no_other(self):
        def keys(text, header, key):
            table, found = None, []
            for line in text.splitlines():
                if match := re.match(header, line):
                    table = match[1]
                elif match := re.match(key, line):
                    found.append((table, match[1]))
            return found

        shipped = keys((SOURCE / "config" / "stickslipd.toml").read_text(encoding="utf-8"), r"\[([a-z_.]+)\]", r"(?:# )?([a-z_]+) = ")
        self.assertGreater(len(shipped), 60)
        page = keys(self.page("stickslipd.toml"), r"\.SH \[([a-z_.]+)\]", r"\\fB([a-z_]+) = ")
        self.assertEqual(page, shipped)
        # And what is said of them, word for word.
        said, told = [], []
        for line in (SOURCE / "config" / "stickslipd.toml").read_text(encoding="utf-8").partition("\n[")[2].splitlines():
            comment = re.match(r'(?:[a-z_.]+\]|\[[a-z_.]+\]|(?:# )?[a-z_]+ = (?:"[^"]*"|\[[^\]]*\]|[^\s#]+))?\s*(?:#\s*(.*))?$', line)
            said += (comment[1] or "").split()
        for line in self.page("stickslipd.toml").replace("\\-", "-").replace("\\&", "").partition("\n.SH [")[2].partition("\n.SH SEE ALSO")[0].splitlines()[1:]:
            told += line.split() if not line.startswith((".", "\\fB")) else []
        self.assertEqual(told, said)


class CommandLine(unittest.TestCase):
    """Help, spelling and refusals, as they are typed."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="stickslip-")))

    def refused(self, *words, status=2):
        done = run(PROGRAMS["stickslip"], *words, cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (status, "", 1), done)
        return done.stderr

    def examples(self, *words):
        text = printed(PROGRAMS["stickslip"], *words, "--help").partition("Examples:\n")[2]
        return re.findall(r"(?m)^  (stickslip .*)$", re.sub(r"\\\n\s*", "", text))

    def test_each_subcommand_has_three_examples_of_its_own_that_its_parser_accepts(self):
        top = Help(PROGRAMS["stickslip"]).commands
        commands = [[name] for name in top] + [["batch", name] for name in Help(PROGRAMS["stickslip"], "batch").commands]
        self.assertGreater(len(commands), 30)
        for words in commands:
            own = self.examples(*words)
            with self.subTest(command=words):
                self.assertGreaterEqual(len(own), 3)
                self.assertTrue(any(example.startswith(" ".join(["stickslip", *words])) for example in own), own)
                self.assertNotIn("stickslip demo", [example for example in own if words != ["demo"]])
            for example in own:
                # What stands behind the command explains it; a pipe or a file is the shell's.
                typed = re.split(r" {3,}", example)[0]
                # Quotes keep what stands in them; the parser is all that is asked: it refuses before anything is done.
                argued = re.split(r"\s(?:&&|\||>|<)\s|;\s", typed)[0]
                with self.subTest(example=argued):
                    words_of = shlex.split(argued)[1:]
                    # An option that none has, behind all: nothing is done, and nothing else is complained of.
                    told = run(PROGRAMS["stickslip"], *words_of, "--no-such-option", cwd=self.folder)
                    self.assertEqual(told.returncode, 2, told)
                    self.assertRegex(told.stderr, r"^stickslip: stickslip [a-z ]+has no option --no-such-option; ")

    def test_a_wrong_word_is_named_with_the_nearest(self):
        self.assertIn('there is no subcommand "demoo"; did you mean demo?', self.refused("demoo"))
        self.assertIn('there is no subcommand "reprot"; did you mean report?', self.refused("reprot", "a.h5"))
        self.assertIn("stickslip simulate has no option --ouput; did you mean --output?", self.refused("simulate", "--ouput", "x"))
        self.assertIn("stickslip batch begin has no option --replicate; did you mean --replicates?", self.refused("batch", "begin", "--replicate", "3"))

    def test_other_spellings_and_help_do_the_same(self):
        stickslip = PROGRAMS["stickslip"]
        self.assertEqual(printed(stickslip, "analyse", "--help"), printed(stickslip, "analyze", "--help"))
        self.assertEqual(printed(stickslip, "characterize", "--help"), printed(stickslip, "characterise", "--help"))
        self.assertEqual(printed(stickslip, "help"), printed(stickslip, "--help"))
        self.assertEqual(printed(stickslip, "help", "plot"), printed(stickslip, "plot", "--help"))

    def test_refusals_name_value_limit_and_remedy(self):
        self.assertIn("--limit cof=0.2:0.4: there is no result called \"cof\"; the coefficients of friction are static_coefficient and kinetic_coefficient",
                      self.refused("batch", "begin", "--name", "x", "--limit", "cof=0.2:0.4"))
        self.assertIn('there is no result called "mu_kk"; did you mean mu_k?', self.refused("batch", "begin", "--name", "x", "--limit", "mu_kk=0.2:0.4"))
        self.assertIn("must be RESULT=LOWEST:HIGHEST, such as mu_k=0.2:0.4", self.refused("batch", "begin", "--name", "x", "--limit", "mu_k=0.3"))
        scene = "stick-slip-at-12-in-per-min"
        self.assertIn('paper.mu_s = "0,34": has a comma: the decimal sign is a point: write "0.34"', self.refused("simulate", scene, "-o", "q.h5", "--set", "paper.mu_s=0,34"))
        # The remedy works.
        self.assertEqual(run(PROGRAMS["stickslip"], "simulate", scene, "-o", "q.h5", "--set", "paper.mu_s=0.34", cwd=self.folder).returncode, 0)
        self.assertIn('x.gif: a picture ends in .svg or .png, not in ".gif"', self.refused("plot", "q.h5", "-o", "x.gif"))
        self.assertFalse((self.folder / "x.gif").exists())
        doctor = run(PROGRAMS["stickslip"], "doctor", "--config", "none.toml", cwd=self.folder)
        self.assertIn("none.toml: there is no such file", doctor.stdout)
        self.assertIn("name it: stickslip doctor --config FILE", doctor.stdout)
        self.assertNotIn("correct the line", doctor.stdout)

    @unittest.skipIf(shutil.which("gnuplot") is None, "no gnuplot")
    def test_a_picture_is_what_its_name_says(self):
        for name, begin in (("x.png", b"\x89PNG\r\n"), ("x.svg", b"<?xml")):
            done = run(PROGRAMS["stickslip"], "plot", "ring-down-at-12-in-per-min", "-o", name, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.folder / name).read_bytes().startswith(begin), name)

    def test_the_demo_fits_80_columns_and_says_what_to_do_next(self):
        text = printed(PROGRAMS["stickslip"], "demo", "--folder", self.folder)
        below = text.partition("records in ")[2]
        records = pathlib.Path(below.partition("\n")[0])
        self.assertEqual(len(list(records.glob("*.h5"))), 10)
        lines = text.partition("records in ")[0].splitlines()
        self.assertLessEqual(max(map(len, lines)), 80)
        for legend in ("± stat.  standard error", "± syst.  systematic part", "truth    what was simulated"):
            self.assertEqual(sum(line.startswith(legend) for line in lines), 1, legend)
        for name in re.findall(r"(?m)^file of test \d+: (.*)$", text):
            self.assertTrue((records / name).exists(), name)
        # What is said to do next is done.
        [command] = re.findall(r"(?m)^  (\S*stickslip report .*)$", below)
        done = subprocess.run(["sh", "-c", command], cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Regimes at one speed are not averaged; --pool regimes does", done.stdout)
        self.assertTrue((self.folder / "demo.html").exists())


class Completion(unittest.TestCase):
    def words(self, program, *line):
        """What bash offers after these words."""
        script = printed(PROGRAMS["stickslip"], "completion", "bash", "--program", program)
        array = " ".join(f"'{word}'" for word in (program, *line))
        return set(printed("bash", "-c", f'{script}\nCOMP_WORDS=({array}) COMP_CWORD={len(line)}; _{program}; printf "%s\\n" "${{COMPREPLY[@]}}"').split())

    def test_bash_offers_what_the_help_lists(self):
        for program, path in PROGRAMS.items():
            top = Help(path)
            if top.commands:
                self.assertEqual({word for word in self.words(program, "") if not word.startswith("-")}, set(top.commands))
            self.assertEqual({word for word in self.words(program, "--")}, top.options)
            for command in top.commands:
                with self.subTest(command=command):
                    self.assertEqual(self.words(program, command, "--"), Help(path, command).options)
                    self.assertEqual(self.words(program, command, ""), set())  # A file.
        self.assertEqual(self.words("stickslip", "ar"), {"arm"})

    @unittest.skipUnless(shutil.which("fish"), "no fish")
    def test_fish_offers_them_too(self):
        top = Help(PROGRAMS["stickslip"])
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "stickslip.fish"
            script.write_text(printed(PROGRAMS["stickslip"], "completion", "fish"), encoding="utf-8")

            def offered(line):
                text = printed("fish", "--no-config", "-c", f"source {script}; complete -C '{line}'")
                return {entry.split("\t")[0] for entry in text.splitlines()}

            self.assertEqual({word for word in offered("stickslip ") if re.fullmatch("[a-z]+", word)} & set(top.commands), set(top.commands))
            self.assertEqual({word for word in offered("stickslip plot --") if word.startswith("--")}, Help(PROGRAMS["stickslip"], "plot").options)

    @unittest.skipUnless(shutil.which("zsh"), "no zsh")
    def test_zsh_takes_the_script_and_offers_them_too(self):
        script = printed(PROGRAMS["stickslip"], "completion", "zsh")
        # The list that would be described, without a terminal.
        probe = ("compdef() { }; _files() { print FILES }; _describe() { print -l -- ${(@)found%%:*} }\n" + script
                 + "\nwords=(stickslip '') CURRENT=2 PREFIX='' _stickslip; print -- ---; words=(stickslip plot --) CURRENT=3 PREFIX=-- _stickslip\n"
                 + "print -- ---; words=(stickslip plot '') CURRENT=3 PREFIX='' _stickslip")
        first, second, third = printed("zsh", "-f", "-c", probe).split("---\n")
        self.assertEqual({word for word in first.split() if not word.startswith("-")}, set(Help(PROGRAMS["stickslip"]).commands))
        self.assertEqual({word for word in second.split() if word.startswith("--")}, Help(PROGRAMS["stickslip"], "plot").options)
        self.assertEqual(third, "FILES\n")


class Colours(unittest.TestCase):
    def at_a_terminal(self, daemon, **environment):
        text, code, _ = run_at_a_terminal([PROGRAMS["stickslip"], "status", "--socket", daemon.socket], timeout_s=TIMEOUT_S, env=environment)
        self.assertEqual(code, 0)
        return text.decode()

    def test_status_is_a_table_with_colours_at_terminals_that_want_them(self):
        daemon = RunningDaemon(self, BUILD, SOURCE)
        plain = daemon.run("status").stdout
        self.assertNotIn("\033", plain)
        self.assertRegex(plain, r"(?m)^state     acquiring$")
        self.assertRegex(plain, r"(?m)^board     simulated tester \(simulated\), 350.00 Hz$")
        self.assertRegex(plain, r"(?m)^storage   ok(, room for \d+ h)?$")
        self.assertIn('"state": "acquiring"', daemon.run("status", "--json").stdout)
        coloured = self.at_a_terminal(daemon, TERM="xterm")
        self.assertIn("\033[32macquiring\033[0m", coloured)
        self.assertIn("acquiring", re.sub(r"\033\[\d+m", "", coloured))
        for environment in ({"TERM": "xterm", "NO_COLOR": "1"}, {"TERM": "dumb"}, {}):
            with self.subTest(environment=environment):
                self.assertNotIn("\033", self.at_a_terminal(daemon, **environment))
        self.assertIn("\033[32m", self.at_a_terminal(daemon, TERM="xterm", NO_COLOR=""))


class Unwritable(unittest.TestCase):
    """On a full disk, which /dev/full is."""

    def test_a_status_of_its_own_and_a_line_say_that_output_cannot_be_written(self):
        with tempfile.TemporaryDirectory() as folder:
            pull = pathlib.Path(folder) / "pull.h5"
            printed(PROGRAMS["stickslip"], "simulate", "stick-slip-at-12-in-per-min", "-o", pull)
            for number in range(60):  # More names than stdout holds back.
                (pull.parent / f"{'x' * 100}-{number}.h5").hardlink_to(pull)
            for words in (["find", folder, "-0"], ["verify", pull], ["analyze", pull], ["show", pull], ["export", pull, "--csv"], ["boards", "--json"], ["scenes"], ["--help"]):
                with self.subTest(command=words[0]), open("/dev/full", "w", encoding="utf-8") as full:
                    done = subprocess.run([PROGRAMS["stickslip"], *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=TIMEOUT_S, check=False)
                    self.assertEqual(done.returncode, 74)
                    self.assertEqual(done.stderr, "stickslip: the output cannot be written: No space left on device: make room there, or write it elsewhere\n")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

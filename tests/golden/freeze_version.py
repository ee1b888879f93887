#!/usr/bin/env python3
"""Keeps what this version reads, writes and answers, for later versions to be held to (`system_compatibility`). Run once for each
version, before it is left behind; what it made is never made anew.

freeze_version.py BUILD_DIR SOURCE_DIR tests/golden/vMAJOR.MINOR

    commit              that the programs are of
    config/NAME.toml    configurations that hold every key, and the files they name
    scenes, methods     as shipped, without comments
    interface.json      words of the command line, names in what is printed, live stream, metrics (interface.py)
    openapi.json        description of the API without what is said to people
    state/              what a daemon left that was killed in a test: configuration, journal, record, batch, outbox, calibration
    goes-on.json        what this version answers when it is started there
    goes-on-record.json what stands in the record that it makes of the journal (list_record.py)
"""

import contextlib
import json
import pathlib
import re
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "system"))

import interface
import list_record
from running_daemon import RunningDaemon, scene_with, wait_for

# Files that a configuration names, and what makes them exist.
NAMED = ("hanging", "plant-ca.pem", "bench-7.pem", "bench-7.key")
# One key excludes the other.
ALONE = ({"board.comedi.position_channel", "board.comedi.position_gain", "board.comedi.position_zero", "method.file"},
         {"board.comedi.speed_channel", "board.comedi.speed_gain", "board.comedi.speed_zero", "method.name", "method.kinetic_cycles"})
PLAN = {"name": "liner 42", "grade": "kraft", "direction": "MD", "side": "wire", "operator": "Ada", "pull_speeds": [0.00508], "replicates": 2, "slides": 2,
        "limits": {"mu_k": {"lowest": 0.2, "highest": 0.4}}}


class Stack(contextlib.ExitStack):
    """In the place of a test."""

    def addCleanup(self, function, *arguments):
        self.callback(function, *arguments)


def uncommented(text):
    """Settings without comments and empty lines."""
    lines = (re.match(r'((?:[^"#]|"[^"]*")*?)\s*(?:#.*)?$', line)[1] for line in text.splitlines())
    return "\n".join(line for line in lines if line) + "\n"


def every_key(text):
    """A key that is commented out shows how it is written: it is used."""
    return uncommented(re.sub(r"(?m)^# (?=[a-z_]+ = )", "", text))


def keys(text):
    """(table, key, line) of each line of settings."""
    table = ""
    for line in text.splitlines():
        if header := re.match(r"\[+([a-z_.]+)\]", line):
            table = header[1]
        yield f"{table}.{line.split(' = ')[0]}", line


def freeze_settings(build, source, folder):
    config = folder / "config"
    shutil.copytree(source / "config" / "scenes", folder / "scenes")
    shutil.copytree(source / "config" / "methods", folder / "methods")
    for file in (*folder.glob("scenes/*.toml"), *folder.glob("methods/*.toml")):
        file.write_text(uncommented(file.read_text(encoding="utf-8")), encoding="utf-8")
    config.mkdir()
    for name in NAMED:
        (config / name).write_text("0.5\n" if name == "hanging" else "-\n")
    (config / "password").write_text("secret\n")
    (config / "password").chmod(0o600)
    ring_downs = []
    for seed in (1, 2):
        ring_downs.append(folder / f"{seed}.h5")
        interface.printed(build / "bin" / "stickslip", "simulate", "ring-down-at-12-in-per-min", "-o", ring_downs[-1], "--seed", seed)
    interface.printed(build / "bin" / "stickslip", "characterise", *ring_downs, "-o", config / "tester.toml")
    for file in ring_downs:
        file.unlink()
    interface.printed(build / "bin" / "stickslip", "calibrate", "--points", source / "config" / "calibration-readings.toml", "--folder", config / "calibrations", "--valid-days", "0")
    every = every_key((source / "config" / "stickslipd.toml").read_text(encoding="utf-8"))
    every = every.replace('"../records/20261121T125252Z-0001.h5"', '"../state/records/first.h5"').replace('"scenes/', '"../scenes/').replace('"methods/', '"../methods/')
    for driver, alone in zip(("simulated", "comedi", "replay"), (*ALONE, set())):
        kept = [line for place, line in keys(every) if place not in (alone or ALONE[0])]
        (config / f"{driver}.toml").write_text("\n".join(kept).replace('driver = "simulated"', f'driver = "{driver}"') + "\n")
    return every


BOARD = """
[board]
driver = "simulated"
clock_speed = 5
[board.simulated]
scenes = ["first.toml", "second.toml"]
repeats = 0
[test]
begins = "command"
[tester]
calibration = "calibrations"
[fleet]
broker = "mqtt://127.0.0.1:1"
tester = "bench-7"
"""


def freeze_state(build, source, folder):
    """A daemon is killed in its second test. Returns the record of the first."""
    def prepare(place):
        (place / "first.toml").write_text(uncommented(scene_with(source, interface.TIMES)))
        (place / "second.toml").write_text(uncommented(scene_with(source, {**interface.TIMES, "pull": "600 s"})))
        shutil.copytree(folder / "config" / "calibrations", place / "calibrations")

    with Stack() as stack:
        daemon = RunningDaemon(stack, build, source, board=BOARD, prepare=prepare, times=interface.TIMES)
        status, told = daemon.ask("POST", "/v1/batch", PLAN)
        assert status == 200, told
        process, frames = daemon.watch()
        stack.callback(process.communicate)
        stack.callback(process.kill)
        interface.begin(daemon, frames)
        wait_for(frames, lambda frame: frame["type"] == "test-ended")
        record = daemon.record(1)
        interface.begin(daemon, frames)
        for cycle in (3, 8):
            wait_for(frames, lambda frame, number=cycle: frame["type"] == "cycle" and frame["number"] == number)
            assert daemon.ask("POST", "/v1/mark", {"text": f"gewölbt nach {cycle}"})[0] == 200
        daemon.kill()
        shutil.copytree(daemon.folder, folder / "state", ignore=shutil.ignore_patterns("notify", "*.sock", ".stickslip-ballast"))
        return folder / "state" / record.relative_to(daemon.folder)


def write(file, document):
    file.write_text(json.dumps(document, indent=0, sort_keys=True, ensure_ascii=False) + "\n", encoding="utf-8")


def main():
    build, source, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    folder.mkdir(parents=True)
    told = interface.printed(build / "bin" / "stickslip", "--version")
    assert "dirty" not in told, told
    (folder / "commit").write_text(re.search(r"\((\w+)\)", told)[1] + "\n")
    every = freeze_settings(build, source, folder)
    record = freeze_state(build, source, folder)
    for file in folder.glob("config/*.toml"):
        file.write_text(file.read_text().replace("../state/records/first.h5", f"../{record.relative_to(folder)}"))
    kept = set().union(*({place for place, _ in keys(file.read_text())} for file in folder.glob("config/*.toml")))
    assert not (missing := {place for place, _ in keys(every)} - kept), missing
    facts = interface.outputs(build, record)
    facts["command_line"] = {program: interface.command_line(build / "bin" / program) for program in ("stickslip", "stickslipd")}
    with Stack() as stack:
        answers, [made], asked = interface.goes_on(stack, build, source, folder / "state")
        write(folder / "goes-on-record.json", list_record.listing(made))
    write(folder / "openapi.json", asked.pop("openapi"))
    write(folder / "interface.json", facts | asked)
    write(folder / "goes-on.json", answers)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Compares the include lines of every source file with the tables in docs/architecture.md.

Table `includes`: FOLDER: folders whose headers it may include besides its own ("*": any).
Table `wrapped`:  HEADER: the only folders that may include this header of a library.
Prints one line per breach and exits with 1; exits with 2 if a table cannot be read. Only tests and bench may include anything,
and no folder may reach itself through others.
"""

import graphlib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "architecture.md"
SOURCES = ("core", "drivers", "io", "report", "daemon", "cli", "tests", "bench")
#: They include whatever they test.
FREE = ("tests", "bench")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def read_table(name):
    """Returns {key: [values]} of the fenced block called `name`."""
    match = re.search(rf"^```{name}\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    if not match:
        print(f"{PAGE.relative_to(ROOT)}: no fenced block called '{name}'", file=sys.stderr)
        sys.exit(2)
    table = {}
    for line in match.group(1).splitlines():
        if line.strip():
            key, _, values = line.partition(":")
            table[key.strip()] = values.split()
    return table


def folder_of(path, folders):
    """The longest folder of the table that holds `path`, or None."""
    holders = [folder for folder in folders if path.startswith(folder + "/")]
    return max(holders, key=len, default=None)


def main():
    includes, wrapped = read_table("includes"), read_table("wrapped")
    breaches, checked = [], 0
    breaches += [f"{PAGE.name}: {folder} may not include everything" for folder, others in includes.items() if "*" in others and folder not in FREE]
    try:
        graphlib.TopologicalSorter({folder: others for folder, others in includes.items() if folder not in FREE}).prepare()
    except graphlib.CycleError as error:
        breaches.append(f"{PAGE.name}: a circle of folders: {' -> '.join(error.args[1])}")
    for top in SOURCES:
        for source in sorted((ROOT / top).rglob("*")):
            if source.suffix not in (".cpp", ".hpp"):
                continue
            checked += 1
            path = source.relative_to(ROOT).as_posix()
            here = folder_of(path, includes)
            if here is None:
                breaches.append(f"{path}: its folder is not in the table of docs/architecture.md")
                continue
            for number, line in enumerate(source.read_text().splitlines(), start=1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                style, header = match.groups()
                if header in wrapped and here not in wrapped[header]:
                    allowed = ", ".join(wrapped[header])
                    breaches.append(f"{path}:{number}: <{header}> may only be included in {allowed}")
                if style != '"':
                    continue
                there = folder_of(header, includes)
                if there is None:
                    breaches.append(f'{path}:{number}: "{header}" is not written from the root of the project')
                elif there != here and there not in includes[here] and "*" not in includes[here]:
                    allowed = ", ".join([here, *includes[here]])
                    breaches.append(f"{path}:{number}: {here} may not include {there} (only {allowed})")
    for breach in breaches:
        print(breach, file=sys.stderr)
    if checked == 0:
        print("no source files found", file=sys.stderr)
    return 1 if breaches or checked == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

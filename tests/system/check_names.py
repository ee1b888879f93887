"""Compares the tables of docs/record-file.md with real records, both ways: no data set that is not documented with
its type and unit, no documented one that is in none of them; and every number of each has a unit.

check_names.py DOCUMENT FILE.h5...   Exit status 77: no h5py.
"""
import re
import sys

try:
    import h5py
except ImportError as error:
    print(error)
    sys.exit(77)

TYPES = {"f4": "f32", "f8": "f64", "i4": "i32", "i8": "i64", "u1": "u8", "u2": "u16", "u4": "u32", "u8": "u64"}
# "### gaps and events", "### instrument ...": their names say the group themselves.
SECTIONS = ("raw", "cycles", "results", "findings", "timing", "plan", "self_check", "process", "truth")


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def names_of(cell):
    """The names in a cell with the folder of the first."""
    names = re.findall(r"`([^`]+)`", cell)
    folder = names[0].rpartition("/")[0] if names else ""
    return [name if "/" in name or not folder else f"{folder}/{name}" for name in names]


def each(cell, count):
    """A list as long as the names, from "a, b" or from one for all."""
    parts = [part.strip() for part in cell.split(",") if part.strip() not in ("column",)]
    return parts * count if len(parts) == 1 else parts


def documented(path):
    """{name: set of (type, unit)}"""
    found = {}

    def add(prefix, names, types, units):
        assert len(types) == len(units) == len(names), (names, types, units)
        for name, kinds, unit in zip(names, types, units):
            for kind in kinds.split(" or "):
                found.setdefault(prefix + name, set()).add((kind.strip(), "" if kind == "text" else unit))

    section, header = None, None
    for line in open(path, encoding="utf-8"):
        if line.startswith("## "):
            section = "" if line.startswith("## /entry") else None
        elif line.startswith("### "):
            word = line.split()[1]
            section = f"{word}/" if word in SECTIONS else ""
        elif not line.startswith("|"):
            header = None
        elif section is not None and header is None:
            header = cells(line)
        elif section is not None and not line.startswith("|---"):
            row = cells(line)
            if header[:3] == ["name", "type", "unit"]:
                names = names_of(row[0])
                add(section, names, each(row[1], len(names)), each(row[2], len(names)))
            elif header[:2] == ["name", "unit"]:  # Results: two tables side by side, all f64.
                for name_cell, unit in ((row[0], row[1]), (row[3], row[4])):
                    names = names_of(name_cell)
                    kind = "text" if "column of texts" in name_cell else "f64"
                    add(section, names, [kind] * len(names), [unit] * len(names))
    # The words among the results stand in the sentences before the table.
    for name in ("regime", "rung"):
        found[f"results/{name}"] = {("text", "")}
    return found


def kind_of(data):
    if h5py.check_string_dtype(data.dtype) is not None:
        return "text"
    assert data.dtype.byteorder in "<|=", data.name
    return TYPES[data.dtype.str[1:]]


def main():
    document, files = sys.argv[1], sys.argv[2:]
    known = documented(document)
    assert len(known) > 100, "the tables were not found"
    seen, wrong = set(), []
    for path in files:
        def visit(name, item):
            if not isinstance(item, h5py.Dataset):
                return
            # A user chooses the keys.
            name = re.sub(r"^metadata/.+", "metadata/KEY", name)
            seen.add(name)
            kind = kind_of(item)
            unit = item.attrs.get("units", "")
            if kind != "text" and unit == "":
                wrong.append(f"{name} has no unit")
            if (kind, unit) not in known.get(name, set()):
                wrong.append(f"{name}: {kind} [{unit}] in {path}, documented: {sorted(known.get(name, []))}")

        with h5py.File(path) as record:
            record["entry"].visititems(visit)
    wrong += [f"{name} is documented but in none of the records" for name in sorted(set(known) - seen)]
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()

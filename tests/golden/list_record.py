#!/usr/bin/env python3
"""What h5py reads in a record, as JSON: the listing beside each golden record, made once, when it was frozen.

list_record.py FILE.h5 > FILE.json

A scalar is there by its value (not a number: "nan"), a column of texts by its texts, a column of numbers by the
SHA-256 of its values as they are stored, little-endian. Attributes that say nothing of the test (NeXus classes,
dimension scales) are left out.
"""
import hashlib
import json
import math
import sys

import h5py

ATTRIBUTES = ("units", "reason", "standard_error", "systematic_uncertainty", "maxdata", "meaning", "place")


def plain(value):
    """A number or text that JSON knows."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, str):
        return value
    if hasattr(value, "dtype") and value.ndim == 1:
        return [plain(element) for element in value]
    if hasattr(value, "item"):
        value = value.item()
    return "nan" if isinstance(value, float) and math.isnan(value) else value


def listing_of(data):
    text = h5py.check_string_dtype(data.dtype) is not None
    entry = {"type": "text" if text else data.dtype.str[1:]}
    for key in ATTRIBUTES:
        if key in data.attrs:
            entry[key] = plain(data.attrs[key])
    if data.ndim == 0:
        entry["value"] = plain(data[()])
    elif text:
        entry["texts"] = [plain(element) for element in data[:]]
    else:
        values = data[:]
        entry["rows"] = len(values)
        entry["sha256"] = hashlib.sha256(values.astype(values.dtype.newbyteorder("<")).tobytes()).hexdigest()
    return entry


def listing(path):
    datasets = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            datasets[name] = listing_of(item)

    with h5py.File(path) as record:
        record.visititems(visit)
        return {"root": {key: plain(value) for key, value in record.attrs.items()}, "datasets": datasets}


if __name__ == "__main__":
    json.dump(listing(sys.argv[1]), sys.stdout, indent=1, ensure_ascii=False)
    print()

"""Reads a record as its users do, with h5py and, where installed, pandas; ends with 0 if all is as
docs/record-file.md says. Usage: read_record.py FILE.h5 SIGNAL ROWS. Exit status 77: no h5py."""
import sys

try:
    import h5py
    import numpy
except ImportError as error:
    print(error)
    sys.exit(77)

import hdf5_1_8
from stored import stored

path, signal, rows = sys.argv[1], sys.argv[2], int(sys.argv[3])


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def check_number(name, data):
    assert isinstance(data.attrs["units"], str), name
    assert data.attrs["long_name"].endswith(f"[{data.attrs['units']}]"), (name, data.attrs["long_name"])


def check_object(name, item):
    for key, value in item.attrs.items():
        # CLASS and NAME are written by HDF5's own dimension scales.
        if isinstance(value, (str, bytes)) and key not in ("CLASS", "NAME"):
            kind = h5py.check_string_dtype(item.attrs.get_id(key).dtype)
            assert kind.encoding == "utf-8" and kind.length is None, (name, key)
    if isinstance(item, h5py.Group):
        assert item.attrs["NX_class"].startswith("NX"), name
        assert item.id.get_create_plist().get_link_creation_order() & h5py.h5p.CRT_ORDER_TRACKED, name
        return
    kind = h5py.check_string_dtype(item.dtype)
    if kind is not None:
        assert kind.encoding == "utf-8" and kind.length is not None, name
    else:
        check_number(name, item)
        assert item.size == 0 or item.ndim == 0 or item.fletcher32, name


def check_scales(group, scale):
    for name, column in group.items():
        if name != scale and column.ndim == 1:
            assert column.dims[0][0].name == group[scale].name, column.name


# Written by HDF5 1.10 for readers from 1.8 on.
objects, messages, indexes = hdf5_1_8.check(path)
assert objects > 60 and messages > 5 * objects and indexes > 0, (objects, messages, indexes)

with h5py.File(path) as record:
    assert record.attrs["format"] == "stickslip-record" and record.attrs["format_version"] == 3
    names = []
    record.visit(names.append)
    assert len(names) > 60, names
    for name in names:
        check_object(name, record[name])

    # What a NeXus viewer plots without being asked.
    plot = record[record.attrs["default"]]
    plot = plot[plot.attrs["default"]]
    assert plot.name == "/entry/raw" and plot.attrs["NX_class"] == "NXdata"
    assert plot.attrs["signal"] == signal
    assert [text(axis) for axis in plot.attrs["axes"]] == ["time"]
    values, time = plot[signal][:], plot["time"][:]
    assert values.shape == time.shape == (rows,)
    assert (numpy.diff(time) > 0).all() and time[0] == 0
    check_scales(plot, "time")
    check_scales(record["entry/cycles"], "cycle")
    assert record["entry/cycles"].attrs["signal"] == "delta_mu"

    # Force is what the board's polynomial and the load cell say.
    if signal == "force":
        adc, cell = record["entry/instrument/adc"], record["entry/instrument/calibration"]
        volts = numpy.polynomial.polynomial.polyval(
            plot["counts"][:].astype(float) - adc["expansion_origin"][()], adc["polynomial"][:])
        force = (volts - cell["zero"][()]) * cell["gain"][()]
        assert numpy.allclose(force, values, rtol=1e-6, atol=1e-6)  # f32: 6e-8 of about 50 N.

    for name, result in stored(record).items():
        if name not in ("regime", "rung", "findings"):
            assert numpy.isnan(result[()]) == ("reason" in result.attrs), name

try:
    import pandas
except ImportError:
    print("pandas is not installed: its reader is not tried")
else:
    table = pandas.DataFrame({k: d[()] for k, d in h5py.File(path)["entry/cycles"].items()}).set_index("cycle")
    assert "delta_mu" in table.columns

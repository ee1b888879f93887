"""A small checker of the NeXus rules that make a file plot by default, with h5py. No validator is packaged in Debian.

check(path) returns what is wrong, a list of sentences. The rules: https://manual.nexusformat.org/datarules.html (groups
have classes; default attributes lead from the root to data; signal and axes of NXdata name data sets of fitting
lengths; numbers have units).
"""
import h5py

CLASSES = {"NXroot", "NXentry", "NXdata", "NXcollection", "NXinstrument", "NXdetector", "NXsample", "NXuser",
           "NXprocess", "NXcalibration"}


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def check_group(group, wrong):
    name = text(group.attrs.get("NX_class", ""))
    if name not in CLASSES:
        wrong.append(f"{group.name}: NX_class '{name}'")
    if name == "NXdata":
        check_data(group, wrong)
    for item in group.values():
        if isinstance(item, h5py.Group):
            check_group(item, wrong)
        elif h5py.check_string_dtype(item.dtype) is None and not text(item.attrs.get("units", "")):
            wrong.append(f"{item.name}: has no units")


def check_data(group, wrong):
    signal = text(group.attrs.get("signal", ""))
    axes = [text(axis) for axis in group.attrs.get("axes", [])]
    if signal not in group:
        wrong.append(f"{group.name}: signal '{signal}' is not there")
        return
    if len(axes) != group[signal].ndim:
        wrong.append(f"{group.name}: {len(axes)} axes for a signal of {group[signal].ndim} dimensions")
    for axis, length in zip(axes, group[signal].shape):
        if axis not in group or group[axis].shape != (length,):
            wrong.append(f"{group.name}: axis '{axis}' is not there or of another length")


def check(path):
    wrong = []
    with h5py.File(path, "r") as root:
        check_group(root, wrong)
        if text(root.attrs.get("NX_class", "")) != "NXroot":
            wrong.append("the root is no NXroot")
        place, classes = root, []
        while "default" in place.attrs:
            name = text(place.attrs["default"])
            if name not in place:
                wrong.append(f"{place.name}: default '{name}' is not there")
                break
            place = place[name]
            classes.append(text(place.attrs.get("NX_class", "")))
        if classes != ["NXentry", "NXdata"]:
            wrong.append(f"default leads over {classes}")
    return wrong

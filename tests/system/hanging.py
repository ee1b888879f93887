"""Hands that hang weights on the load cell of the simulated tester."""

import os
import pathlib
import tempfile

from scipy.stats import norm, t

from running_daemon import PATIENT, scene_with


def standard_errors_allowed(readings):
    """How many of its standard errors a line through them may be off, where those come from what the readings leave of
    the line: Student's t for what four standard deviations are of a normal number. Of seven readings 12.28; four are
    passed by one line in a hundred."""
    return float(t.isf(norm.sf(4), readings - 2))


# What is said of a reading with nothing on: one in a thousand differs from the tare by chance, and then by too little.
NOTHING_HANGS = "reads like no load|less than 1 %"


class Hanging:
    # Of the scene below.
    GAIN = 2.0
    ZERO = 0.0123
    NOISE = 0.0003

    def __init__(self, test):
        place = tempfile.TemporaryDirectory(prefix="stickslip-")
        test.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.file = self.folder / "hanging"

    def hang(self, mass, swing=0):
        whole = self.folder / "next"
        whole.write_text(f"{mass} {swing}\n", encoding="ascii")
        os.replace(whole, self.file)

    def nothing(self):
        """The scene plays."""
        self.file.unlink(missing_ok=True)


def weighing_board(test, source, calibrations="calibrations", speed=50):
    """For RunningDaemon: a tester whose load cell has a zero of its own, and gain by its data sheet."""
    hanging = test.hanging
    scene = scene_with(source, PATIENT)
    assert scene.count('load_cell_zero = "0 V"') == 1 and f'load_cell_gain = "{hanging.GAIN:g} N/V"' in scene
    own = hanging.folder / "scene.toml"
    assert scene.count("\nsd = 0.001 ") == 1
    own.write_text(scene.replace('load_cell_zero = "0 V"', f'load_cell_zero = "{hanging.ZERO} V"')
                   .replace("\nsd = 0.001 ", f'\nsd_voltage = "{hanging.NOISE} V" '), encoding="utf-8")
    folder = "" if calibrations is None else f'calibration = "{calibrations}"\n'
    return f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["{own}"]
repeats = 0
hanging = "{hanging.file}"
[tester]
load_cell_gain = "1.9 N/V"
{folder}"""

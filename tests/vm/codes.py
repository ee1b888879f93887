"""A/D codes of scenes as `stickslip simulate` makes them, for the virtual tester, and the same scenes as a
configuration of the simulated board."""

import subprocess

import h5py
import numpy

import support

# 350 Hz in the whole nanoseconds that Comedi has.
PERIOD_NS = round(1e9 / 350)
# The double that the Comedi board finds; repr() reads back as the same.
RATE_HZ = 1e9 / PERIOD_NS
SIMULATION_TIMEOUT_S = 60


def scene_file(name):
    return support.SCENES / f"{name}.toml"


def simulate(folder, scene, *options):
    """Codes of the whole scene at the rate of the virtual tester."""
    record = folder / "scene.h5"
    record.unlink(missing_ok=True)
    subprocess.run([support.CLI, "simulate", scene_file(scene), "-o", record, "--rate", f"{RATE_HZ!r} Hz", *options],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=SIMULATION_TIMEOUT_S)
    with h5py.File(record) as file:
        counts = file["entry/raw/counts"][()]
    assert counts.dtype == numpy.uint16
    return counts


def reference_configuration(folder, scenes, records):
    paths = ", ".join(f'"{scene}"' for scene in scenes)
    text = f"""[board]
driver = "simulated"
scan_rate = "{RATE_HZ!r} Hz"
clock_speed = {1 if records.startswith("/results") else 100}
[board.simulated]
scenes = [{paths}]
[record]
folder = "{records}"
"""
    path = folder / "reference.toml"
    path.write_text(text)
    return path


def seeds(folder, scenes):
    """Of the first repetition of each scene on the simulated board: it says so in its records."""
    records = folder / "seeds"
    config = reference_configuration(folder, map(scene_file, scenes), str(records))
    subprocess.run([support.DAEMON, "--config", config], check=True, stderr=subprocess.DEVNULL,
                   timeout=SIMULATION_TIMEOUT_S)
    found = []
    for path in sorted(records.glob("*.h5")):
        with h5py.File(path) as file:
            found.append(int(file["entry/truth/seed"][()]))
    assert len(found) == len(scenes), found
    return found


def write_codes(folder, codes):
    path = folder / "codes.bin"
    path.write_bytes(codes.astype("<u2").tobytes())
    return path


def for_scenes(folder, scenes, rate_error_ppb):
    """Files for the guest, and the codes of all scenes, one after the other."""
    codes = numpy.concatenate([simulate(folder, scene, "--seed", str(seed))
                               for scene, seed in zip(scenes, seeds(folder, scenes))])
    names = folder / "list"
    names.write_text("".join(f"{scene}\n" for scene in scenes))
    error = folder / "rate_error_ppb"
    error.write_text(f"{rate_error_ppb}\n")
    files = {"/lib/firmware/stickslip-codes.bin": write_codes(folder, codes), "/scenes/list": names,
             "/scenes/rate_error_ppb": error,
             "/scenes/reference.toml": reference_configuration(folder, [f"/scenes/{s}.toml" for s in scenes],
                                                               "/results/simulated/records")}
    files.update({f"/scenes/{scene}.toml": scene_file(scene) for scene in scenes})
    return files, codes

"""What is done where there is no record: counts and coefficients into an HDF5 file with h5py, a second at a time.

    h5py_peer.py CODES.u16 RATE RANGE MAXDATA GAIN WEIGHT FLUSH FILE.h5

Reads codes (16 bits, little-endian), makes coefficients of them, appends both each second; FLUSH is `end` or `second`:
then the file is flushed, and what the flush gave to the system is synced, after each. Prints as JSON the time of
all of it, the times of the commits (append, flush, sync; s) and the size of the file.
"""

import json
import os
import sys
import time

import h5py
import numpy


def main(codes_file, rate, volts, maxdata, gain_N_per_V, weight_N, flush, file_name):
    codes = numpy.fromfile(codes_file, dtype="<u2")
    per_second = int(float(rate))
    scale = float(volts) / float(maxdata) * float(gain_N_per_V) / float(weight_N)
    commits_s = []
    begin_s = time.perf_counter()
    with h5py.File(file_name, "w") as file:
        columns = [
            file.create_dataset(name, (0,), dtype, maxshape=(None,), chunks=(max(per_second, 4096),))
            for name, dtype in (("counts", "<u2"), ("coefficient", "<f8"))
        ]
        descriptor = os.open(file_name, os.O_RDONLY)
        for first in range(0, len(codes), per_second):
            some = codes[first : first + per_second]
            values = (some - 0.5 * float(maxdata)) * scale
            before_s = time.perf_counter()
            for column, new in zip(columns, (some, values)):
                column.resize((first + len(some),))
                column[first:] = new
            if flush == "second":
                file.flush()
                os.fdatasync(descriptor)
                commits_s.append(time.perf_counter() - before_s)
    os.fsync(descriptor)
    os.close(descriptor)
    took_s = time.perf_counter() - begin_s
    json.dump({"write_s": took_s, "commits_s": commits_s, "size": os.path.getsize(file_name)}, sys.stdout)


main(*sys.argv[1:])

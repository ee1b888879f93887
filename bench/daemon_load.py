#!/usr/bin/env python3
"""What stickslipd takes of the machine while it tests without a pause: processor time and memory.

    bench/daemon_load.py BUILD_DIR [SECONDS]

Runs the daemon at 350 scans/s on the simulated board, tests of 5.25 s one after the other, for so long (60), and prints
the processor time of its threads as a part of one processor, beside it that of the processes that make the records, its
memory, and for comparison what this machine takes for
a thread that does nothing but wake up 50 and 350 times a second: on virtual machines that is most of it.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

SCENE = pathlib.Path(__file__).resolve().parent.parent / "config/scenes/stick-slip-at-12-in-per-min.toml"


def thread_times_s(process):
    times_s = {}
    for thread in pathlib.Path(f"/proc/{process.pid}/task").iterdir():
        times_s[thread.name] = int((thread / "schedstat").read_text(encoding="ascii").split()[0]) / 1e9
    return times_s


def records_time_s(process):
    """Of the finalisers that have ended: a child's user and system time [proc(5), stat, fields 16 and 17]."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return sum(int(ticks) for ticks in fields[13:15]) / os.sysconf("SC_CLK_TCK")


def sizes_kB(process):
    lines = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8").splitlines()
    return {line.split(":")[0]: int(line.split()[1]) for line in lines if line.endswith(" kB")}


def waking_percent(rate_Hz, seconds):
    """Of a process of its own: sleeps, wakes, sleeps."""
    code = (f"import time\nbegin = time.monotonic()\n"
            f"for i in range(int({rate_Hz} * {seconds})): time.sleep(max(0, begin + i / {rate_Hz} - time.monotonic()))\n"
            "print(int(open('/proc/self/schedstat').read().split()[0]) / 1e9)")
    idle = float(subprocess.run([sys.executable, "-c", "print(int(open('/proc/self/schedstat').read().split()[0]) / 1e9)"],
                                capture_output=True, text=True, check=True).stdout)
    busy = float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    return 100 * (busy - idle) / seconds


def main(build, seconds="60"):
    seconds = float(seconds)
    with tempfile.TemporaryDirectory(prefix="stickslip-load-") as folder:
        config = pathlib.Path(folder) / "load.toml"
        config.write_text(f"""
[board]
driver = "simulated"
[board.simulated]
scenes = ["{SCENE}"]
repeats = 0
[record]
folder = "records"
[log]
level = "warning"
""", encoding="utf-8")
        daemon = pathlib.Path(build).resolve() / "bin/stickslipd"
        with subprocess.Popen([daemon, "--config", config], cwd=folder) as process:
            try:
                time.sleep(2)
                before_s, records_before_s = thread_times_s(process), records_time_s(process)
                begin = time.monotonic()
                time.sleep(seconds)
                after_s, records_after_s = thread_times_s(process), records_time_s(process)
                took_s = time.monotonic() - begin
                memory_kB = sizes_kB(process)
            finally:
                process.terminate()
    used = sorted((100 * (after_s[name] - before_s.get(name, 0)) / took_s for name in after_s), reverse=True)
    print(f"processor  {sum(used):.2f} % of one, over {took_s:.0f} s; its threads {', '.join(f'{part:.2f}' for part in used)} %")
    print(f"records    {100 * (records_after_s - records_before_s) / took_s:.2f} % of one: a process for each test, at its end")
    print(f"memory     {memory_kB['VmRSS'] / 1000:.1f} MB resident, {memory_kB['VmHWM'] / 1000:.1f} MB at most")
    for rate_Hz in (50, 350):
        print(f"waking up {rate_Hz} times a second and nothing else takes {waking_percent(rate_Hz, 8):.2f} %")


main(*sys.argv[1:])

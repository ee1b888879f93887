"""A daemon that plays stick-slip tests without end, and how tests talk to it. Nothing sleeps: each step waits for an
answer or for a frame of the live stream."""

import http.client
import json
import pathlib
import queue
import re
import signal
import socket
import subprocess
import tempfile
import threading

from service_manager import TIMEOUT_S


SCENE = "config/scenes/stick-slip-at-12-in-per-min.toml"


SHIPPED = {"idle": "0.5 s", "pull": "5 s", "rest": "1 s"}
PATIENT = {"idle": "6 s", "pull": "60 s", "rest": "3 s"}  # Several commands fit in each, on a busy machine too.


def seconds(text):
    return float(text.removesuffix(" s"))


def scene_with(source, times):
    """Text of the shipped scene with another idle time, pull and rest."""
    scene = (source / SCENE).read_text(encoding="utf-8")
    for name, shipped in SHIPPED.items():
        line = f'\n{name} = "{shipped}"'
        assert scene.count(line) == 1, line
        scene = scene.replace(line, f'\n{name} = "{times[name]}"')
    return scene


def children(pid):
    """Processes that this one has started and that have not ended: the finalisers of a daemon."""
    try:
        tasks = pathlib.Path(f"/proc/{pid}/task").iterdir()
        return [int(child) for task in tasks for child in (task / "children").read_text().split()]
    except OSError:
        return []


class UnixConnection(http.client.HTTPConnection):
    def __init__(self, path):
        super().__init__("localhost", timeout=TIMEOUT_S)
        self.path = str(path)

    def connect(self):
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(TIMEOUT_S)
        self.sock.connect(self.path)


class RunningDaemon:
    def __init__(self, test, build, source, config="", speed=20, board=None, repeats=0, times=None, prepare=lambda folder: None, program=None, records="records",
                 environment=None, whole=None):
        """times: idle, pull and rest of the tests of the board's scene, which is the shipped one without. records: the folder of records, below that of the daemon. environment: more variables for it. whole: its configuration, which
        names the socket "c.sock", in the place of all of these."""
        self.cli = build / "bin" / "stickslip"
        temporary = tempfile.TemporaryDirectory(prefix="stickslip-")
        test.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.socket = self.folder / "c.sock"
        prepare(self.folder)
        scene = source / SCENE
        self.times = times or SHIPPED
        if times and not (board or whole):
            scene = self.folder / "scene.toml"
            scene.write_text(scene_with(source, times), encoding="utf-8")
        board = board or f"""
[board]
driver = "simulated"
clock_speed = {speed}
[board.simulated]
scenes = ["{scene}"]
repeats = {repeats}
"""
        file = self.folder / "d.toml"
        file.write_text(whole or f'{board}\n[record]\nfolder = "{records}"\n[control]\nsocket = "c.sock"\n{config}', encoding="utf-8")
        self.environment = environment or {}
        self.command = [str(program or build / "bin" / "stickslipd"), "--config", str(file)]
        test.addCleanup(self.end)
        self.start()

    def start(self):
        """Returns when scans come."""
        notify = self.folder / "notify"
        notify.unlink(missing_ok=True)
        manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        manager.bind(str(notify))
        manager.settimeout(TIMEOUT_S)
        self.process = subprocess.Popen(self.command, cwd=self.folder, stderr=subprocess.PIPE, text=True, env={"NOTIFY_SOCKET": str(notify), **self.environment})
        self.log, self.unread = [], queue.Queue()
        self.reader = threading.Thread(target=self.read_log)
        self.reader.start()
        while manager.recv(4096) != b"READY=1":
            pass
        manager.close()  # Notifications that nobody reads would fill it, and the daemon would wait.

    def read_log(self):
        """At once: a pipe that nobody reads fills up, and the daemon would wait for it."""
        for line in self.process.stderr:
            self.log.append(line)
            self.unread.put(line)

    def gone(self):
        self.process.wait(TIMEOUT_S)
        self.reader.join()
        self.process.stderr.close()

    def kill(self):
        """As a power switch does: nothing is put in order."""
        self.process.kill()
        self.gone()

    def end(self):
        """Returns its exit code and its log."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(TIMEOUT_S)
        finally:
            self.process.kill()
            self.gone()
        return self.process.returncode, "".join(self.log)

    def ask(self, method, path, body=None, who="ada", key=None, connection=None, headers=None):
        own = connection or UnixConnection(self.socket)
        sent = {"Stickslip-Controller": who} if who else {}
        if key:
            sent["Idempotency-Key"] = key
        sent.update(headers or {})
        own.request(method, path, body if body is None or isinstance(body, str) else json.dumps(body), sent)
        reply = own.getresponse()
        body = reply.read()
        text = body if reply.headers["Content-Type"] == "application/x-hdf5" else body.decode()
        if connection is None:
            own.close()
        self.reply = reply
        return reply.status, json.loads(text) if reply.headers["Content-Type"] == "application/json" else text

    def run(self, *arguments, environment=None):
        return subprocess.run([str(self.cli), *(str(a) for a in arguments), "--socket", str(self.socket)], capture_output=True, text=True,
                              timeout=TIMEOUT_S, check=False, env=environment)

    def watch(self):
        """Frames of the live stream, as `stickslip watch --json` gives them."""
        process = subprocess.Popen([str(self.cli), "watch", "--json", "--socket", str(self.socket)], stdout=subprocess.PIPE, text=True)
        return process, (json.loads(line) for line in process.stdout)

    def port_line(self):
        """What the log says of the TCP port."""
        while True:
            if found := re.search(r"control: listening at (127\.0\.0\.1:\d+)", self.unread.get(timeout=TIMEOUT_S)):
                return found[1]

    def wait_for_rest(self, frames):
        """Until a rest between two pulls has begun of which a third at least is left, so that a whole pull is to come. Frames that waited to
        be read tell of the past: the status tells how far the scans have come since."""
        idle, rest = (seconds(self.times[name]) for name in ("idle", "rest"))
        loaded, end = False, None  # Of the rest that is under way: its end, in seconds of scans. None: unknown.

        def leaves_time(frame):
            nonlocal loaded, end
            if frame["type"] != "scans":
                return False
            if max(frame["highest"]) >= 0.02:
                loaded, end = True, None
                return False
            first = frame["first_scan"] / frame["scan_rate"]
            if loaded:
                loaded, end = False, first + rest + idle
            elif end is None and first < idle:
                end = idle
            return end is not None and self.ask("GET", "/v1/status")[1]["scan_count"] / frame["scan_rate"] < end - (rest + idle) / 3
        wait_for(frames, leaves_time)

    def record(self, number):
        """The record of a test that has ended: the finaliser may still be at it."""
        process, frames = self.watch()
        try:
            for frame in frames:
                if frame["type"] != "health":
                    continue
                _, test = self.ask("GET", f"/v1/tests/{number}")
                if test["file"]:
                    return self.folder / test["file"]
        finally:
            process.kill()
            process.communicate()


def wait_for(frames, wanted):
    for frame in frames:
        if wanted(frame):
            return frame
    raise AssertionError("the stream ended")

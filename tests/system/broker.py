"""A real Mosquitto on a free port of this machine, and a listener to all that it is told."""

import json
import pathlib
import queue
import shutil
import signal
import socket
import subprocess
import threading

TIMEOUT_S = 120
MOSQUITTO = shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/sbin:/bin")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Broker:
    """Settings: lines of mosquitto.conf. It keeps what is retained over a restart."""

    def __init__(self, test, folder, settings="allow_anonymous true\n", tls=""):
        self.folder = pathlib.Path(folder)
        self.port = free_port()
        self.tls = tls
        self.process = None
        # As root it would become another user, who may not read the test's folder.
        self.file = self.folder / "mosquitto.conf"
        self.file.write_text(f"user root\npersistence true\npersistence_location {self.folder}/\nlistener {self.port} 127.0.0.1\n{tls}{settings}",
                             encoding="utf-8")
        test.addCleanup(self.stop)
        self.start()

    def start(self):
        self.process = subprocess.Popen([MOSQUITTO, "-c", str(self.file)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        log = []
        for line in self.process.stderr:
            log.append(line)
            if re_running(line):
                break
        else:
            raise AssertionError("".join(log))
        # What it says from here on nobody reads.
        threading.Thread(target=self.process.stderr.read, daemon=True).start()

    def stop(self):
        if self.process is not None:
            # Mosquitto forgets a signal that comes between its word that it runs and the beginning of its loop.
            for _ in range(TIMEOUT_S):
                self.process.send_signal(signal.SIGTERM)
                try:
                    self.process.wait(1)
                    break
                except subprocess.TimeoutExpired:
                    continue
            else:
                self.process.kill()
                raise AssertionError("the broker does not end")
            self.process = None


def re_running(line):
    return "running" in line and "mosquitto version" in line


class Listener:
    """mosquitto_sub of Debian's mosquitto-clients: each message as topic, retained, JSON. It has a session that the broker keeps
    while it is away, as docs/fleet.md advises who counts on each result."""

    def __init__(self, test, port, topic="stickslip/#", arguments=()):
        self.process = subprocess.Popen(["stdbuf", "-oL", "mosquitto_sub", "-V", "5", "-h", "127.0.0.1", "-p", str(port), "-t", topic, "-q", "1", "-c", "-i", f"listener-{id(self)}", "-x", "3600", "-F", "%r %q %t %p",
                                         "-d", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.seen = []
        self.queue = queue.Queue()
        self.subscribed = threading.Event()
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()
        test.addCleanup(self.stop)
        if not self.subscribed.wait(TIMEOUT_S):
            raise AssertionError("not subscribed")

    def read(self):
        for line in self.process.stdout:
            if line.startswith("Subscribed"):
                self.subscribed.set()
            parts = line.rstrip("\n").split(" ", 3)
            if len(parts) == 4 and parts[0] in "01" and parts[1] in "012":
                self.queue.put((parts[2], parts[0] == "1", json.loads(parts[3])))

    def wait_for(self, wanted):
        """The messages that came before the one wanted stay in seen."""
        while True:
            message = self.queue.get(timeout=TIMEOUT_S)
            self.seen.append(message)
            if wanted(*message):
                return message

    def wait_for_state(self, tester, state):
        return self.wait_for(lambda topic, _, body: topic == f"stickslip/{tester}/state" and body["state"] == state)

    def results(self, count):
        """So many different tests, and all the messages about them so far."""
        while len({body["entry_identifier_uuid"] for topic, _, body in self.seen if topic.endswith("/result")}) < count:
            self.seen.append(self.queue.get(timeout=TIMEOUT_S))
        return [body for topic, _, body in self.seen if topic.endswith("/result")]

    def stop(self):
        self.process.kill()
        self.process.wait(TIMEOUT_S)

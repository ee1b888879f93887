"""What the service manager does, done by a test: notifications, watchdog, sockets that it opens first."""

import os
import socket
import subprocess

# Generous: under sanitizers on a busy machine everything takes its time.
TIMEOUT_S = 240


class Manager:
    """A datagram socket in a folder that collects notifications."""

    def __init__(self, test, folder):
        self.path = folder / "notify"
        self.path.unlink(missing_ok=True)
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        test.addCleanup(self.socket.close)
        self.socket.bind(str(self.path))
        self.socket.settimeout(TIMEOUT_S)
        self.messages = []

    def start(self, daemon, config, cwd, listening=None, **environment):
        """listening: a socket that the daemon is to find open."""
        command = [str(daemon), "--config", str(config)]
        passed = ()
        if listening:
            # As sd_listen_fds(3) finds it: descriptor 3 of the process with this number.
            command = ["bash", "-c", f'exec 3<&{listening.fileno()}; LISTEN_FDS=1 LISTEN_PID=$$ exec "$@"', "bash", *command]
            passed = (listening.fileno(),)
        return subprocess.Popen(command, cwd=cwd, env=dict(os.environ, NOTIFY_SOCKET=str(self.path), **environment), pass_fds=passed,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def wait_for(self, wanted):
        """Reads notifications until one satisfies wanted(text)."""
        while True:
            self.messages.append(self.socket.recv(4096).decode())
            if wanted(self.messages[-1]):
                return self.messages[-1]

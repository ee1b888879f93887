#!/usr/bin/env python3
"""Every finding of docs/findings.md at a terminal: `stickslip list`, `show`, `watch` and `status` ask a daemon that has them all, played here.

findings_test.py BUILD_DIR SOURCE_DIR [unittest arguments]
"""

import base64
import hashlib
import json
import pathlib
import re
import socketserver
import subprocess
import sys
import tempfile
import threading
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()
TIMEOUT_S = 240

ROWS = re.findall(r"(?m)^\| `([a-z-]+)` \| (\w+) \| .* \| ([^|]+) \|$", (SOURCE / "docs" / "findings.md").read_text(encoding="utf-8"))
FINDINGS = [{"code": code, "severity": severity, "text": f"sentence of {code}", "action": action,
             "numbers": [{"name": "measured", "value": 0.25, "unit": "1"}]} for code, severity, action in ROWS]
BOTH = {"findings": [finding["text"] for finding in FINDINGS], "coded_findings": FINDINGS}
RESULTS = {"regime": "stick-slip", "rung": "none", "details": {}, **BOTH}
TEST = {"number": 1, "cause": "unloaded", "file": "a.h5", "results": RESULTS}
ANSWERS = {"/v1/tests": {"tests": [TEST]}, "/v1/tests/1": TEST, "/v1/status": {"state": "acquiring", **BOTH, "latest_test": None}}
FRAME = {"type": "test-ended", "test": 1, "cause": "unloaded", "results": RESULTS}


class Played(socketserver.StreamRequestHandler):
    def handle(self):
        path = self.rfile.readline().split()[1].decode()
        headers = {}
        while line := self.rfile.readline().strip():
            name, _, value = line.decode().partition(":")
            headers[name.lower()] = value.strip()
        if path == "/v1/live":
            key = headers["sec-websocket-key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # RFC 6455.
            accept = base64.b64encode(hashlib.sha1(key.encode()).digest()).decode()
            self.wfile.write(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n".encode())
            body = json.dumps(FRAME).encode()
            self.wfile.write(b"\x81\x7e" + len(body).to_bytes(2, "big") + body)
            return
        body = json.dumps(ANSWERS[path]).encode()
        self.wfile.write(f"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: {len(body)}\r\nConnection: close\r\n\r\n".encode() + body)


class Terminal(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory(prefix="stickslip-"))
        self.socket = str(pathlib.Path(folder) / "control.sock")
        server = self.enterContext(socketserver.ThreadingUnixStreamServer(self.socket, Played))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.shutdown)

    def printed(self, *words):
        done = subprocess.run([BUILD / "bin" / "stickslip", *words, "--socket", self.socket], capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_text_has_each_sentence_with_what_to_do(self):
        self.assertGreater(len(FINDINGS), 20)
        for words in (["list"], ["show", "1"], ["watch", "--tests", "1"], ["status"]):
            text = self.printed(*words)
            for finding in FINDINGS:
                with self.subTest(command=words[0], code=finding["code"]):
                    self.assertIn(finding["text"], text)
                    self.assertIn(f"→ {finding['code']}, {finding['severity']}: {finding['action']}", text)

    def test_json_has_each_whole(self):
        for words, where in ((["list"], lambda told: told["tests"][0]["results"]), (["show", "1"], lambda told: told["results"]),
                             (["watch", "--tests", "1"], lambda told: told["results"]), (["status"], lambda told: told)):
            self.assertEqual(where(json.loads(self.printed(*words, "--json")))["coded_findings"], FINDINGS, words)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

"""A real browser without a window, driven over the Chrome DevTools protocol by a pair of pipes: nothing but Python's
own library, no port, no network.

    with Chromium("/usr/bin/chromium") as browser:
        page = browser.open(file)
        page.value("document.title")
"""

import base64
import json
import os
import pathlib
import select
import subprocess
import tempfile
import time

# Generous: on a busy machine a browser takes its time to start.
TIMEOUT_S = 300
# And what is waited for in a page.
PATIENCE_S = 200


def may_have_user_namespaces():
    """What the sandbox is made of. In a chroot, for one, nobody may."""
    return subprocess.run(["unshare", "--user", "true"], capture_output=True, check=False).returncode == 0


class Chromium:
    def __init__(self, program):
        self.folder = tempfile.TemporaryDirectory(prefix="stickslip-browser-", ignore_cleanup_errors=True)
        commands_out, self.commands = os.pipe()
        self.answers, answers_in = os.pipe()
        arguments = [program, "--headless=new", "--remote-debugging-pipe", f"--user-data-dir={self.folder.name}/profile",
                     "--no-first-run", "--no-default-browser-check", "--disable-gpu", "--disable-background-networking",
                     "--disable-component-update", "--disable-dev-shm-usage", "--window-size=1280,1600", "--hide-scrollbars",
                     # A page behind another would have no frames and slow timers.
                     "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding", "--disable-background-timer-throttling"]
        if os.geteuid() == 0 or not may_have_user_namespaces():
            arguments.append("--no-sandbox")  # It refuses to run otherwise; the page is our own.
        # The browser reads commands from descriptor 3 and answers on 4.
        shell = f'exec "$@" 3<&{commands_out} 4>&{answers_in}'
        environment = dict(os.environ, HOME=self.folder.name)
        self.process = subprocess.Popen(["bash", "-c", shell, "bash", *arguments], pass_fds=(commands_out, answers_in),
                                        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands_out)
        os.close(answers_in)
        self.buffer = b""
        self.last = 0
        self.events = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
            self.process.wait(TIMEOUT_S)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.commands)
        os.close(self.answers)
        self.folder.cleanup()

    def message(self, deadline):
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.answers], [], [], max(0, deadline - time.monotonic()))
            if not ready:
                raise RuntimeError("the browser does not answer")
            more = os.read(self.answers, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self.buffer += more
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, session=None, **parameters):
        self.last += 1
        command = {"id": self.last, "method": method, "params": parameters}
        if session:
            command["sessionId"] = session
        os.write(self.commands, json.dumps(command).encode() + b"\0")
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            answer = self.message(deadline)
            if answer.get("id") != self.last:
                self.events.append(answer)
                continue
            if "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            return answer["result"]

    def wait_for(self, method, session):
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            for event in self.events:
                if event.get("method") == method and event.get("sessionId") == session:
                    return event["params"]
            self.events.append(self.message(deadline))

    def wait_for_download(self):
        """The next that completes; Browser.setDownloadBehavior with eventsEnabled comes first."""
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            for event in self.events:
                if event.get("method") == "Browser.downloadProgress" and event["params"]["state"] == "completed":
                    self.events.remove(event)
                    return
            self.events.append(self.message(deadline))

    def open(self, file, dark=False):
        """A file, or an address that begins with http:"""
        address = str(file) if str(file).startswith("http:") else pathlib.Path(file).resolve().as_uri()
        page = Page(self, self.call("Target.createTarget", url="about:blank")["targetId"])
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        page.call("Page.navigate", url=address)
        self.wait_for("Page.loadEventFired", page.session)
        page.settle()
        return page

    def windows(self, ending):
        """Of the browser, at addresses that end so."""
        return [target["targetId"] for target in self.call("Target.getTargets")["targetInfos"]
                if target["type"] == "page" and target["url"].endswith(ending)]

    def opened(self, ending):
        """The window that a page has opened."""
        deadline = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline:
            if found := self.windows(ending):
                return Page(self, found[0])
        raise RuntimeError(f"no window at {ending}")


class Page:
    def __init__(self, browser, target):
        self.browser = browser
        self.target = target
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def reload(self):
        self.own_events("Page.loadEventFired")
        self.browser.events = [event for event in self.browser.events
                               if (event.get("sessionId"), event.get("method")) != (self.session, "Page.loadEventFired")]
        self.call("Page.reload")
        self.browser.wait_for("Page.loadEventFired", self.session)
        self.settle()

    def settle(self):
        """Until two frames are painted: uPlot draws before the next one."""
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def value(self, expression):
        """Of a JavaScript expression, as JSON carries it; a promise is waited for."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']['exception'].get('description')}")
        return result["result"].get("value")

    def until(self, condition):
        """Looks again and again until it holds."""
        if not self.value("new Promise(done => { const end = performance.now() + %d, look = () => (%s) ? done(true) : performance.now() < end ?"
                          "setTimeout(look, 20) : done(false); look(); })" % (1000 * PATIENCE_S, condition)):
            raise AssertionError(f"not within {PATIENCE_S} s: {condition}")

    def own_events(self, method):
        self.value("0")  # What was under way has arrived before this answer.
        return [event["params"] for event in self.browser.events
                if event.get("sessionId") == self.session and event.get("method") == method]

    def complaints(self):
        """Uncaught exceptions, and everything logged as an error or a warning."""
        found = [event["exceptionDetails"]["text"] for event in self.own_events("Runtime.exceptionThrown")]
        found += [event["entry"]["text"] for event in self.own_events("Log.entryAdded")
                  if event["entry"]["level"] in ("error", "warning")]
        found += [str(event["args"]) for event in self.own_events("Runtime.consoleAPICalled")
                  if event["type"] in ("error", "warning", "assert")]
        return found

    def requests(self):
        return [event["request"]["url"] for event in self.own_events("Network.requestWillBeSent")]

    def box(self, selector, index=0):
        """(x, y, width, height) in the window, after scrolling it into view."""
        return self.value(f"(() => {{ const e = document.querySelectorAll({json.dumps(selector)})[{index}];"
                          "e.scrollIntoView({block: 'center', behavior: 'instant'}); const r = e.getBoundingClientRect();"
                          "return [r.x, r.y, r.width, r.height]; })()")

    def mouse(self, kind, x, y, clicks=1):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=clicks,
                  buttons=0 if kind == "mouseReleased" else 1)

    def click(self, selector, index=0, times=1):
        x, y, width, height = self.box(selector, index)
        for count in range(1, times + 1):
            self.mouse("mousePressed", x + width / 2, y + height / 2, count)
            self.mouse("mouseReleased", x + width / 2, y + height / 2, count)
        self.settle()

    def drag(self, selector, start, end, index=0):
        """Over parts of its width, half-way down."""
        x, y, width, height = self.box(selector, index)
        middle = y + height / 2
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + start * width, y=middle)
        self.mouse("mousePressed", x + start * width, middle)
        for part in (0.5, 1.0):
            self.mouse("mouseMoved", x + (start + part * (end - start)) * width, middle)
        self.mouse("mouseReleased", x + end * width, middle)
        self.settle()

    def press(self, key, text="", settle=True):
        """\param settle  not where a window opens: a page behind another paints no frames."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, **({"text": text} if text and kind == "keyDown" else {}))
        if settle:
            self.settle()

    def screenshot(self, file, height=None):
        height = height or self.value("Math.ceil(document.documentElement.scrollHeight)")
        picture = self.call("Page.captureScreenshot", captureBeyondViewport=True,
                            clip={"x": 0, "y": 0, "width": 1280, "height": height, "scale": 1})
        pathlib.Path(file).write_bytes(base64.b64decode(picture["data"]))

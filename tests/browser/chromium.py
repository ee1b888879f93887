"""A real browser without a window, driven by playwright-core (driver.mjs) over a pair of pipes: no port, no network.

    with Chromium("/usr/bin/chromium", build) as browser:
        page = browser.open(file)
        page.value("document.title")
"""

import json
import os
import pathlib
import select
import shutil
import subprocess

# Generous: on a busy machine a browser takes its time to start. And what is waited for in a page.
TIMEOUT_S = 300
PATIENCE_S = 200


def may_have_user_namespaces():
    """What the sandbox is made of. In a chroot, for one, nobody may."""
    return subprocess.run(["unshare", "--user", "true"], capture_output=True, check=False).returncode == 0


class Chromium:
    def __init__(self, program, build):
        """build: the build directory; playwright-core lies in it."""
        # As root Chromium refuses to have a sandbox; the page is our own.
        sandbox = os.geteuid() != 0 and may_have_user_namespaces()
        self.process = subprocess.Popen(
            [shutil.which("node"), pathlib.Path(__file__).with_name("driver.mjs"), pathlib.Path(build).resolve() / "playwright-core" / "package",
             program, json.dumps(sandbox), str(1000 * PATIENCE_S)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        try:
            self.process.wait(TIMEOUT_S)
        finally:
            self.process.kill()
            self.process.stdout.close()

    def call(self, do, page=None, **parameters):
        """What driver.mjs answers to a command."""
        self.process.stdin.write(json.dumps({"do": do, "page": page, **parameters}).encode() + b"\n")
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT_S)
        line = self.process.stdout.readline() if ready else b""
        if not line:
            raise RuntimeError("the browser has ended" if ready else "the browser does not answer")
        answer = json.loads(line)
        if "error" in answer:
            raise RuntimeError(f"{do} {parameters}: {answer['error']}")
        return answer["value"]

    def open(self, file, dark=False, touch=False, before=None):
        """A file, or an address that begins with http:; touch: on a tablet, where fingers point; before: JavaScript that runs before the page's own."""
        address = str(file) if str(file).startswith("http:") else pathlib.Path(file).resolve().as_uri()
        page = Page(self, self.call("open", address=address, dark=dark, touch=touch, before=before))
        page.settle()
        page.note_remarks()
        return page

    def opened(self, ending):
        """The window that a page has opened."""
        return Page(self, self.call("opened", ending=ending))

    def save_downloads(self, folder):
        """From now on."""
        self.call("save_downloads", folder=str(folder))

    def wait_for_download(self):
        """The file of the next that completes."""
        return pathlib.Path(self.call("wait_for_download"))


class Page:
    def __init__(self, browser, number):
        self.browser = browser
        self.number = number
        # What a hand did.
        self.clicks = self.keys = 0

    def call(self, do, **parameters):
        return self.browser.call(do, self.number, **parameters)

    def close(self):
        self.call("close")

    def leave(self):
        """As a hand closes a tab: the page hears of it."""
        self.call("leave")

    def reload(self):
        self.call("reload")
        self.settle()

    def settle(self):
        """Until two frames are painted: uPlot draws before the next one."""
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def value(self, expression):
        """Of a JavaScript expression, as JSON carries it; a promise is waited for."""
        return self.call("value", expression=expression)

    def living(self):
        """What lives after a collection of garbage: bytes of JavaScript, nodes and listeners of documents."""
        return self.call("living")

    def until(self, condition):
        """Looks again and again until it holds."""
        self.call("until", condition=condition)

    def note_remarks(self):
        """Of the live page, from now on; for until_said()."""
        self.value("""(() => { window.remarks = []; const line = document.getElementById('message');
          if (line) new MutationObserver(() => window.remarks.push(line.textContent)).observe(line, {childList: true, characterData: true, subtree: true}); })()""")

    def until_said(self, beginning):
        """Until the live page has said so; other remarks may have come over it since."""
        self.until(f"window.remarks.some(remark => remark.startsWith({json.dumps(beginning)}))")

    def complaints(self):
        """Uncaught exceptions, and everything logged as an error or a warning."""
        return self.call("complaints")

    def requests(self):
        return self.call("requests")

    def click(self, selector, index=0, times=1):
        self.clicks += times
        self.call("click", selector=selector, index=index, times=times)
        self.settle()

    def tap(self, selector, index=0):
        """With a finger, on a page opened with touch."""
        self.call("tap", selector=selector, index=index)
        self.settle()

    def like(self, dark):
        """The reader's liking for dark or light changes."""
        self.call("like", dark=dark)
        self.settle()

    def print(self, on=True):
        """Shown as a printer would have it, or as on a screen again."""
        self.call("print", on=on)
        self.settle()

    def pdf(self, file):
        """Printed on A4."""
        self.call("pdf", file=str(file))

    def drag(self, selector, start, end, index=0):
        """Over parts of its width, half-way down."""
        self.call("drag", selector=selector, index=index, start=start, end=end)
        self.settle()

    def wheel(self, selector, at, turn):
        """Over a part of its width, half-way down; turn: pixels, above 0 is down."""
        self.call("wheel", selector=selector, index=0, at=at, turn=turn)
        self.settle()

    def press(self, key, settle=True):
        """settle: not where a window opens, since a page behind another paints no frames."""
        self.keys += 1
        self.call("press", key=key)
        if settle:
            self.settle()

    def type(self, text):
        self.keys += len(text)
        self.call("type", text=text)

    def resize(self, width, height):
        self.call("resize", width=width, height=height)
        self.settle()

    def bring_to_front(self):
        self.call("bring_to_front")

    def screenshot(self, file, height=None):
        """Of all of it, or of so many pixels from its top."""
        self.call("screenshot", file=str(file), height=height)

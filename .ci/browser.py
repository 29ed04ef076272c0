"""A headless Chromium that does what a person would. It needs nothing of Python but itself: the browser is told what to do
through its DevTools protocol, over a pair of pipes."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time


def fail(sentence):
    sys.exit(f"FAILED: {sentence}")


def expect(is_so, sentence):
    if not is_so:
        fail(sentence)


class Browser:
    """A headless Chromium with one page."""

    def __init__(self):
        program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
        expect(program, "there is no Chromium")
        self.folder = tempfile.mkdtemp()
        to_browser, self.to_browser = os.pipe()
        self.from_browser, from_browser = os.pipe()
        # It reads from 3 and writes to 4, whichever numbers the pipes have here.
        command = 'exec "$0" "$@" 3<&%d 4>&%d' % (to_browser, from_browser)
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe"]
        self.process = subprocess.Popen(
            ["bash", "-c", command, program, *options, f"--user-data-dir={self.folder}", "about:blank"],
            pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self.read, self.number, self.session, self.events = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.next_message()
            if answer.get("id") == self.number:
                expect("error" not in answer, f"{method}: {answer.get('error')}")
                return answer["result"]
            self.events.append(answer)

    def next_message(self):
        while b"\0" not in self.read:
            some = os.read(self.from_browser, 1 << 20)
            expect(some, "the browser has gone")
            self.read += some
        message, self.read = self.read.split(b"\0", 1)
        return json.loads(message)

    def ask(self, script):
        answer = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        expect("exceptionDetails" not in answer, f"{script}: {answer.get('exceptionDetails')}")
        return answer["result"].get("value")

    def resize(self, width, height, is_phone=False, is_dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=is_phone)
        self.call("Emulation.setTouchEmulationEnabled", enabled=is_phone)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def open(self, path, is_ready="window.wildfire !== undefined"):
        self.call("Page.navigate", url=path.resolve().as_uri())
        for _ in range(400):
            if self.ask(f"document.readyState === 'complete' && {is_ready}"):
                return self.settle()
            time.sleep(0.025)
        fail(f"{path.name} does not begin: {self.ask('document.body.innerText')}")

    def settle(self):
        """Waits until what was asked for is drawn."""
        self.ask("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))")

    def press(self, key, text=None, modifiers=0):
        for kind in ["keyDown", "keyUp"]:
            written = {"text": text} if text and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, modifiers=modifiers, **written)
        self.settle()

    def mouse(self, kind, at, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def click(self, at):
        self.drag([at])

    def drag(self, way):
        self.mouse("mouseMoved", way[0])
        self.mouse("mousePressed", way[0], button="left", buttons=1, clickCount=1)
        for at in way[1:]:
            self.mouse("mouseMoved", at, button="left", buttons=1)
        self.mouse("mouseReleased", way[-1], button="left", clickCount=1)
        self.settle()

    def touch(self, kind, *fingers):
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(fingers)]
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def screenshot(self, clip=None):
        more = {"clip": {**clip, "scale": 1}, "captureBeyondViewport": True} if clip else {}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **more)["data"])

    def rect(self, selector):
        return self.ask(
            f"(({{x, y, width, height}}) => ({{x: x + scrollX, y: y + scrollY, width, height}}))"
            f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())"
        )

    def text(self, selector):
        return self.ask(f"document.querySelector({json.dumps(selector)}).innerText")

    def close(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

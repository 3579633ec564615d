"""Debian's Firefox, driven by WebDriver BiDi over its own remote debugging port."""

import json
import re
import subprocess
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from websockets.sync.client import ClientConnection, connect

EXECUTABLE = "firefox-esr"
ANSWER_SECONDS = 90.0
"""s to wait for an answer of the browser."""
PAGE_SECONDS = 60.0
"""s to wait for something on the page."""
LISTENING = re.compile(r"WebDriver BiDi listening on (ws://\S+)")
MOVES = 20
"""Moves of the pointer, which follows a button, before the button counts as restless."""
PREFERENCES = {
    # No proxy is there, and none is asked for the loopback: nothing else can be reached.
    "network.proxy.type": 1,
    "network.proxy.http": "127.0.0.1",
    "network.proxy.http_port": 9,
    "network.proxy.ssl": "127.0.0.1",
    "network.proxy.ssl_port": 9,
}
_STAYS = """async (one) => {
    const place = () => JSON.stringify(one?.getBoundingClientRect());
    const before = place();
    for (let frame = 0; frame < 3; frame += 1) await new Promise((done) => requestAnimationFrame(done));
    return place() === before && one?.matches(':hover');
}"""
"""JavaScript that tells of a button whether it stands still, and the pointer is on it: drawers slide in."""


class Firefox:
    """A headless Firefox with one page, its profile in `folder`; `complaints` are errors in its console."""

    def __init__(self, folder: Path) -> None:
        self.complaints: list[str] = []
        self._numbers = count(1)
        lines = (
            f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in PREFERENCES.items()
        )
        (folder / "user.js").write_text("\n".join(lines))
        profile = ["--profile", str(folder)]
        self._process = subprocess.Popen(
            [EXECUTABLE, "--headless", "--no-remote", *profile, "--remote-debugging-port", "0"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._socket = self._connect()

    def __enter__(self) -> Self:
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded"])
        (page,) = self.call("browsingContext.getTree")["contexts"]
        self._page = page["context"]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.close()
        self._process.terminate()
        self._process.communicate(timeout=ANSWER_SECONDS)

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """Return the result of a BiDi command; errors that the console shows meanwhile become complaints."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while True:
            message = json.loads(self._socket.recv(timeout=ANSWER_SECONDS))
            if message.get("method") == "log.entryAdded" and message["params"]["level"] == "error":
                self.complaints.append(str(message["params"]["text"]))
            if message.get("id") == number:
                assert message["type"] == "success", message
                return dict(message["result"])

    def open(self, url: str) -> None:
        """Load a page."""
        self.call("browsingContext.navigate", context=self._page, url=url, wait="complete")

    def evaluate(self, expression: str) -> dict[str, Any]:
        """Return the value of a JavaScript expression, or of its promise, with its type."""
        answer = self.call(
            "script.evaluate", expression=expression, target={"context": self._page}, awaitPromise=True
        )
        return dict(answer["result"])

    def wait_for(self, expression: str) -> None:
        """Wait until a JavaScript expression holds in the page; it is asked for at each frame.

        Where it never does, the failure shows the page's text.
        """
        shown = self.evaluate(f"""new Promise((done) => {{
            const began = performance.now();
            const look = () => {{
                if ({expression}) done(null);
                else if (performance.now() - began > {1000 * PAGE_SECONDS}) done(document.body.innerText);
                else requestAnimationFrame(look);
            }};
            look();
        }})""")
        assert shown["type"] == "null", f"not seen: {expression}; the page shows: {shown['value']}"

    def move_to_button(self, name: str) -> None:
        """Put the pointer on a button, follow it where the page moves it; wait until it may be pressed."""
        # Not by its role: that starts Firefox's accessibility engine, which takes the computer for seconds.
        named = f"[...document.querySelectorAll('button')].filter((one) => one.innerText.trim() === '{name}')"
        self.wait_for(f"{named}.length === 1")
        origin = {"type": "element", "element": {"sharedId": self.evaluate(f"{named}[0]")["sharedId"]}}
        for _ in range(MOVES):
            self._act("pointer", {"type": "pointerMove", "x": 0, "y": 0, "origin": origin})
            self.wait_for(f"{named}[0]?.ariaDisabled !== 'true'")
            if self.evaluate(f"({_STAYS})({named}[0])").get("value") is True:
                return
        raise AssertionError(f"{name} does not stay where it is")

    def press_mouse(self) -> None:
        """Press the first button of the mouse where it is."""
        self._act("pointer", {"type": "pointerDown", "button": 0})

    def release_mouse(self) -> None:
        """Release the first button of the mouse."""
        self._act("pointer", {"type": "pointerUp", "button": 0})

    def click(self) -> None:
        """Press and release the first button of the mouse where it is."""
        self.press_mouse()
        self.release_mouse()

    def press_key(self, key: str) -> None:
        """Press and release a key, by its WebDriver code."""
        self._act("key", {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key})

    def _connect(self) -> ClientConnection:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            if address := LISTENING.search(line):
                return connect(f"{address[1]}/session", max_size=None, legacy=True)
        raise AssertionError("Firefox ended before it could be reached")

    def _act(self, kind: str, *actions: dict[str, Any]) -> None:
        source = {"type": kind, "id": kind, "actions": list(actions)}
        self.call("input.performActions", context=self._page, actions=[source])

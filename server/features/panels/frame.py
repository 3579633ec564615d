"""The page in which one's own panels run: an origin of its own, without network, and with nothing to command.

Its policy counts twice, as its header and through the `sandbox` of the page's iframe, so that it holds where
somebody opens the address by itself, too.
"""

from base64 import b64encode
from hashlib import sha256
from importlib.resources import files

from fastapi.responses import HTMLResponse

_SCRIPT = (files("server.features.panels") / "frame.js").read_text(encoding="utf-8")
_STYLE = (files("server.features.panels") / "frame.css").read_text(encoding="utf-8")

FRAME = (
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>Panel</title>'
    f"<style>{_STYLE}</style><body><script>{_SCRIPT}</script></body></html>"
)
POLICY = (
    "sandbox allow-scripts; default-src 'none'; "
    f"script-src 'sha256-{b64encode(sha256(_SCRIPT.encode()).digest()).decode()}' blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'"
)


def respond() -> HTMLResponse:
    """The frame, as its own policy wants it."""
    headers = {
        "content-security-policy": POLICY,
        "x-frame-options": "SAMEORIGIN",
        "cache-control": "no-cache",
    }
    return HTMLResponse(FRAME, headers=headers)

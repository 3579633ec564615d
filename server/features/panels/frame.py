"""The frame that runs your own panels: a page with an origin of its own, without requests or commands.

Its policy is set twice: by its header and by the `sandbox` of the page's iframe. So it also holds if somebody
opens the address directly.
"""

from base64 import b64encode
from hashlib import sha256
from importlib.resources import files

_SCRIPT = (files("server.features.panels") / "frame.js").read_text(encoding="utf-8")
_STYLE = (files("server.features.panels") / "frame.css").read_text(encoding="utf-8")

FRAME = (
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>Panel</title>'
    f"<style>{_STYLE}</style><body><script>{_SCRIPT}</script></body></html>"
)
HEADERS = {
    "content-security-policy": "sandbox allow-scripts; default-src 'none'; "
    f"script-src 'sha256-{b64encode(sha256(_SCRIPT.encode()).digest()).decode()}' blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'",
    "x-frame-options": "SAMEORIGIN",
    "cache-control": "no-cache",
}

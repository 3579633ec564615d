"""Requests from a shell to the running server: only the server may write its database."""

import json
import logging
import urllib.error
import urllib.request
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

from robot_runtime.durable_files import write_whole
from server.platform.certificate import trust_only
from server.platform.folder_lock import FolderInUseError, claim
from server.platform.settings import DataFolder, Settings, SetupError

log = logging.getLogger(__name__)

ASK_SECONDS = 10.0


def announce(settings: Settings) -> None:
    """Write the server's address into its data folder.

    Where that fails, as on a full disk, the server runs all the same: the last server's address is there.
    """
    host = "127.0.0.1" if settings.server.host in ("0.0.0.0", "::") else settings.server.host
    host = f"[{host}]" if ":" in host else host
    try:
        write_whole(
            settings.data.address, f"{settings.scheme}://{host}:{settings.server.port}\n".encode("ascii")
        )
    except OSError as problem:
        log.warning("commands in a shell may not find this server: its address is not written: %s", problem)


def server_runs(folder: DataFolder) -> bool:
    """Return True while a server uses this folder. Raise SetupError where the folder cannot be used."""
    if not folder.path.is_dir():
        return False
    try:
        with claim(folder):
            return False
    except FolderInUseError:
        return True


def ask(
    folder: DataFolder,
    method: str,
    path: str,
    body: Mapping[str, Any] | None = None,
    seconds: float = ASK_SECONDS,
) -> Any:
    """Return the server's answer to a request below /api; None where it is empty.

    Raise SetupError where none runs, or with the server's reason where it refuses.
    """
    data = b"" if body is None and method == "POST" else None
    if body is not None:
        data = json.dumps(body).encode()
    return _send(folder, method, path, data, {"content-type": "application/json"}, seconds)


def fetch(folder: DataFolder, path: str, seconds: float = ASK_SECONDS) -> bytes:
    """Return the server's answer to a request for a file below /api. Raise SetupError as `ask`."""
    return _send_for_bytes(folder, "GET", path, None, {}, seconds)


def send_file(folder: DataFolder, path: str, file: Path, seconds: float) -> Any:
    """Return the server's answer to a posted file. Raise SetupError as `ask`, OSError."""
    with file.open("rb") as body:
        headers = {"content-type": "application/zip", "content-length": str(file.stat().st_size)}
        return _send(folder, "POST", path, body, headers, seconds)


def _send(
    folder: DataFolder,
    method: str,
    path: str,
    body: bytes | IO[bytes] | None,
    headers: dict[str, str],
    seconds: float,
) -> Any:
    text = _send_for_bytes(folder, method, path, body, headers, seconds)
    return json.loads(text) if text else None


def _send_for_bytes(
    folder: DataFolder,
    method: str,
    path: str,
    body: bytes | IO[bytes] | None,
    headers: dict[str, str],
    seconds: float,
) -> bytes:
    try:
        address = folder.address.read_text(encoding="ascii").strip()
        headers["authorization"] = f"Bearer {folder.token.read_text(encoding='ascii').strip()}"
    except OSError as problem:
        raise SetupError(f"No server works on {folder.path}. Start one with `mucat run`.") from problem
    request = urllib.request.Request(f"{address}/api{path}", body, headers, method=method)
    # No proxy for a server on this computer.
    handlers: list[urllib.request.BaseHandler] = [urllib.request.ProxyHandler({})]
    if address.startswith("https:"):
        handlers.append(urllib.request.HTTPSHandler(context=trust_only(folder)))
    opener = urllib.request.build_opener(*handlers)
    try:
        with opener.open(request, timeout=seconds) as answer:
            content: bytes = answer.read()
    except urllib.error.HTTPError as problem:
        raise SetupError(_detail(problem)) from problem
    except OSError as problem:
        raise SetupError(
            f"The server of {folder.path} does not answer at {address}: {problem}. Start it with `mucat run`."
        ) from problem
    return content


def _detail(problem: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(problem)["detail"])
    except (ValueError, KeyError, TypeError):
        return f"The server refused with status {problem.code}, and gave no reason."

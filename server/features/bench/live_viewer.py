"""A program at the live socket that reads all rows and documents, and counts them."""

import json
import threading
from contextlib import suppress
from types import TracebackType
from typing import Self

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from server.platform.certificate import trust_only
from server.platform.settings import DataFolder


class LiveViewer:
    """A viewer of the server that uses this folder; within the context it is connected."""

    def __init__(self, folder: DataFolder) -> None:
        self.bytes = 0
        self.left_out = 0
        """Messages that say that samples were left out."""
        url = folder.address.read_text(encoding="ascii").strip()
        token = folder.token.read_text(encoding="ascii").strip()
        self._socket = connect(
            f"{url.replace('http', 'ws', 1)}/api/live",
            ssl=trust_only(folder) if url.startswith("https:") else None,
            additional_headers={"Authorization": f"Bearer {token}"},
            max_size=None,
            proxy=None,
        )
        self._thread = threading.Thread(target=self._read, daemon=True)

    def __enter__(self) -> Self:
        self._socket.__enter__()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.__exit__(kind, value, trace)
        self._thread.join()

    def _read(self) -> None:
        with suppress(ConnectionClosed):
            for message in self._socket:
                self.bytes += len(message)
                self.left_out += isinstance(message, str) and json.loads(message).get("op") == "dropped"

"""The plug of the identification."""

from server.feature import Plug
from server.features.identification.runner import IdentificationRunner


class IdentificationPlug(Plug):
    """The plug that ends a run with the server."""

    def __init__(self, runner: IdentificationRunner) -> None:
        self._runner = runner

    async def stop(self) -> None:
        """Cancel the running work."""
        await self._runner.close()

"""The section [server] of robot.toml."""

from dataclasses import dataclass, field
from typing import Annotated

from robot_runtime.contract.limits import Range
from server.platform.reverse_proxy import Network, read_proxies, read_public_url


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerConfig:
    """The web server: its address, the host names that browsers may use, TLS, and the proxy before it."""

    host: str = "127.0.0.1"
    port: Annotated[int, Range(1, 65535)] = 8000
    allowed_hosts: list[str] = field(default_factory=lambda: ["localhost", "127.0.0.1", "[::1]"])
    tls: bool = False
    public_url: str = ""
    trusted_proxies: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        # Both are read once so that a wrong one is refused with the file.
        read_public_url(self.public_url)
        read_proxies(self.trusted_proxies)

    @property
    def origin(self) -> str:
        """`public_url` as browsers write an origin; empty without a reverse proxy."""
        return read_public_url(self.public_url)

    @property
    def proxies(self) -> tuple[Network, ...]:
        """The networks whose X-Forwarded-For is believed."""
        return read_proxies(self.trusted_proxies)

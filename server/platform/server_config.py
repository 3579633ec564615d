"""The section [server] of robot.toml."""

from dataclasses import dataclass, field
from typing import Annotated

from robot_runtime.contract.limits import Range


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerConfig:
    """The web server: its address, the host names that browsers may use, TLS, and the proxy before it."""

    host: str = "127.0.0.1"
    port: Annotated[int, Range(1, 65535)] = 8000
    allowed_hosts: list[str] = field(default_factory=lambda: ["localhost", "127.0.0.1", "[::1]"])
    tls: bool = False
    public_url: str = ""
    trusted_proxies: list[str] = field(default_factory=list)

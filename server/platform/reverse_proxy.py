"""The settings for a reverse proxy: the address that people open, and the proxies that are trusted."""

from collections.abc import Sequence
from ipaddress import IPv4Network, IPv6Network, ip_network
from urllib.parse import urlsplit

Network = IPv4Network | IPv6Network


def read_public_url(text: str) -> str:
    """Return `server.public_url` as browsers write an origin; empty if there is none. Raise ValueError."""
    if not text:
        return ""
    try:
        parts = urlsplit(text)
        port = parts.port
    except ValueError as problem:
        raise ValueError(f"public_url is {text!r}, which is no address: {problem}") from problem
    if parts.scheme not in ("http", "https") or not parts.hostname or "@" in parts.netloc:
        raise ValueError(f'public_url is {text!r}; write it like "https://robots.lab"')
    if parts.path not in ("", "/") or parts.query or parts.fragment:
        raise ValueError(
            f"public_url is {text!r}, which has a path. The page needs a name of its own: use one "
            'like "https://turtle.robots.lab", and have the proxy pass on everything of it'
        )
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    usual = {"http": 80, "https": 443}[parts.scheme]
    return f"{parts.scheme}://{host}" + (f":{port}" if port not in (None, usual) else "")


def read_proxies(names: Sequence[str]) -> tuple[Network, ...]:
    """Return `server.trusted_proxies`: networks, with an address as a network of one. Raise ValueError."""
    networks = []
    for name in names:
        try:
            network = ip_network(name)
        except ValueError as problem:
            raise ValueError(
                f"trusted_proxies has {name!r}, which is no address or network: {problem}. "
                'Write it like "127.0.0.1" or "10.0.0.0/24"'
            ) from problem
        if network.prefixlen == 0:
            raise ValueError(
                f"trusted_proxies has {name!r}, which is everybody: each client could say "
                "then that it is another. Name the proxy alone"
            )
        networks.append(network)
    return tuple(networks)

"""Goodput of the link as a share of the wire's capacity, both ways at once, on a simulated line."""

from tests.runtime.link.line import goodput

_BAUDS = (1200, 9600, 115_200, 250_000)
_PAYLOADS = (6, 18)
_NOISY_BAUD = 115_200


def measure() -> dict[str, float]:
    """Return the slower direction's payload bytes as a share of baud/10; nothing is lost or doubled."""
    figures = {f"link.goodput.{baud}.{size}": goodput(baud, size) for baud in _BAUDS for size in _PAYLOADS}
    figures["link.goodput_ber_1e-4"] = goodput(_NOISY_BAUD, 18, 1e-4)
    figures["link.goodput_ber_1e-3"] = goodput(_NOISY_BAUD, 18, 1e-3)
    return figures

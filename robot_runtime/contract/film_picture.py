"""One picture of a film, as it is sent and stored."""

_START = b"\0\0\1"
_JPEG = b"\xff\xd8"
_SLICE, _KEY_SLICE, _SEQUENCE = 1, 5, 7
"""Types of H.264's units (ITU-T H.264, table 7-1): a picture that builds on others, one that does not, and
what a decoder needs first."""


class FilmPicture(bytes):
    """An access unit of H.264 with start codes (ITU-T H.264, Annex B), or a JPEG file.

    A key picture of H.264 has its parameter sets with it.
    """

    __slots__ = ()

    @property
    def is_jpeg(self) -> bool:
        """True where it is a JPEG file."""
        return self.startswith(_JPEG)

    @property
    def is_key(self) -> bool:
        """True where it can be shown without the pictures before it."""
        return self.is_jpeg or _KEY_SLICE in self._units

    @property
    def codec(self) -> str:
        """The coding as browsers name it, such as "avc1.42c016" (RFC 6381); of a key picture alone."""
        if self.is_jpeg:
            return "mjpeg"
        start = self.find(_START) + len(_START)
        if not self.is_key or self[start] & 31 != _SEQUENCE:
            return ""
        return f"avc1.{self[start + 1 : start + 4].hex()}"

    @property
    def _units(self) -> list[int]:
        """Types of its units up to the first slice."""
        types, at = list[int](), self.find(_START)
        while 0 <= at < len(self) - len(_START):
            types.append(self[at + len(_START)] & 31)
            if types[-1] in (_SLICE, _KEY_SLICE):
                break
            at = self.find(_START, at + len(_START))
        return types

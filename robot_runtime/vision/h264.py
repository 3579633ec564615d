"""H.264 by x264 (PyAV): each picture is coded at once, so a film that is cut off ends with its last one."""

from fractions import Fraction
from math import inf

import av
from av.video.frame import PictureType

KEY_SECONDS = 1.0
"""s between two pictures that can be shown without those before them, with which playing can begin."""
MICROSECONDS = 1_000_000


class H264Coder:
    """A coder of pictures of one size, width and height, at about `rate` Hz; `crf` is x264's rate factor."""

    def __init__(self, rate: float, crf: int, size: tuple[int, int]) -> None:
        # 4:2:0 has one colour for two by two pixels.
        self.size = (size[0] // 2 * 2, size[1] // 2 * 2)
        self._key_due = -inf
        coder = av.CodecContext.create("libx264", "w")
        assert isinstance(coder, av.VideoCodecContext)
        coder.width, coder.height = self.size
        coder.pix_fmt = "yuv420p"
        coder.time_base = Fraction(1, MICROSECONDS)
        coder.framerate = Fraction(max(1, round(rate)), 1)
        # More threads would hold pictures back.
        coder.thread_count = 1
        coder.options = {
            "preset": "ultrafast",
            "tune": "zerolatency",
            "crf": str(crf),
            "forced-idr": "1",
            "x264-params": "repeat-headers=1:keyint=infinite:scenecut=0",
        }
        self._coder = coder

    def code(self, time: float, frame: av.VideoFrame) -> bytes:
        """Return the picture of this time (s) as one access unit; it is scaled where its size is another."""
        if (frame.width, frame.height) != self.size:
            frame = frame.reformat(*self.size)
        frame.pts, frame.time_base = round(time * MICROSECONDS), Fraction(1, MICROSECONDS)
        is_key = time >= self._key_due
        if is_key:
            self._key_due = time + KEY_SECONDS
        frame.pict_type = PictureType.I if is_key else PictureType.NONE
        return b"".join(bytes(packet) for packet in self._coder.encode(frame))

"""The size of words as this computer's programs see it: its kernel may have 64 bits where they have 32."""

import struct

BITS = 8 * struct.calcsize("P")

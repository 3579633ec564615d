"""The word size of this computer's programs: the kernel may have 64 bits where they have 32."""

import struct

BITS = 8 * struct.calcsize("P")

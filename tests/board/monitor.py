"""The test's side of the sketch `monitor`."""

import struct

from tests.board.rig import BoardRig

TICK = 0.5e-6
"""s."""
ACKNOWLEDGED_ADDRESS, REFUSED_ADDRESS = 0x18, 0x20
REFUSED_READ_ADDRESS = 0x48
ACKNOWLEDGED_DATA, REFUSED_DATA = 0x28, 0x30
ARBITRATION_LOST = 0x38
LAST_DATA = 0x58


class SerialMonitor:
    """Commands the sketch; each command takes a little emulated time."""

    def __init__(self, rig: BoardRig) -> None:
        self._rig = rig

    def boot(self) -> int:
        """Start the board; return the reset cause as in MCUSR."""
        self._rig.board.run(0.002)
        output = self._rig.port.read()
        assert len(output) == 2, output
        assert output[:1] == b"R"
        return output[1]

    def transfer(self, address: int, out: bytes = b"", count: int = 0) -> tuple[int, float, bytes]:
        """Write and then read on I2C: the last status, the duration (s), and what was read."""
        answer = self._ask(b"T" + bytes([address, len(out)]) + out + bytes([count]), 3 + count)
        status, ticks = struct.unpack_from("<BH", answer)
        return status, ticks * TICK, answer[3:]

    def set_bit_rate(self, twbr: int) -> None:
        """Choose the I2C clock."""
        self._ask(b"t" + bytes([twbr]), 0)

    def encoder(self, number: int) -> tuple[float, int]:
        """Return the duration of three bytes on SPI (s), and the word without its leading one."""
        duration, bits = self.encoder_bits(number)
        assert bits >> 23 == 1
        return duration, bits >> 7 & 0xFFFF

    def encoder_bits(self, number: int) -> tuple[float, int]:
        """Return the duration of three bytes on SPI (s), and their bits."""
        answer = self._ask(b"S" + bytes([number]), 5)
        (ticks,) = struct.unpack_from("<H", answer)
        return ticks * TICK, int.from_bytes(answer[2:], "big")

    def set_spi_mode(self, clock_rests_high: bool, second_edge: bool) -> None:
        """Choose polarity and phase of the SPI clock."""
        self._ask(b"M" + bytes([8 * clock_rests_high + 4 * second_edge]), 0)

    def adc(self, channel: int) -> int:
        """Return counts of 1023."""
        return int.from_bytes(self._ask(b"A" + bytes([channel]), 2), "little")

    def write_eeprom(self, address: int, value: int) -> float:
        """Return the duration (s)."""
        return int.from_bytes(self._ask(b"E" + bytes([address, value]), 2), "little") * TICK

    def read_eeprom(self, address: int) -> int:
        return self._ask(b"e" + bytes([address]), 1)[0]

    def flood(self) -> float:
        """Return the duration (s) of sending 16 bytes."""
        answer = self._ask(b"F", 18)
        return int.from_bytes(answer[16:], "little") * TICK

    def phase_correct_period(self) -> float:
        """Return the duration (s) between two overflows of an 8-bit timer at 2 MHz in phase-correct PWM."""
        return int.from_bytes(self._ask(b"P", 2), "little") * TICK

    def fill_memory(self) -> None:
        """Fill memory that no reset clears."""
        self._ask(b"W", 0)

    def memory_lost(self) -> float:
        """Share of that memory that has changed since."""
        return int.from_bytes(self._ask(b"w", 2), "little") / 512

    def outputs(self, port_c: int) -> None:
        self._ask(b"O" + bytes([port_c]), 0)

    def inputs(self) -> int:
        """PIND."""
        return self._ask(b"I", 1)[0]

    def _ask(self, command: bytes, count: int) -> bytes:
        output = self._rig.exchange(command, 0.02)
        assert len(output) == count, (command, output)
        return output

"""The firmware that a board had before an upload: read from the board, stored without the boot loader."""

from pathlib import Path
from typing import Literal

from robot_runtime.durable_files import write_whole

BOOT_LOADER = 0x7E00
"""Flash address from which the ATmega328P's boot loader lies (512 B): it must not be written by itself."""
_ERASED = 0xFF
BoardContent = Literal["empty", "same", "other"]
"""The program on a board: none, as on a new one; the firmware that was built; another."""
_LINE_BYTES = 16


class HexFileError(ValueError):
    """A file is no Intel HEX file of an ATmega328P; the text says why."""


def read_program(path: Path) -> bytes:
    """Return the program in an Intel HEX file from address 0 on, without boot loader and erased end.

    Raise HexFileError, and OSError.
    """
    memory = bytearray([_ERASED]) * BOOT_LOADER
    for number, line in enumerate(path.read_text(encoding="ascii", errors="replace").split(), start=1):
        try:
            record = bytes.fromhex(line.removeprefix(":"))
        except ValueError:
            record = b""
        if len(record) < 5 or len(record) != record[0] + 5 or sum(record) % 256:
            raise HexFileError(f"{path} is damaged in line {number}")
        address, kind, data = int.from_bytes(record[1:3], "big"), record[3], record[4:-1]
        if kind == 0 and address < BOOT_LOADER:
            memory[address : address + len(data)] = data
    return bytes(memory[:BOOT_LOADER]).rstrip(bytes([_ERASED]))


def write_program(program: bytes, path: Path) -> None:
    """Write a program as an Intel HEX file, durably. Raise OSError."""
    lines = []
    for address in range(0, len(program), _LINE_BYTES):
        data = program[address : address + _LINE_BYTES]
        record = bytes([len(data)]) + address.to_bytes(2, "big") + b"\0" + data
        lines.append(_write_record(record))
    lines.append(_write_record(b"\0\0\0\1"))
    write_whole(path, "".join(lines).encode())


def _write_record(record: bytes) -> str:
    return f":{record.hex().upper()}{-sum(record) % 256:02X}\n"


def store_if_other(read: Path, built: Path, previous: Path) -> BoardContent:
    """Store the firmware read from the board, unless it is the built one or none; return the case.

    So a second upload does not replace the older firmware by the newer one. Raise HexFileError, and OSError.
    """
    program = read_program(read)
    if not program:
        return "empty"
    # The boot loader leaves the end of a longer program behind that was there before.
    if program.startswith(read_program(built)):
        return "same"
    write_program(program, previous)
    return "other"

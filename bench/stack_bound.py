"""Upper bound of the stack of a program for the ATmega328P, from the instructions of its ELF file.

It follows every path of every function, so that it has library functions in assembler, and what link-time
optimization makes of the source. What it cannot follow is an error, never a smaller bound: recursion,
pointers to functions, a computed stack pointer.

`python3 bench/stack_bound.py robot.elf` checks the memory of a program: the firmware's Makefile runs it after
every link.
"""

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

RAM_BYTES = 2048
"""Of the chip."""
MARGIN_MIN = 100
"""Bytes of memory that static data and the deepest stack leave free."""
VECTORS = 26
_SECTIONS_IN_RAM = (".data", ".bss", ".noinit")
_VECTOR_BYTES = 4
_RETURN_ADDRESS = 2
_DEPTHS_MAX = 8
"""Different depths at one instruction; more are a loop that pushes."""
_LINE = re.compile(r"^\s*([0-9a-f]+):\t((?:[0-9a-f]{2} )+)\s*\t(\S+)(?:\t([^;]*))?(?:;(.*))?$")
_SYMBOL = re.compile(r"^([0-9a-f]+) <(.+)>:$")
_TARGET = re.compile(r"0x([0-9a-f]+)")
_SKIPS = {"cpse", "sbrc", "sbrs", "sbic", "sbis"}
_FRAME_WRITES = {
    "ldi",
    "mov",
    "movw",
    "pop",
    "add",
    "adc",
    "ld",
    "ldd",
    "lds",
    "lpm",
    "in",
    "com",
    "neg",
    "inc",
    "dec",
}


class StackBoundError(Exception):
    """The stack has no bound that this module can find; the text says where and why."""


class Instruction(NamedTuple):
    """A decoded instruction."""

    size: int
    name: str
    operands: tuple[str, ...]
    target: int | None


class _State(NamedTuple):
    depth: int
    """Bytes on the stack since the function's entry."""
    frame: int | None
    """Depth to which the frame pointer Y points; None: anywhere."""


class _Program:
    """The instructions and symbols of a program."""

    def __init__(self, elf: Path) -> None:
        listing = subprocess.run(["avr-objdump", "-d", str(elf)], capture_output=True, text=True, check=True)
        self.code: dict[int, Instruction] = {}
        self.names: dict[int, str] = {}
        for line in listing.stdout.splitlines():
            if symbol := _SYMBOL.match(line):
                self.names[int(symbol[1], 16)] = symbol[2]
            elif match := _LINE.match(line):
                address, data, name, operands, comment = match.groups()
                parts = tuple(part.strip() for part in (operands or "").split(",") if part.strip())
                target = _TARGET.search(comment or "")
                self.code[int(address, 16)] = Instruction(
                    len(data.split()), name, parts, int(target[1], 16) if target else None
                )
        self.constructors = self._read_constructors(elf)

    def find(self, name: str) -> int | None:
        """Return the address of this symbol."""
        return next((address for address, symbol in self.names.items() if symbol == name), None)

    def locate(self, address: int) -> str:
        """Return the function at an address, and the address."""
        starts = [start for start in self.names if start <= address]
        return f"{self.names[max(starts)] if starts else '?'} at 0x{address:x}"

    def _read_constructors(self, elf: Path) -> list[int]:
        start, end = self._table("__ctors_start", elf), self._table("__ctors_end", elf)
        if start == end:
            return []
        instructions = [self.code[at] for at in range(start, end, 2) if at in self.code]
        if len(instructions) * 2 != end - start:
            raise StackBoundError("the table of constructors cannot be read")
        raw = subprocess.run(
            ["avr-objdump", "-s", f"--start-address={start}", f"--stop-address={end}", str(elf)],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        data = b"".join(
            bytes.fromhex("".join(line.split()[1:5])[: 2 * (end - start)])
            for line in raw.splitlines()
            if re.match(r"^ [0-9a-f]{4,} ", line)
        )
        return [2 * int.from_bytes(data[at : at + 2], "little") for at in range(0, end - start, 2)]

    def _table(self, name: str, elf: Path) -> int:
        symbols = subprocess.run(["avr-nm", str(elf)], capture_output=True, text=True, check=True).stdout
        return next(
            (int(line.split()[0], 16) for line in symbols.splitlines() if line.split()[-1] == name), 0
        )


class _Bound:
    """The deepest stack of each function."""

    def __init__(self, program: _Program) -> None:
        self._program = program
        self._depths: dict[int, int] = {}
        self._open: list[int] = []

    def of(self, entry: int) -> int:
        """Return the bytes below the function's return address. Raise StackBoundError."""
        if entry in self._depths:
            return self._depths[entry]
        if entry in self._open:
            chain = [*self._open[self._open.index(entry) :], entry]
            names = [self._program.locate(address) for address in chain]
            raise StackBoundError(f"functions that call each other: {' -> '.join(names)}")
        self._open.append(entry)
        deepest = self._follow(entry)
        self._open.pop()
        self._depths[entry] = deepest
        return deepest

    def _follow(self, entry: int) -> int:
        deepest = 0
        waiting = [(entry, _State(0, None))]
        seen: dict[int, set[_State]] = {}
        while waiting:
            address, state = waiting.pop()
            states = seen.setdefault(address, set())
            if state in states:
                continue
            states.add(state)
            if len({state.depth for state in states}) > _DEPTHS_MAX:
                raise StackBoundError(f"a loop pushes: {self._program.locate(address)}")
            after, below, ways = self._step(address, state)
            deepest = max(deepest, state.depth, after.depth, state.depth + below)
            waiting += [(way, after) for way in ways]
        return deepest

    def _step(self, address: int, state: _State) -> tuple[_State, int, list[int]]:
        """Return the state after an instruction, the bytes that a call in it takes, and where it goes on."""
        instruction = self._program.code.get(address)
        if instruction is None:
            raise StackBoundError(f"no instruction: {self._program.locate(address)}")
        following = address + instruction.size
        name = instruction.name
        if name in ("ret", "reti"):
            if state.depth:
                raise StackBoundError(f"{state.depth} bytes are left: {self._program.locate(address)}")
            return state, 0, []
        if name in ("call", "rcall"):
            if instruction.target is None:
                raise StackBoundError(f"a call to nowhere: {self._program.locate(address)}")
            if instruction.target == following:
                return state._replace(depth=state.depth + _RETURN_ADDRESS), 0, [following]
            # A weak function that is not linked has the address 0, which the core checks before the call.
            below = self.of(instruction.target) if instruction.target != 0 else 0
            return state, _RETURN_ADDRESS + below, [following]
        if name in ("jmp", "rjmp"):
            return state, 0, [self._jump(instruction, address)]
        if name == "ijmp":
            return state, 0, self._program.constructors
        if name == "sei" and self._open[0] != 0:
            raise StackBoundError(f"an interrupt lets others in: {self._program.locate(address)}")
        if name in ("icall", "eicall", "eijmp"):
            raise StackBoundError(f"a pointer to a function: {self._program.locate(address)}")
        if name.startswith("br") and name != "break":
            return state, 0, [following, self._jump(instruction, address)]
        if name in _SKIPS:
            return state, 0, [following, following + self._program.code[following].size]
        after, ways = self._move(address, instruction, state)
        return after, 0, [ways]

    def _jump(self, instruction: Instruction, address: int) -> int:
        if instruction.target is None:
            raise StackBoundError(f"a jump to nowhere: {self._program.locate(address)}")
        return instruction.target

    def _move(self, address: int, instruction: Instruction, state: _State) -> tuple[_State, int]:
        """Return the state after an instruction that does not jump, and the address of the next one."""
        name, operands = instruction.name, instruction.operands
        following = address + instruction.size
        to = operands[0] if operands else ""
        depth, frame = state
        if name == "push":
            depth += 1
        elif name == "pop":
            depth -= 1
        elif name == "out" and to == "0x3d":
            begins = self._open == [0] and depth == 0  # the start of the program sets it to the memory's end
            if not begins and (frame is None or operands[1] != "r28"):
                raise StackBoundError(f"a computed stack pointer: {self._program.locate(address)}")
            depth = 0 if begins or frame is None else frame
        if name == "in" and operands == ("r28", "0x3d"):
            frame = depth
        elif name in ("adiw", "sbiw") and to == "r28" and frame is not None:
            frame += int(operands[1], 0) * (1 if name == "sbiw" else -1)
        elif name == "subi" and to == "r28" and frame is not None:
            frame, following = self._subtract(following, int(operands[1], 0), frame)
        elif to in ("r28", "r29") and name in _FRAME_WRITES and operands != ("r29", "0x3e"):
            frame = None
        return _State(depth, frame), following

    def _subtract(self, address: int, low: int, frame: int) -> tuple[int | None, int]:
        """Return the frame pointer after the second half of a subtraction from it, and what follows."""
        high = self._program.code[address]
        if high.name == "sbci" and high.operands[0] == "r29":
            number = low + 256 * int(high.operands[1], 0)
        elif high.name == "sbc" and high.operands == ("r29", "r1"):
            number = low
        else:
            return None, address
        return frame + (number + 0x8000) % 0x10000 - 0x8000, address + high.size


def stack_bound(elf: Path) -> int:
    """Return the most bytes that the program can have on its stack, in its deepest interrupt.

    Raise StackBoundError where there is no bound.
    """
    program = _Program(elf)
    bound = _Bound(program)
    _check_tables(program)
    unused = program.find("__bad_interrupt")
    interrupts = []
    for number in range(1, VECTORS):
        handler = program.code[number * _VECTOR_BYTES].target
        if handler is not None and handler != unused:
            interrupts.append(_RETURN_ADDRESS + bound.of(handler))
    return bound.of(0) + max(interrupts, default=0)


def _check_tables(program: _Program) -> None:
    """Raise StackBoundError if a table of jumps is used by anything but the start of the program."""
    table = program.find("__tablejump2__")
    users = {
        program.locate(address).split()[0]
        for address, instruction in program.code.items()
        if table is not None
        and instruction.target == table
        and instruction.name in ("call", "rcall", "jmp", "rjmp")
    }
    if users - {"__do_global_ctors"}:
        raise StackBoundError(f"a switch by a table of jumps: {', '.join(sorted(users))}")


def section_sizes(elf: Path) -> dict[str, int]:
    """Return the bytes of each section of a program."""
    command = ["avr-size", "-A", str(elf)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    rows = [line.split() for line in lines if line.startswith(".")]
    return {name: int(size) for name, size, *_ in rows}


def count_static(elf: Path) -> int:
    """Return the bytes of memory that a program has for itself; the stack gets the rest."""
    sizes = section_sizes(elf)
    return sum(sizes.get(name, 0) for name in _SECTIONS_IN_RAM)


def find_shortage(elf: Path) -> str:
    """Return why the program's memory does not suffice and what to do; empty if it does."""
    try:
        bound = stack_bound(elf)
    except StackBoundError as problem:
        return (
            f"The stack of {elf.stem} has no upper bound: {problem}. With recursion, a pointer to a function "
            "(as printf has), a virtual function or an array of variable size, the chip may lack memory "
            "under water. Write it without."
        )
    static = count_static(elf)
    margin = RAM_BYTES - static - bound
    if margin >= MARGIN_MIN:
        return ""
    free = f"only {margin} of them" if margin > 0 else "none"
    return (
        f"The chip's memory is too full for {elf.stem}: of {RAM_BYTES} bytes its variables take {static}, "
        f"and its stack up to {bound}. At least {MARGIN_MIN} must stay free, and {free} would. Make "
        f"variables {MARGIN_MIN - margin} bytes smaller: shorten an array, or keep constants and texts in "
        "flash (PROGMEM, FLASH_TEXT)."
    )


def main() -> int:
    """Check the program that is named on the command line. Return 0, or 1 if its memory does not suffice."""
    shortage = find_shortage(Path(sys.argv[1]))
    if shortage:
        print(shortage, file=sys.stderr)
    return 1 if shortage else 0


if __name__ == "__main__":
    sys.exit(main())

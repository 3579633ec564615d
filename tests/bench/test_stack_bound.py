"""The bound of a program's stack, on programs whose stack is known, and on the firmware."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from bench.firmware import count_flash
from bench.stack_bound import MARGIN_MIN, RAM_BYTES, StackBoundError, count_static, find_shortage, stack_bound
from robot_runtime.simulation.boards.firmware import make
from tests.board.host import EmulatedRobot, start
from tests.board.rig import ROOT, build
from tests.firmware.test_build import FLASH_BYTES

START = "#include <avr/interrupt.h>\n#include <stdint.h>\n#include <stdlib.h>\n"
MAIN = "int main(void) { DEEP; for (;;) {} }\n"
NAKED = "__attribute__((naked, noinline)) void"
PUSH, POP = "push r2\\n", "pop r2\\n"
FIVE = f'{NAKED} five(void) {{ asm volatile("{5 * PUSH}{5 * POP}ret"); }}\n'
THREE = f'{NAKED} three(void) {{ asm volatile("{3 * PUSH}call five\\n{3 * POP}ret"); }}\n'
HANDLER = f'ISR(TIMER0_OVF_vect, ISR_NAKED) {{ asm volatile("{4 * PUSH}{4 * POP}reti"); }}\n'


def program(folder: Path, text: str, *, optimize: str = "-Os") -> Path:
    source, elf = folder / "program.c", folder / "program.elf"
    source.write_text(START + text)
    command = ["avr-gcc", "-mmcu=atmega328p", optimize, "-std=gnu11", str(source), "-o", str(elf)]
    subprocess.run(command, check=True, capture_output=True)
    return elf


def test_calls_add_up_with_their_return_addresses(tmp_path: Path) -> None:
    alone = stack_bound(program(tmp_path, MAIN.replace("DEEP", "")))
    assert alone == 2  # main's return address
    nested = stack_bound(program(tmp_path, FIVE + THREE + MAIN.replace("DEEP", "three()")))
    assert nested == alone + (2 + 3) + (2 + 5)


def test_the_deepest_interrupt_comes_on_top(tmp_path: Path) -> None:
    plain = FIVE + THREE + MAIN.replace("DEEP", "three()")
    without = stack_bound(program(tmp_path, plain))
    assert stack_bound(program(tmp_path, HANDLER + plain)) == without + 2 + 4


@pytest.mark.parametrize(("size", "frame"), [(40, 40), (200, 200), (600, 600)])
def test_a_frame_counts(tmp_path: Path, size: int, frame: int) -> None:
    deep = f"volatile uint8_t room[{size}]; room[0] = 1; room[{size - 1}] = room[0]"
    bound = stack_bound(program(tmp_path, MAIN.replace("DEEP", deep)))
    assert frame <= bound - 2 <= frame + 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "__attribute__((noinline)) uint16_t f(volatile uint16_t n) { return n ? n * f(n - 1) : 1; }\n"
            + MAIN.replace("DEEP", "f(3)"),
            "functions that call each other",
        ),
        ("void (*volatile f)(void);\n" + MAIN.replace("DEEP", "f()"), "a pointer to a function"),
        (
            "volatile uint8_t n;\n__attribute__((noinline)) void g(uint8_t *p) { p[0] = n; n = p[1]; }\n"
            "__attribute__((noinline)) void f(void) { g(__builtin_alloca(n)); }\n"
            + MAIN.replace("DEEP", "f()"),
            "a computed stack pointer",
        ),
        ("ISR(TIMER0_OVF_vect) { sei(); }\n" + MAIN.replace("DEEP", ""), "an interrupt lets others in"),
        (
            MAIN.replace("DEEP", 'asm volatile("1: push r2\\nrjmp 1b")'),
            "a loop pushes",
        ),
    ],
)
def test_a_program_without_a_bound_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(StackBoundError, match=message):
        stack_bound(program(tmp_path, text))


def test_the_firmware_s_stack_fits_and_is_not_deeper_than_its_bound(tmp_path: Path) -> None:
    build(ROOT / "firmware", "robot")
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware/bootloader")
    elf = ROOT / "build/firmware/robot.elf"
    bound = stack_bound(elf)
    room = RAM_BYTES - count_static(elf)
    with start("robot", tmp_path) as rig:
        robot = EmulatedRobot(rig)
        robot.listen(0.5)
        robot.arm()
        robot.converse(1.0)
        measured = room - robot.status().stack_free
    assert 200 < measured <= bound <= room


@pytest.mark.parametrize(("name", "options"), [("hil/robot", ["HIL=1", "robot"]), ("bring_up", ["bring_up"])])
def test_the_other_programs_fit_the_chip_too(name: str, options: list[str]) -> None:
    """The program of a board in the loop has less memory left than the robot's, and needs less."""
    build(ROOT / "firmware", *options)
    elf = ROOT / f"build/firmware/{name}.elf"
    assert count_flash(elf) <= FLASH_BYTES
    assert find_shortage(elf) == ""


BUFFER = """
uint8_t samples[SIZE];

void loop() {
  robot.step();
  static uint8_t at;
  samples[at++ % sizeof samples] = TCNT1L;
  if (at == 0 && samples[samples[0] % sizeof samples]) robot.step();
}
"""


@pytest.mark.parametrize(
    ("loop", "message"),
    [
        (BUFFER, r"too full for robot: .* At least 100 must stay free, and (only \d+ of them|none) would"),
        ("void (*volatile task)();\nvoid loop() { robot.step(); task(); }\n", "no upper bound: a pointer to"),
    ],
)
def test_a_sketch_that_would_run_out_of_memory_is_not_built(tmp_path: Path, loop: str, message: str) -> None:
    shutil.copytree(ROOT / "firmware", tmp_path / "firmware")
    (tmp_path / "bench").mkdir()
    shutil.copy(ROOT / "bench/stack_bound.py", tmp_path / "bench")
    sketch = tmp_path / "firmware/examples/robot/robot.ino"
    text = sketch.read_text("utf-8")
    assert "void loop() { robot.step(); }\n" in text
    elf = ROOT / "build/firmware/robot.elf"
    too_much = RAM_BYTES - count_static(elf) - stack_bound(elf) - MARGIN_MIN + 20
    loop = loop.replace("SIZE", str(too_much))
    sketch.write_text(text.replace("void loop() { robot.step(); }\n", loop), "utf-8")
    build = tmp_path / "build/firmware"
    # What is not changed is not compiled again.
    shutil.copytree(ROOT / "build/firmware/core", build / "core", copy_function=shutil.copy2)
    made = make(tmp_path / "firmware", "robot", products=build)
    assert made.returncode != 0
    assert re.search(message, made.stderr)
    assert not (build / "robot.elf").exists()
    assert not (build / "robot.hex").exists()

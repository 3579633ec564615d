"""The Raspberry Pi's boot settings: the full UART for the board's line, and no console on it."""

import difflib

UART_LINES = ("enable_uart=1", "dtoverlay=disable-bt")
"""Lines of config.txt: the UART is on, and the full one (PL011), which Bluetooth would have."""
CONSOLES = ("serial0", "ttyAMA0", "ttyS0")
MEMORY_WORDS = ("cgroup_enable=memory",)
"""Words of cmdline.txt by which the kernel can limit memory."""
HEADER = "# For the serial line to the robot's board, by mucat install"


def edit_config(text: str) -> str:
    """Return config.txt with the UART's lines, at its end and for every model; unchanged if it has them."""
    section, present = "all", set()
    for line in text.splitlines():
        plain = line.split("#")[0].replace(" ", "")
        if plain.startswith("[") and plain.endswith("]"):
            section = plain[1:-1]
        elif section == "all":
            present.add(plain)
    missing = [line for line in UART_LINES if line not in present]
    if not missing:
        return text
    ending = "" if text.endswith("\n") or not text else "\n"
    return f"{text}{ending}\n[all]\n{HEADER}\n" + "".join(f"{line}\n" for line in missing)


def edit_kernel_line(text: str) -> str:
    """Return cmdline.txt, one line, without consoles on the board's line, and with limits of memory."""
    arguments = text.split()
    chosen = [
        word
        for word in arguments
        if not (word.startswith("console=") and word.removeprefix("console=").split(",")[0] in CONSOLES)
    ]
    chosen += [word for word in MEMORY_WORDS if word not in chosen]
    return text if chosen == arguments else " ".join(chosen) + "\n"


def describe_change(name: str, before: str, after: str) -> str:
    """Return the change as a unified difference; empty without one."""
    lines = difflib.unified_diff(
        before.splitlines(), after.splitlines(), f"{name} now", f"{name} afterwards", lineterm="", n=1
    )
    return "\n".join(lines)

"""The long proofs, and which of them run beside each other."""

import sys
from dataclasses import dataclass

from tests import beside


@dataclass(frozen=True, slots=True)
class Proof:
    """A target of the Makefile, the statement that it proves, and how, as sentences of the manual."""

    target: str
    statement: str
    how: str
    options: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Lane:
    """Proofs that begin in this order, so many at once."""

    proofs: tuple[Proof, ...]
    at_once: int = 1
    prefix: tuple[str, ...] = ()
    """The command that runs `make`."""


Stage = tuple[Lane, ...]
"""Lanes that run beside each other."""

# Robots run in real time and have the processor first; computing takes what they leave.
STAGES: tuple[Stage, ...] = (
    (
        # One after the other: three robots at once on two cores are late, and one was stopped for it.
        Lane(
            (
                Proof(
                    "chaos",
                    "An hour of faults of all kinds loses nothing that is not counted.",
                    (
                        "Kills, noise on the line, slow pages, full disks and clock jumps, in turns, "
                        "while a robot records in real time; all are counted afterwards."
                    ),
                ),
                Proof(
                    "outages",
                    "Each process that is killed or hangs stops the fins and is back in time.",
                    (
                        "Runtime, server, simulator, scene and board are each killed or stopped a "
                        "hundred times, on two robots."
                    ),
                ),
            )
        ),
        Lane(
            (
                Proof(
                    "kills",
                    "A killed server leaves no hole in a recording.",
                    "A hundred kills of a recording server.",
                ),
            )
        ),
        Lane(
            (
                # In simulated time, and so able to wait for robots in real time.
                Proof(
                    "robot-faults",
                    "Each fault of robot and chip stops the fins in time.",
                    (
                        "Each fault a hundred times at random moments of a swim: the firmware on the "
                        "emulated chip, in simulated time."
                    ),
                ),
                Proof(
                    "guards",
                    "Each guard is missed by a test when it is taken away.",
                    "Each guard of `tests/proofs/guards.toml` is removed from a copy of the source.",
                ),
                Proof(
                    "hours",
                    "A recording of hours is whole, and an hour's load leaves no memory behind.",
                    (
                        "Eight hours of a dive are recorded in simulated time and read back in every "
                        "way; an hour's load on runtime and server."
                    ),
                ),
                Proof(
                    "interface",
                    "No request that the interface allows makes the server fail.",
                    (
                        "schemathesis sends each operation 300 valid and invalid requests, made from "
                        "its description."
                    ),
                ),
                Proof(
                    "hostile",
                    "No word from outside reaches a build, a file name or a path.",
                    (
                        "500 hostile inputs through each entrance: shell code, options, encoded paths, "
                        "broken characters."
                    ),
                ),
                Proof(
                    "power",
                    "A power cut loses no row that was acknowledged.",
                    (
                        "Ten thousand disks as a cut leaves them, with writes lost, torn and reordered;"
                        " weaker settings must lose rows."
                    ),
                ),
                Proof(
                    "soak",
                    "No corrupted frame is believed, and no reset loses a message.",
                    (
                        "Ten million damaged frames through each decoder; a thousand resets of host and"
                        " board on a noisy line."
                    ),
                ),
                Proof(
                    "fuzz",
                    "No bytes bring down the firmware's end of the line.",
                    "libFuzzer with sanitisers on the whole firmware, for ten minutes.",
                ),
                Proof(
                    "control",
                    "The depth controllers are measured on each craft.",
                    (
                        "Steps and a sine on nine variants of the robot, in simulated time ([the "
                        "figures](controllers.md))."
                    ),
                ),
                Proof(
                    "missions",
                    "Each leaf of a mission, and random missions, end safely.",
                    (
                        "Each leaf is ended in each way on the emulated chip; a thousand random "
                        "missions; lanes by dead reckoning against the truth."
                    ),
                ),
            ),
            at_once=2,
            prefix=("nice", sys.executable, beside.__file__),
        ),
    ),
    (
        Lane(
            (
                Proof(
                    "attacks",
                    "No attack of the security review holds up STOP or the control loop.",
                    "Each attack and flood, while an operator arms and presses STOP a hundred times.",
                ),
                Proof(
                    "lab-proof",
                    "A lab whose parts fail loses nothing, and each robot swims on.",
                    (
                        "Three robots, a lab on PostgreSQL, a scheduler and two workers in namespaces: cut "
                        "cables, kills, wrong certificates, a full disk."
                    ),
                ),
                Proof(
                    "services",
                    "Installation, updates and the way back, with systemd and a cut of the power.",
                    "Containers with systemd, one of 32 bits, one on an emulated ARM processor.",
                ),
                Proof(
                    "debian",
                    "The Debian package installs, updates, goes back and leaves nothing when it is purged.",
                    "A container with systemd; a data folder of an earlier version is taken over.",
                ),
                Proof(
                    "image-swims",
                    "The container image starts, and its robot swims.",
                    "buildah runs the image; its robot is armed.",
                ),
                Proof(
                    "packages",
                    "The wheels install and swim on fresh systems of each architecture.",
                    "Debian 12 and 13 on x86-64, i386, arm64 and armhf, the foreign ones emulated by qemu.",
                ),
            )
        ),
    ),
    (
        Lane(
            (
                Proof(
                    "bench",
                    "The figures and their goals.",
                    "Each figure beside its [goal](testing.md#measurements).",
                    options=("LONG=1",),
                ),
            )
        ),
    ),
)

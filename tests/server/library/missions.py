"""A mission as the runtime tells it: a dive, then a mark twice, with an end or without."""

from dataclasses import replace

from robot_runtime.contract.documents import Mission, MissionStepState
from robot_runtime.contract.missions import MissionPhase, MissionStatus
from robot_runtime.transport.blocks import Block
from tests.server.blocks import mission_block

TEXT = 'format = 1\nname = "look"\n'
DIVE_AT, REPEAT_AT, MARK_AT, MISSION_END = 103.0, 108.0, 109.0, 130.0
"""s, steady clock"""
WORDS = {"": "Sequence", "1": "Dive to 0.6 m", "2": "Repeat 2 times", "2.1": "Mark “here”", "3": "Surface"}


def mission_blocks(*, first: int = 0, number: int = 1, shift: float = 0.0) -> list[Block]:
    """Return the documents of the mission from the `first` on, `shift` s later."""

    def say(time: float, phase: MissionPhase, statuses: str, text: str = "") -> Mission:
        names: dict[str, MissionStatus] = {
            "w": "waiting",
            "r": "running",
            "d": "done",
            "f": "failed",
            "s": "stopped",
        }
        steps = [
            MissionStepState(
                path=path,
                do=text.split()[0].lower(),
                words=text,
                note="east" if path == "1" else "",
                status=names[letter],
                elapsed=2.5,
                longest=30.1,
                rounds=0,
                text="It was at 0.20 m." if letter == "f" else "",
            )
            for (path, text), letter in zip(WORDS.items(), statuses, strict=True)
        ]
        return Mission(
            time=time + shift,
            number=number,
            sequence=0,
            name="look",
            title="Look east",
            phase=phase,
            text=text,
            elapsed=time - DIVE_AT,
            remaining=12.0,
            progress=0.4,
            paused=3.0,
            pause=60.0,
            deepest=0.61,
            steps=steps,
        )

    notices = [
        say(DIVE_AT, "running", "rrwww"),
        say(REPEAT_AT, "running", "rdrww"),
        say(MARK_AT, "running", "rdrdw"),
        say(MARK_AT + 1, "running", "rdrww"),
        say(MARK_AT + 2, "paused", "rdrdw", "It was paused."),
        say(MISSION_END, "failed", "fddfw", "Step 2.1, mark: It was at 0.20 m."),
    ]
    whole = (0, len(notices) - 1)
    numbered = [
        replace(document, sequence=index, document=TEXT if index in whole else "")
        for index, document in enumerate(notices)
    ]
    return [mission_block(document.sequence, document) for document in numbered[first:]]

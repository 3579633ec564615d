"""A person who brings up the emulated robot on the page: does what each step asks, by hand."""

import re
from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect

from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.guide import NO_FIN, STEPS
from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from robot_runtime.simulation.boards.workbench import BATTERY
from tests.stack import Stack
from tests.waiting import wait_for

TURNED = 0.1
"""rad, from which a person sees that a fin turns."""
TITLES = {step.name: step.title for step in STEPS}


class PagePerson:
    """Begins a bring-up on the page, does its steps in their order, mends and ends it."""

    def __init__(self, page: Page, stack: Stack) -> None:
        self.page = page
        self._stack = stack
        self._steps = page.get_by_role("list", name="Steps of the bring-up")

    def begin(self) -> None:
        self.page.goto(f"{self._stack.url}/#/bring-up")
        self.page.get_by_role("button", name="Begin", exact=True).click()
        expect(self.page.get_by_text(f"of {len(STEPS)} steps done").first).to_be_visible()

    def report(self) -> str:
        """Return the newest report, written at the end."""
        self.end()
        return self._stack.api.get("/bring-up/report").text

    def end(self) -> None:
        self.page.get_by_role("button", name="End", exact=True).click()
        self.page.get_by_role("button", name="End the bring-up").click()
        expect(self.page.get_by_role("button", name="Begin", exact=True)).to_be_visible()

    def everything(self) -> str | None:
        """Do all steps in their order, but end at the first that is wrong: its name."""
        for step in STEPS:
            self.do(step.name)
            if self.state(step.name) == "wrong":
                return step.name
        return None

    def do(self, step: str) -> None:
        """Do one step with all its actions, until the page says what came of it."""
        name, _, number = step.partition("_")
        steps: dict[str, Callable[[int], None]] = {
            "devices": lambda _: self._press("Look who answers"),
            "sensors": lambda _: self._press("Read them"),
            "battery": lambda _: self._compare(),
            "axes": lambda _: self._lay_down(),
            "gyro": lambda _: self._press("Measure at rest"),
            "pressure": lambda _: self._sink(),
            "fin": self._turn_by_hand,
            "motor": self._hold,
            "beacons": lambda _: self._shine(),
            "leak": lambda _: self._wet(),
            "store": lambda _: self._press("Store it in the board"),
        }
        self.open(step)
        steps[name](int(number or 0))
        expect(self._steps.get_by_role("link", name=TITLES[step])).to_have_text(
            re.compile("done$|something is wrong$")
        )

    def open(self, step: str) -> None:
        self._steps.get_by_role("link", name=TITLES[step]).click()
        expect(self.page.get_by_role("heading", name=TITLES[step])).to_be_visible()

    def state(self, step: str) -> str:
        """Return the state of a step, as the list says it."""
        text = self._steps.get_by_role("link", name=TITLES[step]).inner_text()
        states = {"done": "done", "something is wrong": "wrong", "skipped": "skipped"}
        return next((state for answer, state in states.items() if text.endswith(answer)), "open")

    def advice(self) -> str:
        """Return all advice of the open step."""
        table = self.page.get_by_role("table", name="Results")
        return " ".join(table.locator(".advice").all_inner_texts())

    def mend(self) -> None:
        # Mended only once it is answered: the next action may overtake the question.
        with self.page.expect_response("**/api/bring-up/hands") as answer:
            self.page.get_by_role("button", name="Mend the robot").click()
        assert answer.value.ok, answer.value.text()

    def skip(self, step: str) -> None:
        self.open(step)
        self.page.get_by_role("button", name="Skip this step").click()
        expect(self._steps.get_by_role("link", name=TITLES[step])).to_have_text(re.compile("skipped$"))

    def spoil(self, mistake: str) -> None:
        """Make this mistake in the robot's wiring, while it lies on the workbench."""
        with EmulatorClient(self._stack.data / "run/board.sock") as board:
            board.mistake(mistake)

    def hold_button(self) -> Locator:
        return self.page.get_by_role("button", name=re.compile("Hold to turn it|Turning"))

    def _press(self, action: str) -> None:
        """Press a button of the step, and wait until the board has done it."""
        button = self.page.get_by_role("button", name=action, exact=True)
        with self.page.expect_response("**/api/bring-up/actions") as answer:
            button.click()
        assert answer.value.ok, answer.value.text()
        expect(button).to_be_enabled()

    def _choose(self, group: str, title: str) -> None:
        button = self.page.get_by_role("group", name=group).get_by_role("button", name=title)
        button.click()
        expect(button).to_have_attribute("aria-pressed", "true")
        self._settle()

    def _settle(self) -> None:
        """Wait until the board's readings have followed: for two more looks of the page at them."""
        for _ in range(2):
            with self.page.expect_response(lambda response: response.url.endswith("/api/bring-up")):
                pass

    def _compare(self) -> None:
        self.page.get_by_role("spinbutton", name="Multimeter").fill(f"{BATTERY}")
        self._press("Compare")

    def _lay_down(self) -> None:
        for pose, action in (
            ("Level", "It lies level"),
            ("Nose up", "Its nose points up"),
            ("Right side down", "Its right side points down"),
        ):
            self._choose("Pose of the hull", pose)
            self._press(action)
        self._choose("Pose of the hull", "Level")

    def _sink(self) -> None:
        self.page.get_by_role("spinbutton", name="Barometer").fill("1013.2")
        self._press("In air")
        self._choose("Place of the pressure sensor", "30 cm")
        self.page.get_by_role("spinbutton", name="Depth").fill("30")
        self._press("In the bucket")
        self._choose("Place of the pressure sensor", "Above the water")

    def _turn_by_hand(self, fin: int) -> None:
        element = self.page.get_by_role("listitem", name=f"Fin {FINS[fin]}")
        for way, angle, action in (
            ("Along", "0", "It points along its mount"),
            ("Tip down", "90", "Its tip points down"),
        ):
            element.get_by_role("button", name=way).click()
            expect(element.get_by_role("img", name=f"{angle}° from its mount")).to_be_visible()
            self._settle()
            self._press(action)

    def _hold(self, _: int) -> None:
        """Hold the button until a fin has visibly turned, or for a second, and say which it was."""
        before = self.angles()
        self.hold_button().hover()
        self.page.mouse.down()
        for _ in range(5):
            with self.page.expect_response("**/api/bring-up/actions"):
                pass
        self.page.mouse.up()
        expect(self.page.get_by_role("button", name="Hold to turn it")).to_be_visible()
        self._settle()
        turned = [abs(after - then) for then, after in zip(before, self.angles(), strict=True)]
        seen = FINS[turned.index(max(turned))] if max(turned) > TURNED else NO_FIN
        self.page.get_by_role("combobox", name="Fin").select_option(seen)
        self._press("This one turned")

    def angles(self) -> list[float]:
        """Return the fins' angles as the page shows them, rad."""
        shown = []
        for name in FINS:
            picture = self.page.get_by_role("listitem", name=f"Fin {name}").get_by_role("img")
            degrees = re.match(r"[−\d]+", picture.get_attribute("aria-label") or "")
            assert degrees
            shown.append(int(degrees[0].replace("−", "-")) / 57.3)
        return shown

    def _shine(self) -> None:
        self._choose("Place of the lamp", "Away")
        self._press("Both are dark")
        self._choose("Place of the lamp", "right")
        self._press("Lamp at the right")
        self._choose("Place of the lamp", "left")
        self._press("Lamp at the left")
        self._choose("Place of the lamp", "Away")

    def _wet(self) -> None:
        self._choose("Ends of the leak sensor", "In water")
        self._press("The ends are in water")
        self._choose("Ends of the leak sensor", "Dry")
        self._press("They are dry again")


def wait_for_the_robot(stack: Stack) -> None:
    """End any bring-up, and wait until the robot's firmware swims again."""
    stack.api.delete("/bring-up").raise_for_status()
    wait_for(lambda: stack.api.get("/bring-up").json()["phase"] == "idle", "the end")
    stack.wait_ready()

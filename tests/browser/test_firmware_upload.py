"""The upload of firmware from the System page: asked for, seen, and the older one offered."""

from playwright.sync_api import Browser, expect

from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from tests.board.rig import ROOT
from tests.browser.people import somebody
from tests.stack import Stack


def test_firmware_is_uploaded_from_the_page(browser: Browser, stack: Stack) -> None:
    with EmulatorClient(stack.data / "run/board.sock") as board:
        board.load(ROOT / "build/firmware/bring_up.elf")
    # Somebody who has just signed in, as every dangerous act needs it.
    with somebody(browser, stack, "operator") as page:
        page.goto(f"{stack.url}/#/system")
        panel = page.get_by_role("region", name="Upload of firmware")
        panel.get_by_role("button", name="Upload the firmware").click()
        panel.get_by_role("button", name="Cancel").click()
        panel.get_by_role("button", name="Upload the firmware").click()
        panel.get_by_role("button", name="Yes, upload").click()
        expect(panel.get_by_text("Reading the firmware that is on the board")).to_be_visible()
        expect(panel.get_by_text("Writing and verifying the firmware")).to_be_visible()
        bar = panel.get_by_role("progressbar", name="Upload of firmware")
        expect(bar).not_to_have_attribute("aria-valuenow", "0")
        expect(panel.get_by_text("read back and compared")).to_be_visible()
        expect(panel.get_by_role("button", name="Put the previous firmware back")).to_be_enabled()
        expect(panel.get_by_text("firmware-previous.hex").first).to_be_visible()
    stack.wait_ready()

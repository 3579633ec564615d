"""The editor of documents: a text is written as a person writes it, and read from the page's own draft."""

from playwright.sync_api import Locator, Page


def write_code(box: Locator, text: str) -> None:
    """Replace the text in an editor by pasting another one."""
    box.focus()
    box.press("ControlOrMeta+a")
    # Not `fill`: replacing, Chromium writes styles of its own, which the security policy reports.
    box.evaluate(
        """(box, text) => {
            const clipboardData = new DataTransfer();
            clipboardData.setData('text/plain', text);
            const how = { clipboardData, bubbles: true, cancelable: true };
            box.dispatchEvent(new ClipboardEvent('paste', how));
        }""",
        text,
    )


def draft_of(page: Page, name: str) -> str:
    """Return the text that is being written: an editor has only the lines in sight."""
    text: str = page.evaluate("(name) => sessionStorage.getItem(name) ?? ''", name)
    return text

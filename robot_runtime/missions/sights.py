"""Checks of the colours, markers and lights for which a mission waits, by the vision settings."""

from robot_runtime.contract.vision_settings import MARKER, MARKER_COUNTS, VisionSettings, marker_name

LIGHT = "light"
"""The name by which `sees` calls the light of the beacon detectors."""


def find_sight_problem(what: str, settings: VisionSettings) -> str:
    """Return the reason why a robot with these settings cannot see this; empty if it can."""
    if what == LIGHT or what in settings.colours:
        return ""
    if (marker := MARKER.fullmatch(what)) is None:
        known = ", ".join([*settings.colours, LIGHT])
        return f"Nothing is called {what!r}; there are {known}, and markers such as “marker 7”."
    if settings.markers == "none":
        return "The camera looks for no markers. Choose their dictionary in the vision settings."
    if int(marker[1]) >= (count := MARKER_COUNTS[settings.markers]):
        return f"There is no {what} in the dictionary {settings.markers}; its last is marker {count - 1}."
    numbers = settings.marker_numbers
    if numbers and what not in map(marker_name, numbers):
        return f"The camera does not look for {what}. Add it to the markers in the vision settings."
    return ""

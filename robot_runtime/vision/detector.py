"""The search for colours and markers: BGR to HSV, a mask of the colour, its patches (thesis, section 4.2)."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from robot_runtime.contract.documents import ArucoMarker, Candidate
from robot_runtime.contract.vision_settings import MarkerDictionary, VisionSettings, marker_name
from robot_runtime.vision.balance import BALANCES
from robot_runtime.vision.patches import Patches, find_patches
from robot_runtime.vision.picture import Picture

DICTIONARIES: Mapping[MarkerDictionary, int] = {
    "4x4_50": cv2.aruco.DICT_4X4_50,
    "5x5_100": cv2.aruco.DICT_5X5_100,
    "6x6_250": cv2.aruco.DICT_6X6_250,
    "7x7_1000": cv2.aruco.DICT_7X7_1000,
    "original": cv2.aruco.DICT_ARUCO_ORIGINAL,
    "april_36h11": cv2.aruco.DICT_APRILTAG_36h11,
}
"""OpenCV's dictionaries by their names in the configuration.

S. Garrido-Jurado et al., Pattern Recognition 47 (2014).
"""


class MarkerFinder:
    """Finder of the ArUco markers that the settings select."""

    def __init__(self, settings: VisionSettings) -> None:
        self._numbers = settings.marker_numbers
        self._detector: cv2.aruco.ArucoDetector | None = None
        if settings.markers != "none":
            dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARIES[settings.markers])
            self._detector = cv2.aruco.ArucoDetector(dictionary)

    def find(self, picture: Picture) -> list[ArucoMarker]:
        """Return the markers in a BGR picture (height, width, 3), in order of their numbers."""
        if self._detector is None:
            return []
        height, width = picture.shape[:2]
        corners, numbers, _ = self._detector.detectMarkers(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
        markers = [
            ArucoMarker(number=int(number), corners=(four.reshape(4, 2) / (width, height)).ravel().tolist())
            # OpenCV returns None instead of an empty array.
            for number, four in zip(np.ravel(numbers) if corners else (), corners, strict=True)
            if not self._numbers or int(number) in self._numbers
        ]
        return sorted(markers, key=lambda marker: marker.number)


@dataclass(frozen=True, slots=True)
class Sight:
    """The result of searching one picture.

    `target_patches` are the patches of the target colour. `patch`, of `colour`, is the reported one:
    the target's largest or, without a target, the largest of all.
    """

    balanced: Picture
    target_patches: Patches
    colour: str | None
    patch: Candidate | None
    markers: list[ArucoMarker]

    @property
    def names(self) -> list[str]:
        """The colour and the markers that the picture shows."""
        colour = [] if self.colour is None else [self.colour]
        return [*colour, *(marker_name(marker.number) for marker in self.markers)]


def choose_target(settings: VisionSettings, seen: Collection[str]) -> str | None:
    """Return the sight that sets the set point: the target colour, else the first action's that is seen."""
    return next((name for name in (settings.colour, *settings.actions) if name in seen), None)


class Detector:
    """Detector of the colours and markers of these settings."""

    def __init__(self, settings: VisionSettings) -> None:
        self.settings = settings
        self.balance = BALANCES[settings.white_balance]
        """The white balance that every picture passes first."""
        self._markers = MarkerFinder(settings)

    def search(self, picture: Picture) -> Sight:
        """Search a BGR picture (height, width, 3).

        The target colour comes first, then targets of actions in the actions' order, then the rest.
        """
        settings = self.settings
        balanced = self.balance(picture)
        hsv = cv2.cvtColor(balanced, cv2.COLOR_BGR2HSV).astype(np.uint8, copy=False)
        markers = self._markers.find(balanced)
        target_patches = find_patches(hsv, settings.colour, settings)
        if (patch := target_patches.largest) is not None:
            return Sight(balanced, target_patches, settings.colour, patch, markers)
        others = (find_patches(hsv, name, settings) for name in settings.colours if name != settings.colour)
        seen = {other.colour: patch for other in others if (patch := other.largest) is not None}
        there = {*seen, *(marker_name(marker.number) for marker in markers)}
        target = choose_target(settings, there)
        colour = target if target in seen else max(seen, key=lambda name: seen[name].area, default=None)
        return Sight(
            balanced=balanced,
            target_patches=target_patches,
            colour=colour,
            patch=seen[colour] if colour is not None else None,
            markers=markers,
        )

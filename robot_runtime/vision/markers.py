"""ArUco markers, squares that carry a number: S. Garrido-Jurado et al., Pattern Recognition 47 (2014)."""

from collections.abc import Mapping

import cv2
import numpy as np

from robot_runtime.contract.documents import ArucoMarker
from robot_runtime.contract.vision_settings import MarkerDictionary, VisionSettings
from robot_runtime.vision.picture import Picture

DICTIONARIES: Mapping[MarkerDictionary, int] = {
    "4x4_50": cv2.aruco.DICT_4X4_50,
    "5x5_100": cv2.aruco.DICT_5X5_100,
    "6x6_250": cv2.aruco.DICT_6X6_250,
    "7x7_1000": cv2.aruco.DICT_7X7_1000,
    "original": cv2.aruco.DICT_ARUCO_ORIGINAL,
    "april_36h11": cv2.aruco.DICT_APRILTAG_36h11,
}
"""OpenCV's, by the names of the configuration."""


class MarkerFinder:
    """Finds the markers that count by these settings."""

    def __init__(self, settings: VisionSettings) -> None:
        self._numbers = settings.marker_numbers
        self._detector: cv2.aruco.ArucoDetector | None = None
        if settings.markers != "none":
            dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARIES[settings.markers])
            self._detector = cv2.aruco.ArucoDetector(dictionary)

    def find(self, picture: Picture) -> list[ArucoMarker]:
        """Those in a BGR picture (height, width, 3), in order of their numbers."""
        if self._detector is None:
            return []
        height, width = picture.shape[:2]
        corners, numbers, _ = self._detector.detectMarkers(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
        found = [
            ArucoMarker(number=int(number), corners=(four.reshape(4, 2) / (width, height)).ravel().tolist())
            # OpenCV gives None in place of no numbers.
            for number, four in zip(np.ravel(numbers) if corners else (), corners, strict=True)
            if not self._numbers or int(number) in self._numbers
        ]
        return sorted(found, key=lambda one: one.number)

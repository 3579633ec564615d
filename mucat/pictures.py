"""Pictures as arrays."""

from typing import Any

from mucat.errors import RobotError
from mucat.packages import load_package


def decode_picture(jpeg: bytes) -> Any:
    """Return a JPEG file as an array of NumPy: height × width × 3, red, green and blue, 0 to 255.

    Raise RobotError where it is no picture, or OpenCV is missing.
    """
    cv2, numpy = load_package("cv2", "opencv-python-headless"), load_package("numpy")
    picture = cv2.imdecode(numpy.frombuffer(jpeg, numpy.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        raise RobotError("This is no picture: it cannot be decoded.")
    return cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)

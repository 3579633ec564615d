"""The certificates of the door of ROS 2: those of the robot's Zenoh."""

import ssl

from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY
from server.features.doors.config import DoorsConfig
from server.features.doors.ros2_messages import NO_ROSBAGS, has_rosbags
from server.platform.authority import Authority
from server.platform.settings import Settings, SetupError


def prepare_ros2(settings: Settings) -> None:
    """Issue missing certificates where the door is to be opened. Raise SetupError on failure."""
    if settings.section(DoorsConfig).ros2:
        Authority(settings).prepare()
        check_ros2(settings)


def check_ros2(settings: Settings) -> ssl.SSLContext:
    """Return the settings of TLS for this door. Raise SetupError where it cannot be opened."""
    if not has_rosbags():
        raise SetupError(NO_ROSBAGS)
    folder = settings.data.zenoh
    missing = [name for name in (AUTHORITY, CERTIFICATE, KEY) if not (folder / name).is_file()]
    if missing:
        raise SetupError(
            f"doors.ros2 needs the certificates of the robot's Zenoh, and {folder} lacks "
            f"{', '.join(missing)}. Restore the folder from a copy; or remove it, and issue all "
            "certificates again."
        )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(folder / CERTIFICATE, folder / KEY)
        context.load_verify_locations(folder / AUTHORITY)
    except (OSError, ssl.SSLError) as problem:
        raise SetupError(
            f"doors.ros2 needs the certificates of the robot's Zenoh, and those in {folder} cannot be used: "
            f"{problem}."
        ) from problem
    context.verify_mode = ssl.CERT_REQUIRED
    return context

"""The robot from Python: read it live, command it, and load its sessions as tables with units."""

from mucat.errors import RobotError as RobotError
from mucat.lab import Lab as Lab
from mucat.live import LiveSample as LiveSample
from mucat.robot import Robot as Robot
from mucat.robot import RobotControl
from mucat.robot import SessionRecording as SessionRecording
from mucat.sessions import FolderSessions as FolderSessions
from mucat.sessions import Sessions as Sessions
from mucat.tables import SessionTables as SessionTables

Control = RobotControl

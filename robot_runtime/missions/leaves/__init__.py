"""The leaves that ship with the program; importing a module declares its leaves."""

from robot_runtime.missions.leaves import asking as asking
from robot_runtime.missions.leaves import doing as doing
from robot_runtime.missions.leaves import moving as moving
from robot_runtime.missions.leaves import waiting as waiting

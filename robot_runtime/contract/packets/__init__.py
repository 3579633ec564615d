"""Every packet of the serial link, defined once; the sources of other languages are generated from here."""

from robot_runtime.contract.packets.chip_parameters import CHIP_PARAMETERS as CHIP_PARAMETERS
from robot_runtime.contract.packets.chip_parameters import ChipParameter as ChipParameter
from robot_runtime.contract.packets.definitions import *  # noqa: F403 - each packet is named in definitions alone

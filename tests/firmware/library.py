"""The firmware compiled for this computer, with the types of its C names."""

import ctypes
from ctypes import (
    POINTER,
    c_bool,
    c_char_p,
    c_float,
    c_int,
    c_int8,
    c_int16,
    c_int32,
    c_uint8,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import Any

from tests.board import rig
from tests.board.rig import ROOT

PATH = ROOT / "build/firmware/libfirmware_host.so"

I2C_BUS = ctypes.CFUNCTYPE(c_uint8, c_uint8, POINTER(c_uint8), c_uint8, POINTER(c_uint8), c_uint8)
_FLOATS = POINTER(c_float)

# Each name's result, then its arguments.
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "firmware_crc32": (c_uint32, c_char_p, c_uint8),
    "firmware_encode_cobs": (c_uint8, c_char_p, c_uint8, c_char_p),
    "firmware_decode_cobs": (c_uint8, c_char_p, c_uint8),
    "decoder_create": (c_void_p,),
    "decoder_destroy": (None, c_void_p),
    "decoder_feed": (c_bool, c_void_p, c_uint8),
    "decoder_number": (c_uint8, c_void_p),
    "decoder_set_key": (None, c_void_p, c_uint32),
    "decoder_open": (c_bool, c_void_p),
    "decoder_invalid": (c_uint16, c_void_p),
    "decoder_next": (c_int, c_void_p, POINTER(c_uint8), c_char_p),
    "packer_create": (c_void_p,),
    "packer_destroy": (None, c_void_p),
    "packer_add": (c_bool, c_void_p, c_uint8, c_char_p, c_uint8),
    "packer_close": (c_uint8, c_void_p, c_uint16, c_uint8, c_uint32, c_char_p),
    "queue_create": (c_void_p,),
    "queue_destroy": (None, c_void_p),
    "queue_push": (c_bool, c_void_p, c_uint8, c_char_p, c_uint8),
    "queue_pop": (c_uint8, c_void_p, c_char_p),
    "debug_number": (c_uint8, c_uint16, c_uint8, c_char_p),
    "firmware_mix": (None, c_char_p, _FLOATS, _FLOATS),
    "law_create": (c_void_p, c_float),
    "law_destroy": (None, c_void_p),
    "law_step": (c_float, c_void_p, c_float, c_float, c_uint16),
    "law_flapping": (c_bool, c_void_p),
    "law_phase_per_tick": (c_uint16,),
    "law_fin_phase": (c_uint16, c_uint8),
    "firmware_wrap_counts": (c_int16, c_int16),
    "firmware_counts_from_angle": (c_int16, c_uint8, c_float),
    "firmware_angle_from_counts": (c_float, c_uint8, c_int16),
    "loop_create": (c_void_p,),
    "loop_destroy": (None, c_void_p),
    "loop_step": (c_int8, c_void_p, c_uint8, c_int16, c_int16),
    "firmware_encoder_counts": (c_int, c_uint16),
    "firmware_prom_valid": (c_bool, POINTER(c_uint16)),
    "firmware_compensate": (
        None,
        POINTER(c_uint16),
        c_uint32,
        c_uint32,
        POINTER(c_int32),
        POINTER(c_int16),
    ),
    "attitude_create": (c_void_p,),
    "attitude_destroy": (None, c_void_p),
    "attitude_update": (None, c_void_p, _FLOATS, _FLOATS, c_float, _FLOATS),
    "firmware_battery_millivolts": (c_uint16, c_uint16),
    "board_set_i2c": (None, I2C_BUS),
    "board_set_encoder": (None, c_uint8, c_uint16),
    "board_set_battery": (None, c_uint16),
    "board_set_beacons": (None, c_bool, c_bool),
    "board_set_leak": (None, c_bool),
    "board_epoch": (c_uint16,),
    "board_led": (c_bool,),
    "board_motor_power": (c_bool,),
    "board_advance": (None, c_uint32),
    "board_now_us": (c_uint64,),
    "board_fed_us": (c_uint64,),
    "board_overwritten": (c_uint32,),
    "board_receive": (None, c_char_p, c_uint32),
    "board_take": (c_uint32, c_char_p, c_uint32),
    "board_power_up": (None,),
    "robot_start": (c_void_p, c_uint8),
    "robot_destroy": (None, c_void_p),
    "robot_run": (None, c_void_p, c_uint32),
}


def build() -> None:
    """Compile the library, or fail with make's output."""
    rig.build(ROOT / "firmware", "host")


def load() -> ctypes.CDLL:
    """Return the library with typed names."""
    library = ctypes.CDLL(str(PATH))
    for name, (result, *arguments) in _SIGNATURES.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library

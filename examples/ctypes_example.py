"""diminish through Python's ctypes, which needs nothing but the shared library.

ctypes_example.py libdiminish.so RECORDING: processes its frames, prints what was found."""

import ctypes
import sys
from ctypes import POINTER, Structure, byref, c_char_p, c_double, c_int, c_int32, c_ssize_t, c_uint64, c_void_p


class Image(Structure):
    _fields_ = [("data", c_void_p), ("width", c_int32), ("height", c_int32), ("stride", c_ssize_t)]


class Output(Structure):
    _fields_ = (
        [(name, Image) for name in ("picture", "mask", "provenance")]
        + [(name + "_pixels", c_uint64) for name in ("mask", "seen", "remembered", "invented")]
        + [("milliseconds", c_double), ("messages", c_char_p)]
    )


library = ctypes.CDLL(sys.argv[1])
library.diminish_last_error.restype = c_char_p
library.diminish_open.argtypes = [c_char_p, POINTER(c_void_p)]
library.diminish_set_option.argtypes = [c_void_p, c_char_p, c_char_p]
library.diminish_next.argtypes = [c_void_p, POINTER(Output), POINTER(c_int)]
library.diminish_close.argtypes = [c_void_p]
library.diminish_close.restype = None


def check(status):
    if status != 0:
        sys.exit(library.diminish_last_error().decode())


pipeline, output, more = c_void_p(), Output(), c_int(1)
check(library.diminish_open(sys.argv[2].encode(), byref(pipeline)))
check(library.diminish_set_option(pipeline, b"memory", b"off"))
while True:
    check(library.diminish_next(pipeline, byref(output), byref(more)))
    if not more.value:
        break
    mask = ctypes.string_at(output.mask.data, output.mask.width * output.mask.height)
    print(f"{output.mask_pixels} pixels replaced, {mask.count(255)} in the mask, {output.milliseconds:.1f} ms")
library.diminish_close(pipeline)

"""Checks that WAV files are not silent.

    python3 scripts/release/check_sound.py FILE.wav …
"""

import array
import pathlib
import struct
import sys

LEAST_PEAK_DB = -50.0
"""Below this peak level re full scale, in dB, a listener would hear nothing at a usual volume."""


def peak(file):
    """The peak of a WAV file of floats or 16-bit integers, 1 for full scale."""
    data = pathlib.Path(file).read_bytes()
    if data[:4] != b"RIFF" or data[8:12] != b"WAVE":
        sys.exit(f"{file} is not a WAV file")
    place, bits = 12, 0
    while place + 8 <= len(data):
        name, length = struct.unpack("<4sI", data[place : place + 8])
        body = data[place + 8 : place + 8 + length]
        if name == b"fmt ":
            bits = struct.unpack("<H", body[14:16])[0]
        elif name == b"data":
            samples = array.array("f" if bits == 32 else "h", body)
            return max(map(abs, samples), default=0) / (1 if bits == 32 else 32768)
        place += 8 + length + length % 2
    sys.exit(f"{file} has no samples")


for file in sys.argv[1:]:
    if peak(file) < 10 ** (LEAST_PEAK_DB / 20):
        sys.exit(f"{file} is silent")

"""Files of waves for the programs of the marched scenes (waves.h), and their comparison with the exact waves."""

import csv
import struct
from dataclasses import dataclass
from math import dist
from statistics import quantiles

FOUR_FLOATS = "4f"
FOUR_DOUBLES = "4d"
# Number of cells along each axis for the Morton order, as an exponent of two.
CELL_BITS = 10


@dataclass
class Errors:
    """`differs` is the share of waves with another status (heard, lost, or another surface); `median` and
    `p99` are distances in metres between end points."""

    differs: float
    heard: int
    lost: int
    median: float
    p99: float


def read(file, form):
    return list(struct.iter_unpack(form, file.read_bytes()))


def write(file, rows):
    file.write_bytes(b"".join(struct.pack(FOUR_FLOATS, *row) for row in rows))


def dumped(file):
    """The start directions and the ends of a table written by `echomarch trace --dump-waves`."""
    with file.open() as table:
        rows = list(csv.DictReader(table))

    def columns(names, last):
        return [(*(float(row[name]) for name in names), last(row)) for row in rows]

    starts = columns(("start_dx", "start_dy", "start_dz"), lambda row: 0.0)
    return starts, columns(("x", "y", "z"), lambda row: float(round(float(row["status"]))))


def with_objects(ends, objects):
    """The ends of a peer. The status of a travelling wave is the surface at which it is."""
    return [(*end[:3], object if end[3] > 0 else end[3]) for end, (object,) in zip(ends, objects)]


def compare(ends, exact):
    there = [dist(end[:3], truth[:3]) for end, truth in zip(ends, exact) if truth[3] >= 0]
    hundredths = quantiles(there, n=100)
    return Errors(
        differs=sum(end[3] != truth[3] for end, truth in zip(ends, exact)) / len(exact),
        heard=sum(end[3] == 0 for end in ends),
        lost=sum(end[3] < 0 for end in ends),
        median=hundredths[49],
        p99=hundredths[98],
    )


def neighbours_together(directions):
    """The directions in Morton order: neighbours in the list are mostly neighbours on the sphere."""

    def key(direction):
        last = (1 << CELL_BITS) - 1
        cells = [round((value + 1) / 2 * last) for value in direction[:3]]
        places = [(axis, bit) for axis in range(3) for bit in range(CELL_BITS)]
        return sum((cells[axis] >> bit & 1) << 3 * bit + axis for axis, bit in places)

    return sorted(directions, key=key)

"""A hall of pillars as a scene of any number of surfaces.

The scene is the one of examples/many_surfaces.rs: a room 6 m high, with pillars 4 m apart and radii of 0.3 to 0.7 m.
The first surface is the room. Each surface has a short text, because a scene file may have at most 4 MiB, which is
enough for some 80,000 surfaces.
"""

import math

SPACING = 4.0


def ron(surfaces):
    pillars = surfaces - 1
    side = max(4, math.ceil(math.sqrt(pillars)))
    width = SPACING * side
    lines = [f"(shape: Room(size: ({width}, 6, {width})))"]
    for index in range(pillars):
        row, column = divmod(index, side)
        radius = 0.3 + 0.1 * ((row * 7 + column * 3) % 5)
        x, z = (SPACING * (place + 0.5) - 0.5 * width for place in (column, row))
        lines.append(f"(shape:Cylinder(radius:{radius:.1f}),position:({x:g},0,{z:g}))")
    # A position between four pillars, for an even or an odd number of pillars along a side.
    source = SPACING * (side // 2) - 0.5 * width
    listener = source + SPACING
    return (
        f'(\n    name: "hall of {surfaces} surfaces",\n    surfaces: [\n'
        + "".join(f"{line},\n" for line in lines)
        + f"    ],\n    source: (position: ({source}, 0, {source})),\n"
        f"    listener: (position: ({listener}, 0, {listener}), radius: 0.5),\n)\n"
    )

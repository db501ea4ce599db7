"""Writes the rounds of measure.py as Markdown."""

import os
from pathlib import Path
from statistics import median

from common.markdown import machine, processor, short, table
from common.program import first_line
from peers import environment, scenes

ITERATIONS = 8
LIMIT = "closed form, C++ AVX2"
SPHERE = "sphere tracing, C++ AVX2"
EMBREE = "Embree 3, packets of 16"


class Rounds:
    """The measurements, by peer (name and waves) and scene."""

    def __init__(self, rows):
        self.timed = [row for row in rows if "milliseconds" in row]
        self.told = [row for row in rows if "hits" in row]
        self.scenes = [name for name in scenes.NAMES if any(row["scene"] == name for row in self.timed)]
        self.peers = list(dict.fromkeys((row["peer"], row["waves"]) for row in self.timed))

    def of(self, peer, scene):
        return [row for row in self.timed if (row["peer"], row["waves"]) == peer and row["scene"] == scene]

    def largest(self, name):
        """The peer of that name with the most waves."""
        found = [peer for peer in self.peers if peer[0] == name]
        return max(found, key=lambda peer: peer[1], default=None)

    def smallest(self, name):
        found = [peer for peer in self.peers if peer[0] == name]
        return min(found, key=lambda peer: peer[1], default=None)

    def rates(self, peer, scene, part=None):
        """Millions of waves times iterations per second, by round, for one part of a frame or the whole frame."""
        rows = [row for row in self.of(peer, scene) if part is None or "parts" in row]
        times = {row["round"]: row["parts"][part] if part else row["milliseconds"] for row in rows}
        return {at: rate(peer[1], time) for at, time in times.items()}

    def ratio(self, one, other, scene, part=None):
        """The speed relative to the other peer: the median over the rounds that include both."""
        if one is None or other is None:
            return None
        ours, theirs = self.rates(one, scene, part), self.rates(other, scene)
        shared = [ours[at] / theirs[at] for at in ours if at in theirs]
        return median(shared) if shared else None


def rate(waves, milliseconds):
    return waves * ITERATIONS / milliseconds / 1e3


def markdown(rows, missing, work, echomarch, quick):
    rounds = Rounds(rows)
    count = len({row["round"] for row in rounds.timed})
    parts = [
        "# Beside other programs",
        f"`scripts/peers.sh` on `{renderer(rows)}`, one core of {processor()}: {count} interleaved round"
        + ("" if count == 1 else "s")
        + (", with few waves: this is a trial, and its figures are not reliable." if quick else "."),
        "The scenes are given in metres, from a corner of the room. A is a room of 30 × 20 × 30 with the source at "
        "(7, 5, 9) and the listener, with radius 1, at (22, 8, 19). B has two additional walls (x 12 … 13, z 0 … 18 "
        "and x 18 … 19, z 12 … 30, from floor to ceiling) and three pillars of radius 1 at x, z = (6, 22), (15.5, "
        "15), (24, 8). B16 … B1024 have 16 … 1024 pillars of radius 0.3 on an even grid instead; B1024 lacks the "
        f"pillar at the position of the source. All programs trace the same lattice of directions for {ITERATIONS} "
        "iterations; waves that reach the listener stop.",
        "## Rates",
        f"Rates are in million waves times iterations per second: waves × {ITERATIONS} divided by the time of a whole "
        "frame. A frame includes the generation of directions, the tracing of waves and the sum of arrivals. Each "
        "cell has the median over the rounds, and in brackets the smallest and the largest rate. *its march* is the "
        "part between initialise and pan, or the whole pass if a frame is drawn as one pass.",
        rates_table(rounds),
        "## Ratios",
        "A ratio compares the rates of one round. Each cell has the median over the rounds.",
        ratios_table(rounds),
        "## Memory",
        "The table gives the maximum resident set of the process, in MiB.",
        memory_table(rounds),
        "## Waves heard, by order",
        "The tables count the heard waves by the number of previous reflections. They check that all programs do the "
        "same work. From about the fourth reflection on, pillars have amplified the differences of rounding: the "
        "counts agree, but single waves may differ. Pyroomacoustics approximates cylinders by prisms, and does not "
        "end a ray that was heard.",
        hits_tables(rounds),
        "## What ran",
        versions(rows, missing, work, echomarch),
    ]
    return "\n\n".join(parts) + "\n"


def label(peer):
    return f"{peer[0]}, {peer[1]:,} waves"


def rates_table(rounds):
    def cell(rates):
        values = list(rates.values())
        if not values:
            return "–"
        middle = f"**{short(median(values))}**"
        return middle if len(values) == 1 else f"{middle} ({short(min(values))} … {short(max(values))})"

    lines = []
    for peer in rounds.peers:
        lines.append([label(peer)] + [cell(rounds.rates(peer, scene)) for scene in rounds.scenes])
        if peer[0].startswith("echomarch"):
            marched = [cell(rounds.rates(peer, scene, "march")) for scene in rounds.scenes]
            lines.append(["– its march"] + marched)
    return table(["", *rounds.scenes], lines)


def ratios_table(rounds):
    hybrid, march = rounds.largest("echomarch hybrid"), rounds.largest("echomarch march")
    few, few_march = rounds.smallest("echomarch hybrid"), rounds.smallest("echomarch march")
    embree, limit, sphere = (rounds.largest(name) for name in (EMBREE, LIMIT, SPHERE))
    wanted = [
        ("hybrid / Embree", hybrid, embree, None),
        ("hybrid, its march / Embree", hybrid, embree, "march"),
        ("hybrid / closed form in AVX2", hybrid, limit, None),
        ("hybrid, its march / closed form in AVX2", hybrid, limit, "march"),
        ("march / Embree", march, embree, None),
        ("march / sphere tracing in AVX2", march, sphere, None),
        ("hybrid, few waves / many", few, hybrid, None),
        ("march, few waves / many", few_march, march, None),
        ("Embree / closed form in AVX2", embree, limit, None),
    ]
    lines = []
    for name, one, other, part in wanted:
        found = [rounds.ratio(one, other, scene, part) for scene in rounds.scenes]
        lines.append([name] + [short(value) for value in found])
    return table(["", *rounds.scenes], lines)


def memory_table(rounds):
    def cell(rows):
        return short(median(row["kibibytes"] for row in rows) / 1024) if rows else "–"

    lines = [[label(peer)] + [cell(rounds.of(peer, scene)) for scene in rounds.scenes] for peer in rounds.peers]
    return table(["", *rounds.scenes], lines)


def hits_tables(rounds):
    tables = []
    for scene in rounds.scenes:
        told = {(row["peer"], row["waves"]): row["hits"] for row in rounds.told if row["scene"] == scene}
        lines = [[label(peer), *map(str, hits), str(sum(hits))] for peer, hits in told.items()]
        heads = [f"{scene}: order", *map(str, range(ITERATIONS)), "all"]
        tables.append(table(heads, lines))
    return "\n\n".join(tables)


def renderer(rows):
    return next((row["renderer"] for row in rows if "renderer" in row), "unknown")


def versions(rows, missing, work, echomarch):
    said = [
        of_echomarch(rows, echomarch),
        of_compiler(),
        f"- Embree: {package('libembree-dev')}. Walls and boxes are quads. Pillars are user geometry that intersects "
        "eight rays with the circle at a time (the fastest of three variants, see embree.cpp). The listener is "
        "intersected in closed form outside of Embree. Embree uses AVX-512 if the processor supports it",
        f"- pyroomacoustics: {pyroom_version(work)}. A is its shoe box. B is its general room, with pillars as "
        "prisms of 16 sides",
        f"- {machine()}",
    ]
    said += left_out(missing)
    return "\n".join(said)


def of_echomarch(rows, echomarch):
    return f"- echomarch: {first_line([echomarch, '--version'])}, {commit()}; {renderer(rows)}, one thread"


def of_compiler():
    return f"- C++: {first_line([os.environ.get('CXX', 'g++'), '--version'])}, `-O3 -mavx2 -mfma`"


def left_out(missing):
    return [f"- left out, because it could not be installed or built: {name}" for name in missing]


def commit():
    """The commit that was built; the commit of a program that the caller names is unknown."""
    if "ECHOMARCH" in os.environ:
        return "a program named by the caller"
    return "commit " + first_line(["git", "-C", Path(__file__).parent, "describe", "--always", "--dirty"])


def package(name):
    return f"{name} {first_line(['dpkg-query', '-W', '-f', '${Version}', name])}"


def pyroom_version(work):
    query = "import importlib.metadata as m; print(m.version('pyroomacoustics'))"
    return first_line([environment.python(work), "-c", query])

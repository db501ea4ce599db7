"""Writes the rounds of marched/measure.py as Markdown."""

from statistics import median

from common.markdown import machine, processor, short, table
from peers.marched.names import DESIGN, EXACT, ITERATIONS, NAIVE, NAMES, SORTED, TWIN
from peers.report import left_out, of_compiler, of_echomarch, renderer


class Rounds:
    """The measurements, by peer and scene."""

    def __init__(self, rows):
        self.timed = [row for row in rows if "seconds" in row]
        # The last comparison counts if there are several.
        self.errors = {(row["scene"], row["iterations"], row["peer"]): row for row in rows if "heard" in row}
        self.scenes = [name for name in NAMES if any(row["scene"] == name for row in self.timed)]
        self.peers = list(dict.fromkeys(row["peer"] for row in self.timed))

    def rates(self, peer, scene):
        """Millions of waves times iterations per processor second, by round."""
        rows = [row for row in self.timed if (row["peer"], row["scene"]) == (peer, scene)]
        return {row["round"]: row["waves"] * ITERATIONS / row["seconds"] / 1e6 for row in rows}

    def ratio(self, one, other, scene):
        """The speed relative to the other peer: the median over the rounds that include both."""
        ours, theirs = self.rates(one, scene), self.rates(other, scene)
        shared = [ours[at] / theirs[at] for at in ours if at in theirs]
        return median(shared) if shared else None


def markdown(rows, missing, echomarch, quick):
    rounds = Rounds(rows)
    count = len({row["round"] for row in rounds.timed})
    waves = max((row["waves"] for row in rounds.timed), default=0)
    parts = [
        "# Marched fields beside other programs",
        f"`scripts/peers.sh --marched` on `{renderer(rows)}`, one core of {processor()}: {count} interleaved round"
        + ("" if count == 1 else "s")
        + (", with few waves: this is a trial, and its figures are not reliable." if quick else "."),
        f"All programs trace the same {waves:,} random start directions for {ITERATIONS} iterations, with one thread. "
        "`cave` is the built-in scene. `gyroid` and `ground` (five octaves of noise) are users' texts in a room; "
        "`gyroid-gradient` is `gyroid` with a stated gradient and bend. Texts and scenes are in `scripts/peers/marched/`.",
        "The *60-line tracer* is the tracer that a user would write. Its steps are the values of the field, until the "
        "value is below a millimetre. It computes the normal from six values, and traces all iterations in one pass. "
        "The same tracer in C++ with AVX2 shows the speed of such steps on this processor without OpenGL. The *design "
        "by the line* uses more information: the slope of the value and a bound of its second derivative along the "
        "wave's line, and the places where the line leaves each convex part of the air. With *sorted starts* "
        "neighbouring waves start in neighbouring directions.",
        "## Rates",
        "Rates are in million waves times iterations per second of processor time, for whole frames. Each cell has "
        "the median over the rounds, and in brackets the smallest and the largest rate.",
        rates_table(rounds),
        "## Ratios",
        "A ratio compares the rates of one round. Each cell has the median over the rounds.",
        ratios_table(rounds),
        "## Errors",
        "Waves are compared with the waves of `reference.cpp`. This program steps by the value in `f64` to 1e-12 m "
        "and shares no code with Echomarch. *Other status* is the share of waves whose status (heard, lost, or the "
        "surface) differs from that of the exact wave. *First hit* and *end* are the distances in metres from the "
        "exact point after the first and after the last iteration: the median and the 99 % quantile.",
        errors_tables(rounds),
        "## What ran",
        "\n".join([of_echomarch(rows, echomarch), of_compiler(), f"- {machine()}", *left_out(missing)]),
    ]
    return "\n\n".join(parts) + "\n"


def rates_table(rounds):
    def cell(rates):
        values = list(rates.values())
        if not values:
            return "–"
        middle = f"**{short(median(values))}**"
        return middle if len(values) == 1 else f"{middle} ({short(min(values))} … {short(max(values))})"

    lines = [[peer] + [cell(rounds.rates(peer, scene)) for scene in rounds.scenes] for peer in rounds.peers]
    return table(["", *rounds.scenes], lines)


def ratios_table(rounds):
    hybrid, march = "echomarch hybrid", "echomarch march"
    wanted = [
        ("hybrid / 60-line tracer", hybrid, NAIVE),
        ("march / 60-line tracer", march, NAIVE),
        ("hybrid / 60-line tracer, sorted starts", hybrid, NAIVE + SORTED),
        ("hybrid / 60-line tracer in AVX2", hybrid, TWIN),
        ("hybrid / design by the line", hybrid, DESIGN),
        ("hybrid / design by the line, sorted starts", hybrid, DESIGN + SORTED),
        ("60-line tracer in AVX2 / in GLSL", TWIN, NAIVE),
    ]
    lines = []
    for name, one, other in wanted:
        lines.append([name] + [short(rounds.ratio(one, other, scene)) for scene in rounds.scenes])
    return table(["", *rounds.scenes], lines)


def errors_tables(rounds):
    return "\n\n".join(errors_table(rounds, scene) for scene in rounds.scenes)


def errors_table(rounds, scene):
    def row(iterations, peer):
        return rounds.errors.get((scene, iterations, peer))

    exact = row(ITERATIONS, EXACT)
    lines = [["exact", "–", str(exact["heard"]), str(exact["lost"])] + 4 * ["–"]] if exact else []
    for peer in rounds.peers:
        first, last = row(1, peer), row(ITERATIONS, peer)
        if first and last:
            points = [f"{row[key]:.2g}" for row in (first, last) for key in ("median", "p99")]
            lines.append([peer, f"{100 * last['differs']:.3f}", str(last["heard"]), str(last["lost"]), *points])
    heads = ["other status, %", "heard", "lost", "first hit: median, m", "99 %", "end: median, m", "99 %"]
    return table([scene, *heads], lines)

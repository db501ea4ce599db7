"""Time and memory against waves, iterations and surfaces."""

import sys
from pathlib import Path
from statistics import median

from common import plot
from common.markdown import short, table
from common.program import trace
from report import hall_scene

SCENE = "corner"
ITERATIONS = 8
# Number of waves in the sweeps over iterations and surfaces: by default, and with --quick.
WAVES, FEW_WAVES = 65_536, 1_024
# Maximum of waves times iterations over all timed frames of a count: short frames are repeated more often.
MOST_WORK = 8 * WAVES * ITERATIONS
# A count is on the straight line if its cost per wave and iteration is within this share of the usual cost.
OFF_THE_LINE = 0.25

LEGENDS = {
    "waves": f"`{SCENE}`, {ITERATIONS} iterations. *ns* is the time of a frame per wave and iteration, in nanoseconds. "
    "*init … read* are the shares of initialise, march, pan and read-back in the frame, in percent. *MiB* is the "
    "maximum memory of the process; the memory of a graphics card is not included.",
    "iterations": f"`{SCENE}`, {{waves:,}} waves.",
    "surfaces": f"The scene is a hall of pillars 4 m apart, with its room; {{waves:,}} waves, {ITERATIONS} iterations. "
    "*start* is the time in seconds to load the scene, to compile its shaders, and to trace its first frame.",
}


class Sweep:
    """The counts of one growing quantity, and the measurements of each profile at each count."""

    def __init__(self, name, counts, profiles, waves):
        self.name, self.counts, self.profiles, self.waves = name, counts, profiles, waves
        self.found = {}

    def measure(self, program, folder, one_core):
        for count in self.counts:
            scene, waves, iterations = SCENE, self.waves, ITERATIONS
            if self.name == "waves":
                waves = count
            elif self.name == "iterations":
                iterations = count
            else:
                scene = Path(folder) / f"hall-{count}.ron"
                scene.write_text(hall_scene.ron(count))
            for profile in self.profiles:
                print(f"{self.name}: {count}, {profile}", file=sys.stderr)
                frames = min(9, max(1, MOST_WORK // (waves * iterations)))
                found = trace(
                    [program, "trace", scene],
                    one_core,
                    profile=profile,
                    waves=waves,
                    iterations=iterations,
                    repeat=frames,
                )
                found["ns"] = 1e6 * found["milliseconds"]["total"] / (waves * iterations)
                found["start"] = found["seconds"] - 1e-3 * frames * found["milliseconds"]["total"]
                self.found[count, profile] = found

    def of(self, profile):
        return [self.found[count, profile] for count in self.counts]

    def usual(self, profile):
        """The usual cost per wave and iteration: the median over the upper half of the counts."""
        costs = [found["ns"] for found in self.of(profile)]
        return median(costs[len(costs) // 2 :])

    def on_the_line(self, profile):
        """The counts at which the cost is near the usual cost, as text."""
        usual = self.usual(profile)
        near = [
            count for count, found in zip(self.counts, self.of(profile)) if abs(found["ns"] / usual - 1) <= OFF_THE_LINE
        ]
        words = ", ".join(f"{count:,}" for count in near) or "none"
        return f"- `{profile}`: {short(usual)} ns, within {OFF_THE_LINE:.0%} at the counts {words}"

    def markdown(self):
        heads = [self.name]
        for profile in self.profiles:
            heads += [f"{profile}, ms", "ns", "MiB"]
            if self.name == "waves":
                heads += ["init", "march", "pan", "read"]
            if self.name == "surfaces":
                heads += ["start"]
        lines = [
            [f"{count:,}", *(cell for p in self.profiles for cell in self.cells(count, p))] for count in self.counts
        ]
        legend = LEGENDS[self.name].format(waves=self.waves)
        parts = [f"### {self.name.capitalize()}", legend, table(heads, lines)]
        if self.name != "surfaces":
            told = [self.on_the_line(profile) for profile in self.profiles]
            parts.append("Time per wave and iteration (median of the upper half of the counts):\n\n" + "\n".join(told))
        return "\n\n".join(parts)

    def cells(self, count, profile):
        found = self.found[count, profile]
        time = found["milliseconds"]
        memory = found["kibibytes"]
        cells = [short(time["total"]), short(found["ns"]), short(memory and memory / 1024)]
        if self.name == "waves":
            shares = [time[part] / time["total"] for part in ("initialise", "march", "pan", "read_back")]
            cells += [f"{share:.0%}"[:-1] for share in shares]
        if self.name == "surfaces":
            cells.append(short(found["start"]))
        return cells

    def times(self):
        lines = {
            profile: [(count, found["milliseconds"]["total"]) for count, found in zip(self.counts, self.of(profile))]
            for profile in self.profiles
        }
        return (f"time by {self.name}", self.name, "milliseconds a frame", lines)

    def memory(self):
        """The memory used at each count; None if unknown."""
        lines = {
            profile: [(count, (found["kibibytes"] or 0) / 1024) for count, found in zip(self.counts, self.of(profile))]
            for profile in self.profiles
        }
        is_known = all(value > 0 for line in lines.values() for _, value in line)
        return (f"memory by {self.name}", self.name, "MiB", lines) if is_known else None


def powers(first, factor, last):
    counts = [first]
    while counts[-1] * factor < last:
        counts.append(counts[-1] * factor)
    return [*counts, last] if counts[-1] < last else counts


def sweeps(quick, profiles, only):
    """The sweeps over waves (up to 16.7 million), iterations (up to 1024) and surfaces (up to 65,536, because the size
    of scene files is limited); with lower limits when quick."""
    limits = {"waves": 16_777_216, "iterations": 1_024, "surfaces": 65_536}
    if quick:
        limits = {"waves": 1_024, "iterations": 4, "surfaces": 32}
    first = {"waves": 64, "iterations": 1, "surfaces": 1}
    waves = FEW_WAVES if quick else WAVES
    made = [Sweep(name, powers(first[name], 4, limits[name]), profiles, waves) for name in limits]
    return [sweep for sweep in made if sweep.name in only]


def picture(measured, renderer):
    """The plot, with times above and memory below."""
    panels = [sweep.times() for sweep in measured] + [sweep.memory() for sweep in measured]
    known = [panel for panel in panels if panel is not None]
    return plot.svg(f"Growth, on {renderer}", known, columns=len(measured))

"""Runs the peers of the marched scenes in interleaved rounds; called by scripts/peers.sh --marched.

All programs trace the same waves, whose start directions Echomarch draws. A round runs every peer on every
scene, scene by scene, each as a separate process on one core with one thread. Times are processor seconds.
"""

import argparse
import resource
import sys
from dataclasses import asdict
from pathlib import Path
from statistics import median

from common import program
from peers import environment
from peers.log import Log, chosen_scenes
from peers.marched import report, waves
from peers.marched.names import DESIGN, EXACT, ITERATIONS, NAIVE, NAMES, SORTED, TWIN

HERE = Path(__file__).resolve().parent
SEED = 1
# Frames of Echomarch that are traced before the timed frames. The first frame includes the compilation.
WARM = 2
# Processor seconds of the timed frames of Echomarch: the time of start and compilation, which is subtracted,
# varies by some hundredths of a second.
TIMED, TIMED_QUICK = 4.0, 0.5


class Peer:
    """A program to measure. `seconds` takes a scene and returns a row with the processor seconds of a frame;
    `ends` takes a scene and a number of iterations, and returns the waves' ends."""

    def __init__(self, name, seconds, ends, scenes=NAMES):
        self.name, self.seconds, self.ends, self.scenes = name, seconds, ends, scenes


class Bench:
    """The programs, and the folder with their files."""

    def __init__(self, work, echomarch, quick):
        self.built, self.work, self.echomarch = work, work / "marched", echomarch
        self.count, self.timed = (16_384, TIMED_QUICK) if quick else (65_536, TIMED)
        self.compiled = set()
        self.work.mkdir(parents=True, exist_ok=True)
        self.directions, self.sorted = self.work / "directions", self.work / "sorted"
        starts, _ = self.dump("cave", "hybrid", 1)
        waves.write(self.directions, starts)
        waves.write(self.sorted, waves.neighbours_together(starts))

    # Echomarch.

    def trace(self, scene, profile, iterations, **options):
        file = scene if scene == "cave" else HERE / f"{scene}.ron"
        options |= {"waves": self.count, "iterations": iterations, "seed": SEED, "profile": profile}
        return program.trace([self.echomarch, "trace", file], True, **options)

    def dump(self, scene, profile, iterations):
        file = self.work / "waves.csv"
        self.trace(scene, profile, iterations, dump_waves=file)
        return waves.dumped(file)

    def own(self, profile):
        def processor(scene, repeat):
            before = children_seconds()
            found = self.trace(scene, profile, ITERATIONS, repeat=repeat)
            return children_seconds() - before, found

        def seconds(scene):
            # The driver caches compiled shaders for later processes.
            if (scene, profile) not in self.compiled:
                processor(scene, WARM)
                self.compiled.add((scene, profile))
            few, found = processor(scene, WARM)
            frames = max(2, round(1e3 * self.timed / found["milliseconds"]["total"]))
            many, found = processor(scene, WARM + frames)
            return {"seconds": (many - few) / frames, "renderer": found["renderer"]}

        def ends(scene, iterations):
            return self.dump(scene, profile, iterations)[1]

        return Peer(f"echomarch {profile}", seconds, ends)

    # Other programs, which have the interface of waves.h.

    def run(self, command, scene, iterations, frames, directions):
        file = self.work / "ends"
        found, _ = program.run([*command, scene, directions, iterations, frames, file], one_core=True)
        return found, file

    def other(self, name, command, frames, directions=None, scenes=NAMES):
        directions = directions or self.directions

        def seconds(scene):
            found, _ = self.run(command, scene, ITERATIONS, frames, directions)
            return {**found, "seconds": median(found["seconds"])}

        def ends(scene, iterations):
            _, file = self.run(command, scene, iterations, 1, directions)
            objects = self.work / "objects"
            program.run_silently([self.built / "reference", scene, file, objects])
            return waves.with_objects(waves.read(file, waves.FOUR_FLOATS), waves.read(objects, "f"))

        return Peer(name, seconds, None if directions == self.sorted else ends, scenes)

    def exact(self, scene, iterations):
        file = self.work / "exact"
        program.run_silently([self.built / "reference", scene, self.directions, iterations, file])
        return waves.read(file, waves.FOUR_DOUBLES)

    def peers(self, quick):
        """The peers that can be run, and the names of those that cannot."""
        frames = 4 if quick else 12
        python, naive = environment.python(self.built), HERE / "naive.py"
        twin, design = self.built / "by_value", self.built / "by_line"
        has_moderngl = environment.has_package(self.built, "moderngl")
        all_peers = [
            (has_moderngl, self.other(NAIVE, [python, naive], frames)),
            (has_moderngl, self.other(NAIVE + SORTED, [python, naive], frames, self.sorted)),
            (twin.exists(), self.other(TWIN, [twin], frames)),
            (design.exists(), self.other(DESIGN, [design], 4 * frames, scenes=["cave"])),
            (design.exists(), self.other(DESIGN + SORTED, [design], 4 * frames, self.sorted, ["cave"])),
            (True, self.own("hybrid")),
            (True, self.own("march")),
        ]
        there = [peer for runs, peer in all_peers if runs]
        return there, [peer.name for runs, peer in all_peers if not runs]


def children_seconds():
    """Processor seconds of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure_round(at, chosen, bench, there, record):
    for scene in chosen:
        for peer in there:
            if scene not in peer.scenes:
                continue
            print(f"round {at}: {scene}, {peer.name}", file=sys.stderr)
            found = peer.seconds(scene)
            record({"round": at, "scene": scene, "peer": peer.name, "waves": bench.count, **found})


def measure_errors(chosen, bench, there, record):
    """Compares the ends after the first and after the last iteration with the exact waves."""
    for scene in chosen:
        for iterations in (1, ITERATIONS):
            exact = bench.exact(scene, iterations)
            heard, lost = sum(wave[3] == 0 for wave in exact), sum(wave[3] < 0 for wave in exact)
            about = {"scene": scene, "iterations": iterations}
            record({**about, "peer": EXACT, "heard": heard, "lost": lost})
            for peer in there:
                if peer.ends and scene in peer.scenes:
                    print(f"errors: {scene}, {iterations} iterations, {peer.name}", file=sys.stderr)
                    found = waves.compare(peer.ends(scene, iterations), exact)
                    record({**about, "peer": peer.name, **asdict(found)})


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--marched", action="store_true", help="chooses this module (an option of scripts/peers.sh)")
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--echomarch", type=Path, required=True)
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--scenes", type=str.split, default=NAMES)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--add", action="store_true")
    parser.add_argument("-o", dest="output", type=Path)
    chosen = parser.parse_args()
    chosen_scenes(parser, chosen.scenes, NAMES)
    chosen.rounds = chosen.rounds or (2 if chosen.quick else 5)
    return chosen


def main():
    asked = arguments()
    bench = Bench(asked.work, asked.echomarch, asked.quick)
    there, missing = bench.peers(asked.quick)
    log = Log(asked.work / ("marched-quick.jsonl" if asked.quick else "marched.jsonl"), asked.add)
    for at in log.rounds(asked.rounds):
        measure_round(at, asked.scenes, bench, there, log.record)
    measure_errors(asked.scenes, bench, there, log.record)
    text = report.markdown(log.rows, missing, asked.echomarch, asked.quick)
    name = f"marched-peers-{program.slug(report.renderer(log.rows))}.md"
    output = asked.output or HERE.parents[2] / "docs/benchmarks" / name
    output.write_text(text)
    print(f"written: {output}")


if __name__ == "__main__":
    main()

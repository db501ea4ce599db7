"""Runs the peers in interleaved rounds and writes their results; called by scripts/peers.sh.

A round runs every peer on every scene, scene by scene, each as a separate process on one core.
A peer traces a warm-up frame and then several timed frames, whose median is its time in the
round.
"""

import argparse
import sys
from pathlib import Path
from statistics import median

from common import program
from peers import environment, report, scenes
from peers.log import Log, chosen_scenes

ITERATIONS = 8
HERE = Path(__file__).resolve().parent


class Peer:
    """A program to measure. `command` takes a scene, a number of waves and a number of timed frames."""

    def __init__(self, name, command, scenes, waves, frames=3):
        self.name, self.command, self.scenes = name, command, scenes
        self.waves, self.frames = waves, frames


def peers(work, echomarch, quick):
    """The peers that can be run, and the names of those that cannot."""
    many, few, fewest = (65_536, 4_096, 2_048) if quick else (1_048_576, 65_536, 65_536)

    def compiled(name):
        return lambda scene, waves, frames: plain([work / name], work, scene, waves, frames)

    def pyroom(scene, waves, frames):
        return plain([environment.python(work), HERE / "pyroom.py"], work, scene, waves, frames)

    def own(profile):
        return lambda scene, waves, frames: trace(echomarch, work, scene, profile, waves, ITERATIONS, frames)

    two = ["A", "B"]
    has_pyroom = environment.has_package(work, "pyroomacoustics")
    all_peers = [
        ((work / "closed_form").exists(), Peer("closed form, C++ AVX2", compiled("closed_form"), two, many, 9)),
        ((work / "sphere_tracing").exists(), Peer("sphere tracing, C++ AVX2", compiled("sphere_tracing"), two, many)),
        ((work / "embree").exists(), Peer("Embree 3, packets of 16", compiled("embree"), scenes.NAMES, many)),
        (has_pyroom, Peer("pyroomacoustics, shoe box", pyroom, ["A"], many)),
        (has_pyroom, Peer("pyroomacoustics, polygons", pyroom, ["B"], fewest, 1)),
        (True, Peer("echomarch hybrid", own("hybrid"), scenes.NAMES, many)),
        (True, Peer("echomarch hybrid", own("hybrid"), scenes.NAMES, few, 9)),
        (True, Peer("echomarch march", own("march"), two, many)),
        (True, Peer("echomarch march", own("march"), scenes.NAMES[2:], many, 1)),
        (True, Peer("echomarch march", own("march"), scenes.NAMES, few, 9)),
    ]
    there = [peer for runs, peer in all_peers if runs]
    return there, [peer.name for runs, peer in all_peers if not runs]


def plain(command, work, scene, waves, frames):
    """A peer with the interface of scripts/peers/peer.h."""
    arguments = [work / "scenes" / f"{scene}.txt", waves, ITERATIONS, frames]
    said, kibibytes = program.run(command + arguments, one_core=True)
    return {"milliseconds": median(said["milliseconds"]), "hits": said["hits"], "kibibytes": kibibytes}


def trace(echomarch, work, scene, profile, waves, iterations, frames):
    command = [echomarch, "trace", work / "scenes" / f"{scene}.ron"]
    options = {"waves": waves, "iterations": iterations, "repeat": frames, "profile": profile}
    found = program.trace(command, True, directions="fibonacci", seed=scenes.SEED, **options)
    parts = found["milliseconds"]
    return {**found, "milliseconds": parts["total"], "parts": parts}


def hits_by_order(echomarch, work, scene, profile, waves):
    """The hits by order. The hits of an order are the hits after n iterations minus the hits after n − 1 iterations."""
    counts = range(1, ITERATIONS + 1)
    heard = [trace(echomarch, work, scene, profile, waves, count, 0)["heard"] for count in counts]
    return [after - before for before, after in zip([0] + heard, heard)]


def measure_round(at, chosen, there, record):
    for scene in chosen:
        for peer in there:
            if scene not in peer.scenes:
                continue
            print(f"round {at}: {scene}, {peer.name}, {peer.waves} waves", file=sys.stderr)
            found = peer.command(scene, peer.waves, peer.frames)
            record({"round": at, "scene": scene, "peer": peer.name, "waves": peer.waves, **found})


def check_hits(there, chosen, echomarch, work, rows, record):
    """Records the hits by order of echomarch once; the other programs print theirs in each round. `march` is
    slow among many surfaces, so its hits are counted only in A and B."""
    known = {(row["scene"], row["peer"], row["waves"]) for row in rows if "hits" in row}
    for profile in ("hybrid", "march"):
        name = f"echomarch {profile}"
        waves = max(peer.waves for peer in there if peer.name == name)
        for scene in chosen:
            is_slow = profile == "march" and scene not in ("A", "B")
            if is_slow or (scene, name, waves) in known:
                continue
            print(f"hits by order: {scene}, {name}", file=sys.stderr)
            hits = hits_by_order(echomarch, work, scene, profile, waves)
            record({"scene": scene, "peer": name, "waves": waves, "hits": hits})


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--echomarch", type=Path, required=True)
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--scenes", type=str.split, default=scenes.NAMES)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--add", action="store_true")
    parser.add_argument("-o", dest="output", type=Path)
    chosen = parser.parse_args()
    chosen_scenes(parser, chosen.scenes, scenes.NAMES)
    chosen.rounds = chosen.rounds or (2 if chosen.quick else 5)
    return chosen


def main():
    asked = arguments()
    scenes.write(asked.work / "scenes")
    there, missing = peers(asked.work, asked.echomarch, asked.quick)
    log = Log(asked.work / ("rounds-quick.jsonl" if asked.quick else "rounds.jsonl"), asked.add)
    for at in log.rounds(asked.rounds):
        measure_round(at, asked.scenes, there, log.record)
    check_hits(there, asked.scenes, asked.echomarch, asked.work, log.rows, log.record)
    text = report.markdown(log.rows, missing, asked.work, asked.echomarch, asked.quick)
    name = f"peers-{program.slug(report.renderer(log.rows))}.md"
    output = asked.output or HERE.parents[1] / "docs/benchmarks" / name
    output.write_text(text)
    print(f"written: {output}")


if __name__ == "__main__":
    main()

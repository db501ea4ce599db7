"""Compares the waves of several renderers with those of the first, as Markdown; called by scripts/renderers.sh."""

import argparse
import array
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from common.markdown import machine, table
from common.program import first_line

ZINK = "LIBGL_ALWAYS_SOFTWARE=1 MESA_LOADER_DRIVER_OVERRIDE=zink"
OTHERS = {
    "OpenGL ES": "--gl gles",
    "OSMesa": "--gl osmesa",
    "zink": ZINK,
    "zink, OpenGL ES": f"{ZINK} --gl gles",
    "softpipe": "LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=softpipe --waves 1024",
}
SCENES = [
    ("corner", "hybrid"),
    ("corner", "march"),
    ("corner", "thesis"),
    ("obstacles", "hybrid"),
    ("obstacles", "march"),
    ("obstacles", "thesis"),
    ("colonnade", "hybrid"),
    ("cave", "hybrid"),
    ("morphing-room", "hybrid"),
    ("menger", "hybrid"),
    ("menger", "thesis"),
]
MOVED = 1e-6  # metres: about a rounding of a coordinate
FAR = 0.01  # metres: more than rounding causes in a few reflections without chaos


class Waves:
    """The waves that a program has dumped: start, position, direction and status of each."""

    def __init__(self, file):
        with open(file, newline="") as opened:
            rows = csv.reader(opened)
            next(rows)
            self.rows = [[float(cell) for cell in row[1:]] for row in rows]

    def bits(self, index):
        return array.array("f", self.rows[index]).tobytes()

    def status(self, index):
        return self.rows[index][9]

    def apart(self, other, index):
        """The distance in metres between the ends of a wave; None if the wave ended at another object."""
        if self.status(index) != other.status(index):
            return None
        return math.dist(self.rows[index][3:6], other.rows[index][3:6])


class Renderer:
    def __init__(self, echomarch, settings):
        self.echomarch, self.environment, self.words = echomarch, dict(os.environ), []
        for word in settings.split():
            name, equals, value = word.partition("=")
            if equals and not self.words and not name.startswith("-"):
                self.environment[name] = value
            else:
                self.words.append(word)

    def trace(self, scene, profile, waves, iterations, file):
        """The waves and the report of the program. Options in `words` override those of the arguments."""
        options = {"--waves": str(waves)}
        options |= dict(zip(self.words[::2], self.words[1::2]))
        command = [str(self.echomarch), "trace", str(scene), "--profile", profile]
        command += ["--iterations", str(iterations), "--dump-waves", str(file), "--json", "--quiet"]
        command += [word for pair in options.items() for word in pair]
        ran = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        if ran.returncode != 0:
            raise RuntimeError(ran.stderr.strip() or f"exit status {ran.returncode}")
        return Waves(file), json.loads(ran.stdout)


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--echomarch", type=Path, required=True)
    parser.add_argument("--waves", type=int, default=65536)
    parser.add_argument("--iterations", type=int, default=8)
    parser.add_argument("--with", dest="more", action="append", default=[])
    parser.add_argument("-o", dest="output", type=Path)
    asked = parser.parse_args()
    if unnamed := [more for more in asked.more if "=" not in more]:
        parser.error(f"--with takes NAME=SETTINGS, not {unnamed[0]}")
    return asked


def source_of(scene):
    """The position of the source in the scene's file."""
    text = Path(f"examples/scenes/{scene}.ron").read_text()
    place = re.search(r"source: (?:Source)?\(position: \(([^)]*)\)", text)
    return [float(number) for number in place[1].split(",")]


def moved(scene, folder):
    """Writes the scene with its source moved to a file, and returns the file."""
    x, y, z = source_of(scene)
    base = Path(f"examples/scenes/{scene}.ron").resolve()
    file = Path(folder) / "moved.ron"
    file.write_text(f'Scene(base: "{base}", source: Source(position: ({x + MOVED:.7f}, {y}, {z})))')
    return file


def elsewhere(first, second):
    """The number of waves that end at another object, or more than FAR apart."""
    apart = [first.apart(second, index) for index in range(len(second.rows))]
    return sum(gap is None or gap > FAR for gap in apart)


class Traced:
    """The first renderer's waves in each scene, as it is and with the source moved; each is traced only once."""

    def __init__(self, renderer, asked, folder):
        self.renderer, self.asked, self.folder = renderer, asked, Path(folder)
        self.known = {}

    def waves(self, scene, profile, waves, iterations):
        key = (scene, profile, waves, iterations)
        if key not in self.known:
            file = f"examples/scenes/{scene}.ron"
            self.known[key] = self.renderer.trace(file, profile, waves, iterations, self.folder / "first.csv")[0]
        return self.known[key]

    def by_chance(self, scene, profile, waves):
        """The number of waves that end elsewhere when the source is moved."""
        key = (scene, profile, waves)
        if key not in self.known:
            iterations = self.asked.iterations
            file = moved(scene, self.folder)
            there = self.renderer.trace(file, profile, waves, iterations, self.folder / "moved.csv")[0]
            self.known[key] = elsewhere(self.waves(*key, iterations), there)
        return self.known[key]


HEADS = [
    "scene",
    "waves",
    "starts off by",
    "after 1 iteration off by, m",
    "at another object",
    "same bits at the end",
    "end elsewhere",
    "by chance",
    "not finite",
]


def line(first, other, scene, profile):
    """A row of the table: one scene on another renderer, compared with the first renderer."""
    asked = first.asked
    file = f"examples/scenes/{scene}.ron"
    there, _ = other.trace(file, profile, asked.waves, 1, first.folder / "other.csv")
    end, said = other.trace(file, profile, asked.waves, asked.iterations, first.folder / "other.csv")
    waves = len(there.rows)
    here = first.waves(scene, profile, waves, 1)
    here_end = first.waves(scene, profile, waves, asked.iterations)
    gaps = [here.apart(there, index) for index in range(waves)]
    starts = max(math.dist(a[:3], b[:3]) for a, b in zip(here.rows, there.rows))
    same = sum(here_end.bits(index) == end.bits(index) for index in range(waves))
    cells = [
        f"{scene}, `{profile}`",
        f"{waves:,}",
        f"{starts:.1e}",
        f"{max((gap for gap in gaps if gap is not None), default=0.0):.1e}",
        str(gaps.count(None)),
        f"{same / waves:.1%}",
        str(elsewhere(here_end, end)),
        str(first.by_chance(scene, profile, waves)),
        str(said["not_finite"]),
    ]
    return cells, said["renderer"]


def section(first, name, settings):
    """The table of one renderer, or the reason why there is none."""
    other = Renderer(first.asked.echomarch, settings)
    lines = []
    try:
        for scene, profile in SCENES:
            cells, renderer = line(first, other, scene, profile)
            print(f"{name}: {' | '.join(cells)}", file=sys.stderr)
            lines.append(cells)
    except RuntimeError as error:
        return f"## {name}\n\nNot available here: {error}"
    return f"## {name}\n\n{renderer} (`{settings}`)\n\n{table(HEADS, lines)}"


def main():
    asked = arguments()
    with tempfile.TemporaryDirectory() as folder:
        renderer = Renderer(asked.echomarch, "")
        _, said = renderer.trace("corner", "hybrid", 64, 1, Path(folder) / "first.csv")
        first = Traced(renderer, asked, folder)
        parts = [
            f"# Waves by renderer, against {said['renderer']}",
            f"`scripts/renderers.sh`; {machine()}; {first_line([asked.echomarch, '--version'])}, commit "
            f"{first_line(['git', 'describe', '--always', '--dirty'])}; {asked.iterations} iterations.",
            f"*End elsewhere* is the number of waves that end at another object than on the first renderer, or more "
            f"than {FAR:g} m away. *By chance* is the same number for the first renderer alone, with the source moved "
            f"by {MOVED:g} m.",
        ]
        more = dict(words.split("=", 1) for words in asked.more)
        parts += [section(first, name, settings) for name, settings in (OTHERS | more).items()]
    text = "\n\n".join(parts) + "\n"
    if asked.output:
        asked.output.write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()

"""The report of one renderer as Markdown; called by scripts/gpu-report.sh."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from common.markdown import machine, short, table
from common.program import first_line, slug, trace
from report import growth, operations

# Bytes that each part of a frame reads and writes per wave: a wave takes two texels of RGBA32F, its contribution one.
# A frame that is drawn as one pass writes only the contribution.
BYTES = {"initialise": 32, "march": 64, "pan": 32 + 16, "whole": 16, "read_back": 16}
SCENES = ("shoebox", "corner", "obstacles")
PAPER = "../cost-on-paper.md"


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--echomarch", type=Path, required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--growth", action="store_true")
    parser.add_argument("--one-core", action="store_true")
    parser.add_argument("--profiles", type=lambda text: text.split(","), default=["hybrid", "march", "thesis"])
    parser.add_argument("--sweeps", type=lambda text: text.split(","), default=list(growth.LEGENDS))
    parser.add_argument("--bandwidth", type=float)
    parser.add_argument("--arithmetic", type=float)
    parser.add_argument("-o", dest="output", type=Path)
    asked = parser.parse_args()
    unknown = set(asked.sweeps) - set(growth.LEGENDS)
    if unknown:
        parser.error(f"--sweeps are {', '.join(growth.LEGENDS)}, not {', '.join(unknown)}")
    return asked


def said(command, expected=(0,)):
    """The output of a program."""
    command = [str(word) for word in command]
    print(" ".join(command), file=sys.stderr)
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode not in expected:
        sys.exit(f"{' '.join(command)} failed:\n{ran.stderr}")
    return ran.stdout.rstrip()


def block(words):
    return f"```\n{words}\n```"


def hard_cases(asked):
    """The number of cases that each profile passes, and the names of failures; thesis is expected to fail."""
    some = ["--case", "corner"] if asked.quick else []
    cases = json.loads(said([asked.echomarch, "verify", "--json", "--quiet", *some], expected=(0, 1)))["cases"]
    lines = []
    for profile in [result["profile"] for result in cases[0]["results"]]:
        passed = {
            case["name"]: result["passed"]
            for case in cases
            for result in case["results"]
            if result["profile"] == profile
        }
        failed = [name for name, is_passed in passed.items() if not is_passed]
        told = f", fails {', '.join(failed)}" if failed and profile != "thesis" else ""
        lines.append(f"- `{profile}` passes {len(passed) - len(failed)} of {len(passed)}{told}")
    return "The cases are those of `verify`. `thesis` is expected to fail many of them.\n\n" + "\n".join(lines)


def tables_of_figures(asked, folder):
    """The thesis' tables as Markdown, with headings one level lower."""
    runs, most = ("1", "256") if asked.quick else ("3", "1048576")
    said([asked.echomarch, "figures", "--runs", runs, "--max-waves", most, "-o", folder, "--quiet"])
    lines = (Path(folder) / "figures.md").read_text().splitlines()
    return "\n".join("#" + line if line.startswith("#") else line for line in lines if not line.startswith("!["))


class Pass:
    """Memory traffic and arithmetic of a part of a frame, divided by its time."""

    def __init__(self, name, waves, milliseconds, number_of_bytes, plain=None):
        self.name, self.milliseconds = name, milliseconds
        seconds = 1e-3 * milliseconds
        self.bandwidth = number_of_bytes * waves / seconds / 1e9 if seconds else None
        self.arithmetic = plain * waves / seconds / 1e9 if plain and seconds else None

    def cells(self, asked):
        def share(value, most):
            return "–" if value is None or not most else f"{value / most:.1%}"

        return [
            self.name,
            short(self.milliseconds),
            short(self.bandwidth),
            share(self.bandwidth, asked.bandwidth),
            short(self.arithmetic),
            share(self.arithmetic, asked.arithmetic),
        ]


def fused(time, waves, plain):
    """The pass with all iterations. If this pass also makes the waves and their contributions, it is the
    whole frame."""
    if time["initialise"] == 0:
        return Pass("all in one pass: the whole frame", waves, time["march"], BYTES["whole"], plain)
    return Pass("march, all in one pass", waves, time["march"], BYTES["march"], plain)


def passes(asked, scene, profile):
    """The parts of a frame, with one iteration per pass and with as many as fit."""
    waves = 4_096 if asked.quick else 1_048_576
    iterations = growth.ITERATIONS
    command = [asked.echomarch, "trace", scene]
    counted = operations.of_shader(asked.echomarch, scene, ["--profile", profile]) if profile == "hybrid" else None
    plain = counted and counted[0]

    def frame(**options):
        return trace(
            command,
            asked.one_core,
            profile=profile,
            waves=waves,
            iterations=iterations,
            repeat=1 if asked.quick else 9,
            **options,
        )["milliseconds"]

    apart = frame(iterations_per_pass=1)
    made = [
        Pass("initialise", waves, apart["initialise"], BYTES["initialise"]),
        Pass(
            "march, one iteration per pass",
            waves,
            apart["march"],
            BYTES["march"] * iterations,
            plain and plain * iterations,
        ),
    ]
    if profile != "thesis":
        made.append(fused(frame(), waves, plain and plain * iterations))
    made += [
        Pass("pan", waves, apart["pan"], BYTES["pan"]),
        Pass("read back", waves, apart["read_back"], BYTES["read_back"]),
    ]
    return table(
        [f"{scene}, {profile}, {waves:,} waves", "ms", "GB/s", "share", "G operations/s", "share"],
        [one.cells(asked) for one in made],
    )


def operation_cells(asked, scene):
    """The numbers of plain and special operations of each pass, as text."""
    for name in ("initialise", "march", "pan"):
        counted = operations.of_shader(asked.echomarch, scene, ["--pass", name])
        yield f"{counted[0]} + {counted[1]} special" if counted else "–"


def shares(asked):
    most = [
        f"{value:,.0f} {unit}" if value else f"not stated ({option})"
        for value, unit, option in (
            (asked.bandwidth, "GB/s", "--bandwidth"),
            (asked.arithmetic, "G operations/s", "--arithmetic"),
        )
    ]
    parts = [
        "## Share of memory bandwidth and arithmetic",
        f"Bytes and operations are counted as in [cost on paper]({PAPER}), and divided by the time of each part. The "
        f"data sheet of the card states: bandwidth {most[0]}, arithmetic {most[1]}. Operations are counted for "
        "`hybrid`, if glslang and SPIRV-Tools are installed.",
    ]
    chosen = SCENES[:1] if asked.quick else SCENES
    counted = [[scene, *operation_cells(asked, scene)] for scene in chosen]
    parts.append(table(["operations per wave, `hybrid`", "initialise", "march, per iteration", "pan"], counted))
    for scene in chosen:
        parts += [passes(asked, scene, profile) for profile in asked.profiles]
    return parts


def grown(asked, folder):
    made = growth.sweeps(asked.quick, asked.profiles, asked.sweeps)
    for sweep in made:
        sweep.measure(asked.echomarch, folder, asked.one_core)
    return made


def main():
    asked = arguments()
    first = trace([asked.echomarch, "trace", "corner"], waves=64)
    renderer, clock = first["renderer"], first["clock"]
    name = "growth" if asked.growth else "report"
    output = asked.output or Path("docs/benchmarks") / f"{name}-{slug(renderer)}.md"
    what = "Growth" if asked.growth else "Report of a renderer"
    cores = "one core" if asked.one_core else "all cores"
    parts = [
        f"# {what}: {renderer}",
        f"`scripts/gpu-report.sh`; {machine()} ({cores}); {first_line([asked.echomarch, '--version'])}, commit "
        f"{first_line(['git', 'describe', '--always', '--dirty'])}. Times: {clock}"
        + ("; this is a trial with few waves, and its times are not reliable." if asked.quick else "."),
    ]
    with tempfile.TemporaryDirectory() as folder:
        if not asked.growth:
            parts += ["## Renderers", block(said([asked.echomarch, "info"]))]
            parts += ["## Hard cases", hard_cases(asked), tables_of_figures(asked, folder)]
            parts += shares(asked)
        made = grown(asked, folder)
    parts += [
        "## Growth",
        f"[Cost on paper]({PAPER}#growth) states the expected growth, and the reasons for deviations from a straight "
        "line.",
    ]
    drawn = output.with_suffix(".svg")
    parts.append(f"![Time and memory against waves, iterations and surfaces]({drawn.name})")
    parts += [sweep.markdown() for sweep in made]
    drawn.write_text(growth.picture(made, renderer))
    output.write_text("\n\n".join(parts) + "\n")
    print(f"written: {output} and {drawn}")


if __name__ == "__main__":
    main()

"""Traces a measured room from its mesh, and compares the figures with the measured ones.

The folder has a mesh (NAME.obj, .glb or .gltf) and NAME.json with the materials of the mesh, the air, the places of
sources and listeners, and the measured figures. Nothing is fitted and nothing is fetched.
"""

import argparse
import csv
import json
import math
import sys
import tempfile
from pathlib import Path
from statistics import fmean
from subprocess import run

from common.markdown import table

BANDS_HZ = [63, 125, 250, 500, 1000, 2000, 4000, 8000]
RADIUS_M = 0.25  # of the sphere in which a listener counts arrivals
MESHES = [".obj", ".glb", ".gltf"]
# Name in NAME.json and in the table of `echomarch impulse --csv`, heading, digits, and the just noticeable difference
# of ISO 3382-1: a share of the measured value, or a difference in the unit of the figure.
FIGURES = [
    ("t20_s", "T20 in s", 3, 0.05, "share"),
    ("edt_s", "EDT in s", 3, 0.05, "share"),
    ("c80_db", "C80 in dB", 2, 1.0, "difference"),
    ("d50", "D50", 3, 0.05, "difference"),
]


def main():
    options = arguments()
    mesh, data = measured_room(options.folder)
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder) / "imported.ron"
        scene = Path(folder) / "room.ron"
        place = Path(folder) / mesh.name
        place.write_bytes(mesh.read_bytes())
        called([options.echomarch, "import", place, "-o", base, "--inside", "air"])
        scene.write_text(scene_text(base.name, data), encoding="utf-8")
        figures = Path(folder) / "figures.csv"
        accuracy = ["--accuracy", options.accuracy, "--time-limit", options.time_limit]
        called([options.echomarch, "impulse", scene, "--csv", figures, *accuracy])
        rows = read_rows(figures)
    compared = comparison(rows, data["measured"])
    options.output.mkdir(parents=True, exist_ok=True)
    write_csv(options.output / "comparison.csv", compared)
    (options.output / "comparison.md").write_text(markdown(compared), encoding="utf-8")
    (options.output / "comparison.svg").write_text(svg(mesh.stem, compared), encoding="utf-8")
    print(markdown(compared), end="")


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/validate.sh", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--echomarch", required=True)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/validation"))
    parser.add_argument("--accuracy", default="1%")
    parser.add_argument("--time-limit", default="60", help="seconds for each pair")
    return parser.parse_args()


def measured_room(folder):
    """The mesh of the folder, and the content of the JSON file of the same name."""
    meshes = [file for file in sorted(folder.glob("*")) if file.suffix in MESHES]
    pairs = [(mesh, mesh.with_suffix(".json")) for mesh in meshes if mesh.with_suffix(".json").exists()]
    if len(pairs) != 1:
        sys.exit(f"{folder} must have one mesh ({', '.join(MESHES)}) with a JSON file of the same name, not {len(pairs)}")
    mesh, file = pairs[0]
    data = json.loads(file.read_text(encoding="utf-8"))
    missing = [key for key in ("bands_hz", "materials", "sources", "listeners", "measured") if key not in data]
    if missing:
        sys.exit(f"{file} has no {', '.join(missing)}")
    if data["bands_hz"] != BANDS_HZ:
        sys.exit(f"the bands of {file} must be {BANDS_HZ} Hz, not {data['bands_hz']}")
    return mesh, data


def scene_text(base, data):
    """A scene with the surfaces of the imported mesh, and everything else as stated. JSON texts and lists are RON."""
    ron = json.dumps
    materials = [
        f"{ron(name)}: Material(absorption: {ron(of['absorption'])}, scattering: {ron(of['scattering'])}),"
        for name, of in data["materials"].items()
    ]
    air = data.get("air")
    said_air = f"air: Air({', '.join(f'{name}: {value}' for name, value in air.items())})," if air else ""
    place = lambda at: "({}, {}, {})".format(*at)
    sources = [f"Source(name: {ron(name)}, position: {place(at)})," for name, at in data["sources"].items()]
    listeners = [
        f"Listener(name: {ron(name)}, position: {place(at)}, radius: {RADIUS_M}),"
        for name, at in data["listeners"].items()
    ]
    return "\n".join(
        ["Scene(", f"base: {ron(base)},", "materials: {", *materials, "},", said_air]
        + ["sources: [", *sources, "],", "listeners: [", *listeners, "],", ")", ""]
    )


def called(command):
    """Runs a program, whose errors end the script."""
    ran = run([str(word) for word in command], capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{ran.stderr}")


def read_rows(file):
    with file.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def comparison(rows, measured):
    """For each figure and band: the measured value, the mean over all pairs with its standard error, and the difference
    in just noticeable differences."""
    compared = []
    for name, heading, digits, noticeable, kind in FIGURES:
        for band, value in sorted(measured.get(name, {}).items(), key=lambda item: float(item[0])):
            cells = [row for row in rows if float(row["band_hz"]) == float(band)]
            traced = [float(row[name]) for row in cells if row[name]]
            errors = [float(row[error_name(name)] or "nan") for row in cells if row[name]]
            if not traced:
                continue
            mean = fmean(traced)
            unit = noticeable * value if kind == "share" else noticeable
            compared.append(
                {
                    "figure": name,
                    "heading": heading,
                    "digits": digits,
                    "band_hz": float(band),
                    "pairs": len(traced),
                    "measured": value,
                    "traced": mean,
                    "error": math.sqrt(sum(error**2 for error in errors)) / len(errors),
                    "noticeable": unit,
                    "difference": mean - value,
                    "in_noticeable": (mean - value) / unit,
                }
            )
    return compared


def error_name(figure):
    """The column of a figure's standard error: `t20_error_s` for `t20_s`."""
    name, _, unit = figure.partition("_")
    return "_".join(filter(None, [name, "error", unit]))


COLUMNS = ["figure", "band_hz", "pairs", "measured", "traced", "error", "difference", "noticeable", "in_noticeable"]


def write_csv(file, compared):
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(compared)


def markdown(compared):
    heads = ["figure", "band in Hz", "measured", "traced", "±", "difference", "in JND"]
    lines = []
    for row in compared:
        digits = row["digits"]
        difference = f"{row['difference']:+.{digits}f}"
        if row["figure"].endswith("_s"):
            difference = f"{100 * row['difference'] / row['measured']:+.1f} %"
        numbers = [f"{row[key]:.{digits}f}" for key in ("measured", "traced", "error")]
        lines.append([row["heading"], f"{row['band_hz']:g}", *numbers, difference, f"{row['in_noticeable']:+.1f}"])
    return table(heads, lines) + "\n"


WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 400, 300, 56, 44, 40, 16
MEASURED, TRACED, AUDIBLE = "#0072b2", "#d55e00", "#cfe3f1"


def svg(title, compared):
    """A panel for each figure: the measured values with a strip of one just noticeable difference to each side, and the
    traced values with two standard errors."""
    panels = [[row for row in compared if row["figure"] == name] for name, *_ in FIGURES]
    panels = [rows for rows in panels if rows]
    height = 60 + HEIGHT * math.ceil(len(panels) / 2)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * WIDTH} {height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{2 * WIDTH}" height="{height}" fill="white"/>',
        text(WIDTH, 22, f"{title}: measured and traced", 16),
    ]
    for index, rows in enumerate(panels):
        across, down = index % 2, index // 2
        parts += [f'<g transform="translate({across * WIDTH} {24 + down * HEIGHT})">', *panel(rows), "</g>"]
    legend = height - 14
    parts += [
        f'<path d="M{LEFT} {legend - 4}h30" stroke="{AUDIBLE}" stroke-width="12"/>',
        f'<path d="M{LEFT} {legend - 4}h30" stroke="{MEASURED}" stroke-width="2"/>',
        text(LEFT + 36, legend, "measured ± 1 just noticeable difference", anchor="start"),
        f'<circle cx="{WIDTH + 15}" cy="{legend - 4}" r="4" fill="{TRACED}"/>',
        text(WIDTH + 26, legend, "traced, mean of all pairs ± 2 standard errors", anchor="start"),
    ]
    return "\n".join([*parts, "</svg>", ""])


def panel(rows):
    bands = [row["band_hz"] for row in rows]
    lows = [min(row["measured"] - row["noticeable"], row["traced"] - 2 * row["error"]) for row in rows]
    highs = [max(row["measured"] + row["noticeable"], row["traced"] + 2 * row["error"]) for row in rows]
    low, high = min(lows), max(highs)
    step = round_step((high - low) / 5 or 1.0)
    low, high = step * math.floor(low / step), step * math.ceil(high / step)
    x = lambda band: LEFT + (WIDTH - LEFT - RIGHT) * (bands.index(band) + 0.5) / len(bands)
    y = lambda value: HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (value - low) / (high - low)
    yield text(WIDTH / 2, TOP - 12, rows[0]["heading"], 14)
    for tick in range(round((high - low) / step) + 1):
        value = low + tick * step
        yield f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="#dddddd"/>'
        yield text(LEFT - 6, y(value) + 4, f"{value:.4g}", anchor="end")
    upper = [f"{x(row['band_hz']):.1f} {y(row['measured'] + row['noticeable']):.1f}" for row in rows]
    lower = [f"{x(row['band_hz']):.1f} {y(row['measured'] - row['noticeable']):.1f}" for row in reversed(rows)]
    yield f'<path d="M{" L".join(upper + lower)}Z" fill="{AUDIBLE}" fill-opacity="0.8"/>'
    measured = [f"{x(row['band_hz']):.1f} {y(row['measured']):.1f}" for row in rows]
    yield f'<path d="M{" L".join(measured)}" fill="none" stroke="{MEASURED}" stroke-width="2"/>'
    for row in rows:
        at, ends = x(row["band_hz"]), [y(row["traced"] + side * 2 * row["error"]) for side in (-1, 1)]
        yield f'<path d="M{at:.1f} {ends[0]:.1f}V{ends[1]:.1f}" stroke="{TRACED}" stroke-width="2"/>'
        yield f'<circle cx="{at:.1f}" cy="{y(row["traced"]):.1f}" r="4" fill="{TRACED}"/>'
        yield text(at, HEIGHT - BOTTOM + 18, f"{row['band_hz']:g}")
    yield text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, "octave band in Hz")


def round_step(step):
    """The least of 1, 2 and 5 times a power of ten that is at least `step`."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))


def text(x, y, words, size=12, anchor="middle"):
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}">{words}</text>'


if __name__ == "__main__":
    main()

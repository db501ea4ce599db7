"""Tables and numbers in Markdown."""

import platform
from pathlib import Path


def table(heads, lines):
    """A table whose first column is text and whose other columns are numbers."""
    rule = ["---"] + ["---:"] * (len(heads) - 1)
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [heads, rule, *lines])


def short(value):
    """A number with three digits; a dash if there is no value."""
    if value is None:
        return "–"
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def machine():
    return f"{processor()}, {platform.system()} {platform.release()}"


def processor():
    file = Path("/proc/cpuinfo")
    lines = file.read_text().splitlines() if file.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()

"""Draws lines over two axes as SVG: panels in rows, with one legend."""

import math
from html import escape

# The colours are distinguishable for colour-blind readers (Okabe and Ito). Later lines are thinner.
STROKES = [("#d55e00", 4), ("#0072b2", 3), ("#00a878", 2), ("#e69f00", 2)]
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 400, 330, 62, 52, 44, 16


def svg(title, panels, columns, scale=None):
    """A panel is (caption, name of x, name of y, {name of a line: [(x, y), …]}). Axes are logarithmic unless `scale` is
    `Linear`."""
    width = WIDTH * min(columns, len(panels))
    below = 24 + HEIGHT * math.ceil(len(panels) / columns)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {below + 40}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{below + 40}" fill="white"/>',
        text(width / 2, 24, title, size=16),
    ]
    for index, panel in enumerate(panels):
        row, column = divmod(index, columns)
        parts += [f'<g transform="translate({column * WIDTH} {24 + row * HEIGHT})">', *draw(*panel, scale or Logarithmic), "</g>"]
    names = list(dict.fromkeys(name for panel in panels for name in panel[3]))
    for index, name in enumerate(names):
        x, y = LEFT + 120 * index, below + 12
        colour, thickness = STROKES[index % len(STROKES)]
        parts.append(f'<path d="M{x} {y}h36" stroke="{colour}" stroke-width="{thickness}"/>')
        parts.append(text(x + 44, y + 4, name, anchor="start"))
    return "\n".join([*parts, "</svg>", ""])


def draw(caption, x_name, y_name, lines, scale):
    points = [point for line in lines.values() for point in line]
    x_axis = scale([x for x, _ in points], LEFT, WIDTH - RIGHT)
    y_axis = scale([y for _, y in points], HEIGHT - BOTTOM, TOP)
    yield text(WIDTH / 2, TOP - 12, caption, size=14)
    for value, name in x_axis.ticks():
        x = x_axis.place(value)
        yield grid(x, TOP, x, HEIGHT - BOTTOM)
        yield text(x, HEIGHT - BOTTOM + 18, name)
    for value, name in y_axis.ticks():
        y = y_axis.place(value)
        yield grid(LEFT, y, WIDTH - RIGHT, y)
        yield text(LEFT - 8, y + 4, name, anchor="end")
    yield text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 12, x_name)
    middle = (TOP + HEIGHT - BOTTOM) / 2
    yield f'<g transform="translate(16 {middle}) rotate(-90)">{text(0, 0, y_name)}</g>'
    for (name, line), (colour, width) in zip(lines.items(), STROKES):
        places = [f"{x_axis.place(x):.1f} {y_axis.place(y):.1f}" for x, y in line]
        yield f'<path d="M{" L".join(places)}" fill="none" stroke="{colour}" stroke-width="{width}"/>'
        yield from (dot(place, colour, width) for place in places)


class Logarithmic:
    """A logarithmic scale of whole decades around the values, from a first to a last pixel."""

    def __init__(self, values, start, end):
        self.low = math.floor(math.log10(min(values)) + 1e-9)
        self.high = max(math.ceil(math.log10(max(values)) - 1e-9), self.low + 1)
        self.start, self.end = start, end

    def place(self, value):
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        powers = range(self.low, self.high + 1)
        return [(10.0**power, power_of_ten(power)) for power in powers]


class Linear:
    """A linear scale of round steps around the values, from a first to a last pixel."""

    MOST_STEPS = 8

    def __init__(self, values, start, end):
        width = (max(values) - min(values)) / self.MOST_STEPS or 1.0
        power = 10.0 ** math.floor(math.log10(width))
        self.step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= width)
        self.low = math.floor(min(values) / self.step)
        self.high = max(math.ceil(max(values) / self.step), self.low + 1)
        self.start, self.end = start, end

    def place(self, value):
        share = (value / self.step - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        values = [self.step * step for step in range(self.low, self.high + 1)]
        return [(value, f"{value:g}".replace("-", "−")) for value in values]


def dot(place, colour, width):
    x, y = place.split()
    return f'<circle cx="{x}" cy="{y}" r="{width / 2 + 1}" fill="{colour}"/>'


def grid(x1, y1, x2, y2):
    return f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="#ddd"/>'


def text(x, y, words, anchor="middle", size=12):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">{escape(words)}</text>'


def power_of_ten(power):
    raised = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return "10" + raised

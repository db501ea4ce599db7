"""Prints the largest errors of boundary_elements.py and doorway.py in dB: against series, finer panels, more modes, and
each other."""

import numpy as np
from scipy.special import h1vp, hankel1, jv, jvp

import boundary_elements as bem
import doorway


def level(p):
    return 20 * np.log10(abs(p))


def worst(found, expected):
    return np.max(abs(level(found) - level(expected)))


def cylinder_series(k, radius, source, receivers):
    order = np.arange(0, int(k * radius + 10 * (k * radius) ** (1 / 3) + 60))[:, None]
    angle = np.angle(receivers) - np.angle(source)
    ratio = jvp(order, k * radius) / h1vp(order, k * radius)
    radial = ratio * hankel1(order, k * abs(source)) * hankel1(order, k * abs(receivers))
    terms = np.where(order == 0, 1, 2) * np.nan_to_num(radial) * np.cos(order * angle)
    return 1 - terms.sum(0) / hankel1(0, k * abs(source - receivers))


def wedge_series(k, exterior, source, receivers):
    """Modes cos(n pi theta / exterior) of the wedge, angles in the air from one face."""
    index = np.arange(0, 500)[:, None] * np.pi / exterior
    (r_s, t_s), (r_r, t_r) = source, receivers
    near, far = np.minimum(r_s, r_r), np.maximum(r_s, r_r)
    radial = np.nan_to_num(jv(index, k * near) * hankel1(index, k * far))
    terms = np.where(index == 0, 1, 2) * radial * np.cos(index * t_s) * np.cos(index * t_r)
    distance = np.sqrt(r_s**2 + r_r**2 - 2 * r_s * r_r * np.cos(t_s - t_r))
    return 2 * np.pi / exterior * terms.sum(0) / hankel1(0, k * distance)


def check_cylinder(frequency, k):
    (source,), receivers = bem.cylinder_places()
    found = bem.pressures(k, bem.cylinder(k), np.array([source]), receivers)
    exact = cylinder_series(k, bem.CYLINDER_RADIUS, source, receivers)
    print(f"cylinder {frequency} Hz: {worst(found[0], exact):.6f}")


def without_ends(k, of_length, length):
    """Mean over four lengths an eighth of a wavelength apart: waves to a far end and back cancel."""
    return np.mean([of_length(length + step * np.pi / k / 4) for step in range(4)], axis=0)


def check_corner(frequency, k, side=12.0):
    """A corner of a large square is a wedge of 270 degrees, but for the waves from its other corners."""
    radius, angle = np.array([0.7, 0.8, 1.4, 1.2]), np.radians([200.0, 240.0, 150.0, 60.0])
    source_radius, source_angle = 1.0, np.radians(30.0)
    # Angles from the upper face, which runs to the left of the corner at 0, clockwise.
    receivers = radius * np.exp(1j * (np.pi - angle))
    source = np.array([source_radius * np.exp(1j * (np.pi - source_angle))])

    def square(side):
        corners = [side * np.array([-1 - 1j, 0 - 1j, 0, -1])]
        return bem.pressures(k, bem.rectangles(corners, bem.longest_panel(k, side)), source, receivers)

    found = without_ends(k, square, side)
    exact = wedge_series(k, 1.5 * np.pi, (source_radius, source_angle), (radius, angle))
    print(f"corner of a square of {side} m against the wedge, {frequency} Hz: {worst(found[0], exact):.4f}")


def check_bars(frequency, k):
    """Against shorter panels, more of them at each corner, and other points inside."""
    for width in bem.BAR_WIDTHS:
        places = bem.bar_places(width)
        found = bem.pressures(k, bem.bar(k, width), *places)
        bem.PANEL_WAVELENGTHS, bem.CORNER_PANELS, bem.SEED = 0.6, 12, 2
        finer = bem.pressures(k, bem.bar(k, width), *places)
        bem.PANEL_WAVELENGTHS, bem.CORNER_PANELS, bem.SEED = 1.0, 9, 1
        print(f"bar {width} m, {frequency} Hz, against finer panels: {worst(found, finer):.6f}")


def check_doorway(frequency, k):
    places = doorway.places()
    found, more = (doorway.pressures(k, *places, modes) for modes in (doorway.MODES, 2 * doorway.MODES))
    print(f"doorway {frequency} Hz, against twice the modes: {worst(found, more):.4f}")


def check_doorway_in_long_walls(frequency, k, length=6.0):
    """Boundary elements with two long walls."""
    x, y = doorway.THICKNESS / 2, doorway.WIDTH / 2
    places = doorway.places()

    def walls(length):
        upper = np.array([complex(x, y), complex(x, y + length), complex(-x, y + length), complex(-x, y)])
        corners = [upper, upper[::-1].conjugate()]
        return bem.pressures(k, bem.rectangles(corners, 2 * doorway.THICKNESS), *places)

    difference = worst(without_ends(k, walls, length), doorway.pressures(k, *places))
    print(f"doorway {frequency} Hz, against boundary elements with walls of {length} m: {difference:.4f}")


def main():
    for frequency in bem.OCTAVES:
        k = 2 * np.pi * frequency / bem.SPEED_OF_SOUND
        check_cylinder(frequency, k)
        check_bars(frequency, k)
        if frequency <= 500:
            check_corner(frequency, k)
        if frequency >= doorway.LOWEST:
            check_doorway(frequency, k)
        if 250 <= frequency <= 500:
            check_doorway_in_long_walls(frequency, k)


if __name__ == "__main__":
    main()

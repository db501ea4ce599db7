//! Checks whether a value grows faster than stated.
//!
//! In the air the positive part of the value, max(f, 0), is checked. Its growth is within the stated constant exactly
//! if the growth of the value is wherever the value is positive. Growth between a point in the air and a point in the
//! solid counts too, because the surface is between the points. A star that is no wider than the checked depth is
//! checked as a whole if one of its points is in the air.

use super::stars::{POINTS, Scope, Stars};
use super::{Error, Grid, Probe, TraceError, WaveDomain, neighbours};
use glam::Vec3;

/// Tolerated relative excess of the growth over the stated growth. So small an excess does not affect a march, because
/// its last steps are Newton steps.
const TOLERANCE: f32 = 0.01;

/// The number that the error advises to state, as a multiple of the steepest growth that was found.
const MARGIN: f32 = 1.01;

/// Number of steps between two points with excessive growth, in which the check looks for the steepest one.
const CLOSER: usize = 256;

/// A value may jump if its growth is more than this multiple of the growth between points [`CLOSER`] times as far
/// apart. At a jump the ratio of the two is about [`CLOSER`], on a slope about 1.
const NARROWER: f32 = 32.0;

/// A value seems to jump if, in addition, its growth is more than this multiple of the stated growth. Estimates of a
/// fractal's distance also have steps, where the number of iterations changes. These steps are so small that the user
/// can state a greater constant instead.
const JUMP: f32 = 100.0;

/// The greatest constant that can be stated.
const LARGEST_LIPSCHITZ: f32 = 1e6;

/// The two points with the greatest growth between them.
struct Steepest {
    growth: f32,
    ends: [Vec3; 2],
    /// Whether only the positive part of the value counts.
    in_air: bool,
    /// The rounding difference that is possible between two equal values. It is subtracted from their difference.
    rounding: f32,
}

impl Steepest {
    fn take(&mut self, ends: [Vec3; 2], values: [f32; 2], in_air: bool) {
        let [from, to] = match in_air {
            true => values.map(|value| value.max(0.0)),
            false => values,
        };
        let way = ends[0].distance(ends[1]);
        let growth = ((to - from).abs() - self.rounding) / way;
        // A gradient of 0 has no direction, so its ends coincide. Values that are not finite are checked elsewhere.
        if way > 0.0 && growth.is_finite() && growth > self.growth {
            self.growth = growth;
            self.ends = ends;
            self.in_air = in_air;
        }
    }
}

impl Probe<'_> {
    /// Rejects a field that grows too fast where waves can be. The error advises a constant that these checks accept,
    /// because for a greater constant they subtract at least as much rounding from the growth.
    pub(super) fn check_growth(&self, grid: &Grid, stars: &Stars) -> Result<(), Error> {
        let stated = self.field.lipschitz;
        let steepest = self.steepest(grid, stars);
        if steepest.growth <= stated * (1.0 + TOLERANCE) {
            return Ok(());
        }
        let closer = self.closer(&steepest)?;
        let advice = rounded_up(MARGIN * steepest.growth);
        let is_steeper_within = closer.growth > NARROWER * steepest.growth;
        let jumps = is_steeper_within && steepest.growth > JUMP * stated;
        let jumps = jumps || advice > LARGEST_LIPSCHITZ;
        Err(TraceError::FieldGrows {
            file: self.field.file.display().to_string(),
            place: closer.ends[0].midpoint(closer.ends[1]),
            growth: steepest.growth,
            stated,
            advice: (!jumps).then_some(advice),
        }
        .into())
    }

    fn steepest(&self, grid: &Grid, stars: &Stars) -> Steepest {
        let mut steepest = Steepest {
            growth: 0.0,
            ends: [Vec3::ZERO; 2],
            in_air: false,
            rounding: self.rounding(self.field.lipschitz),
        };
        let Grid { points, values } = grid;
        let in_air = self.waves == WaveDomain::Air;
        for (from, to) in neighbours() {
            let ends = [points[from], points[to]];
            steepest.take(ends, [values[from], values[to]], in_air);
        }
        for star in stars.each() {
            let scope = self.scope(star);
            if scope == Scope::Nowhere {
                continue;
            }
            let mut take = |from: usize, to: usize| {
                let ends = [star.points[from], star.points[to]];
                let values = [star.values[from], star.values[to]];
                steepest.take(ends, values, scope == Scope::Air);
            };
            for end in (1..POINTS).step_by(2) {
                take(end, end + 1);
                take(0, end);
                take(0, end + 1);
            }
        }
        steepest
    }

    /// The steepest growth between the two points, from more values between them.
    fn closer(&self, steepest: &Steepest) -> Result<Steepest, Error> {
        let [from, to] = steepest.ends;
        let along = (0..=CLOSER).map(|step| from.lerp(to, step as f32 / CLOSER as f32));
        let points: Vec<Vec3> = along.collect();
        let values = self.values(&points)?;
        let mut closer = Steepest { ..*steepest };
        for (ends, pair) in points.windows(2).zip(values.windows(2)) {
            closer.take([ends[0], ends[1]], [pair[0], pair[1]], steepest.in_air);
        }
        Ok(closer)
    }
}

/// The smallest number with three significant digits that is not less than `number`.
pub(super) fn rounded_up(number: f32) -> f32 {
    const DIGITS: i32 = 3;
    let number = f64::from(number);
    let unit = 10f64.powi(number.log10().floor() as i32 + 1 - DIGITS);
    // A division rounds as the reading of a decimal does, because the divisor, a power of 10, is exact.
    let steps = (number / unit).ceil();
    let rounded = match unit < 1.0 {
        true => steps / (1.0 / unit).round(),
        false => steps * unit,
    };
    rounded as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the numbers that an error advises: they are short, and never too small.
    #[test]
    fn numbers_are_rounded_up_to_three_digits() {
        for (number, rounded) in [
            (2.0, 2.0),
            (2.0201, 2.03),
            (0.010_101, 0.0102),
            (1234.0, 1240.0),
            (99.95, 100.0),
            (0.001_005, 0.001_01),
        ] {
            assert!(
                (rounded_up(number) - rounded).abs() <= 1e-6 * rounded,
                "{number}"
            );
            assert!(rounded_up(number) >= number * (1.0 - 1e-6));
        }
    }
}

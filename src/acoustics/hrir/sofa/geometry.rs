//! Directions of a SOFA file in listener axes.
//!
//! Positions are spherical (azimuth from x towards y and elevation in degrees, metres) or cartesian
//! (metres). A listener looks along `ListenerView` with `ListenerUp` pointing up, by default along x
//! with z up.

use super::variables::Variables;
use super::{SofaProblem, bad_value};
use glam::{DMat3, DVec3};

/// Least sine of the angle between view and up: with a smaller one they do not define axes.
const LEAST_SINE: f64 = 1e-3;

/// The direction of each source, and its distance in metres.
pub(super) fn directions(
    file: &Variables,
    count: usize,
) -> Result<(Vec<DVec3>, Vec<f64>), SofaProblem> {
    const SOURCE: &str = "SourcePosition";
    let sources = Vectors::read(file, SOURCE, count)?;
    let listener = Vectors::read_or(file, "ListenerPosition", count, DVec3::ZERO)?;
    let view = Vectors::read_or(file, "ListenerView", count, DVec3::X)?;
    let up = Vectors::read_or(file, "ListenerUp", count, DVec3::Z)?;
    let mut directions = Vec::with_capacity(count);
    let mut metres = Vec::with_capacity(count);
    for index in 0..count {
        let axes = axes(view.of(index), up.of(index))?;
        let from = axes.transpose() * (sources.of(index) - listener.of(index));
        if !from.is_finite() || from.try_normalize().is_none() {
            let reason = format!("measurement {index} comes from nowhere");
            return Err(bad_value(SOURCE, reason));
        }
        directions.push(from);
        metres.push(from.length());
    }
    Ok((directions, metres))
}

/// The indices of the receivers at the left and at the right ear.
pub(super) fn ears(file: &Variables) -> Result<[usize; 2], SofaProblem> {
    const NAME: &str = "ReceiverPosition";
    const FIRST_IS_LEFT: [usize; 2] = [0, 1];
    if !file.has(NAME) {
        return Ok(FIRST_IS_LEFT);
    }
    // Two receivers with three coordinates, for one or all measurements: the first is used.
    let shape = file.shape(NAME)?;
    let per_receiver = match shape[..] {
        [2, 3] => 1,
        [2, 3, measurements] => measurements as usize,
        _ => return Ok(FIRST_IS_LEFT),
    };
    let most = super::super::MAX_DIRECTIONS * 6;
    let numbers = file.numbers(NAME, most)?;
    let coordinate = |receiver: usize, axis: usize| {
        let at = (3 * receiver + axis) * per_receiver;
        numbers.get(at).copied().unwrap_or(0.0)
    };
    let kind = Kind::of(file, NAME)?;
    let y = |receiver| {
        kind.cartesian(std::array::from_fn(|axis| coordinate(receiver, axis)))
            .y
    };
    // The convention has the left ear first. A file that does not state the positions of the ears
    // follows it.
    let is_swapped = y(0) < 0.0 && y(1) > 0.0;
    Ok(if is_swapped { [1, 0] } else { FIRST_IS_LEFT })
}

/// The listener's axes as columns.
fn axes(view: DVec3, up: DVec3) -> Result<DMat3, SofaProblem> {
    let bad = || {
        bad_value(
            "ListenerView",
            format!("with ListenerUp it spans no axes: {view:?} and {up:?}"),
        )
    };
    let x = view.try_normalize().ok_or_else(bad)?;
    let above = up.try_normalize().ok_or_else(bad)?;
    let y = above.cross(x);
    if y.length() < LEAST_SINE {
        return Err(bad());
    }
    let y = y.normalize();
    Ok(DMat3::from_cols(x, y, x.cross(y)))
}

#[derive(Clone, Copy)]
enum Kind {
    Cartesian,
    Spherical,
}

impl Kind {
    /// The kind of a variable's numbers, by its attributes Type and Units.
    fn of(file: &Variables, variable: &'static str) -> Result<Kind, SofaProblem> {
        let bad = |attribute: &str, found: &str, expected: &str| {
            bad_value(
                variable,
                format!("its {attribute} is {found:?}, not {expected}"),
            )
        };
        let kind = file.attribute(variable, "Type")?;
        let kind = match kind.as_deref() {
            Some("spherical") => Kind::Spherical,
            Some("cartesian") => Kind::Cartesian,
            // Views often have no type; SOFA's default is cartesian.
            None => Kind::Cartesian,
            Some(other) => return Err(bad("Type", other, "\"spherical\" or \"cartesian\"")),
        };
        let units = file.attribute(variable, "Units")?.unwrap_or_default();
        let first = units.split([',', ' ']).next().unwrap_or_default();
        let (expected, is_right) = match kind {
            Kind::Spherical => ("degree", first.starts_with("degree")),
            Kind::Cartesian => (
                "metre",
                matches!(first, "metre" | "meter" | "metres" | "meters"),
            ),
        };
        if !first.is_empty() && !is_right {
            return Err(bad("Units", &units, expected));
        }
        Ok(kind)
    }

    fn cartesian(self, numbers: [f64; 3]) -> DVec3 {
        let [azimuth, elevation, radius] = numbers;
        match self {
            Kind::Cartesian => DVec3::from_array(numbers),
            Kind::Spherical => {
                let (up, flat) = elevation.to_radians().sin_cos();
                let (left, ahead) = azimuth.to_radians().sin_cos();
                radius * DVec3::new(flat * ahead, flat * left, up)
            }
        }
    }
}

/// One vector for all measurements, or one for each.
struct Vectors(Vec<DVec3>);

impl Vectors {
    fn read(
        file: &Variables,
        variable: &'static str,
        count: usize,
    ) -> Result<Vectors, SofaProblem> {
        let (numbers, columns) = file.rows(variable, count)?;
        if columns != 3 {
            let reason = format!("its rows have {columns} numbers, not 3");
            return Err(bad_value(variable, reason));
        }
        let kind = Kind::of(file, variable)?;
        let rows = numbers.chunks_exact(3);
        let vectors = rows.map(|row| kind.cartesian([row[0], row[1], row[2]]));
        Ok(Vectors(vectors.collect()))
    }

    fn read_or(
        file: &Variables,
        variable: &'static str,
        count: usize,
        missing: DVec3,
    ) -> Result<Vectors, SofaProblem> {
        if file.has(variable) {
            Vectors::read(file, variable, count)
        } else {
            Ok(Vectors(vec![missing]))
        }
    }

    fn of(&self, index: usize) -> DVec3 {
        let at = if self.0.len() == 1 { 0 } else { index };
        self.0[at]
    }
}

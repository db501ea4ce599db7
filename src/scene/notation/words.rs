//! Words of a scene file that stand for values: axes, corners, sheets.

use super::numbers::{Metres, Pair};
use glam::Vec3;
use serde::Deserialize;

/// Unit vector along a cylinder.
#[derive(Deserialize)]
#[serde(try_from = "AxisSaid")]
pub(crate) struct Axis(pub Vec3);

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "an axis must be X, Y, Z or a vector (x, y, z) of plain numbers"
)]
enum AxisSaid {
    Letter(Letter),
    Vector(f32, f32, f32),
}

#[derive(Deserialize)]
enum Letter {
    X,
    Y,
    Z,
}

impl Default for Axis {
    fn default() -> Axis {
        Axis(Vec3::Y)
    }
}

impl TryFrom<AxisSaid> for Axis {
    type Error = String;
    fn try_from(said: AxisSaid) -> Result<Axis, String> {
        let vector = match said {
            AxisSaid::Letter(Letter::X) => Vec3::X,
            AxisSaid::Letter(Letter::Y) => Vec3::Y,
            AxisSaid::Letter(Letter::Z) => Vec3::Z,
            AxisSaid::Vector(x, y, z) => Vec3::new(x, y, z),
        };
        match vector.try_normalize() {
            Some(axis) => Ok(Axis(axis)),
            None => Err(format!(
                "an axis must be finite and not of length 0, as {vector} is"
            )),
        }
    }
}

/// The corners of a triangle.
#[derive(Deserialize)]
#[serde(try_from = "Vec<Pair<Metres>>")]
pub(crate) struct Corners(pub [Pair<Metres>; 3]);

impl TryFrom<Vec<Pair<Metres>>> for Corners {
    type Error = String;
    fn try_from(corners: Vec<Pair<Metres>>) -> Result<Corners, String> {
        let count = corners.len();
        match corners.try_into() {
            Ok(three) => Ok(Corners(three)),
            Err(_) => Err(format!("a prism has 3 corners (x, y), not {count}")),
        }
    }
}

/// Whether a hyperboloid has two sheets.
#[derive(Default, Deserialize)]
#[serde(try_from = "i64")]
pub(crate) struct Sheets(pub bool);

impl TryFrom<i64> for Sheets {
    type Error = String;
    fn try_from(sheets: i64) -> Result<Sheets, String> {
        match sheets {
            1 => Ok(Sheets(false)),
            2 => Ok(Sheets(true)),
            _ => Err(format!("a hyperboloid has 1 or 2 sheets, not {sheets}")),
        }
    }
}

/// Whether there is a mirror across x, y and z.
#[derive(Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct MirrorAxes(pub [bool; 3]);

impl TryFrom<String> for MirrorAxes {
    type Error = String;
    fn try_from(letters: String) -> Result<MirrorAxes, String> {
        let refused =
            || format!("the axes of a mirror must be one or more of x, y and z, not {letters:?}");
        let mut axes = [false; 3];
        for letter in letters.chars() {
            let axis = "xyz".find(letter).filter(|axis| !axes[*axis]);
            axes[axis.ok_or_else(refused)?] = true;
        }
        if letters.is_empty() {
            return Err(refused());
        }
        Ok(MirrorAxes(axes))
    }
}

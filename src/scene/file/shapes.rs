//! The grammar of shapes and operators: what a scene file may say for `shape:`.

use super::numbers::{
    Angle, Factor, Length, Lipschitz, Metres, Number, Pair, Plain, Radius, Share, Side, Size,
    Vector,
};
use glam::Vec3;
use serde::Deserialize;

/// A shape, or an operator on shapes.
#[derive(Deserialize)]
#[serde(rename = "Shape", deny_unknown_fields)]
pub(super) enum ShapeFile {
    Plane,
    HalfSpace {
        normal: Vector<Plain>,
        #[serde(default)]
        offset: Number<Metres>,
    },
    Box {
        size: Vector<Side>,
    },
    Room {
        size: Vector<Side>,
    },
    RoundedBox {
        size: Vector<Side>,
        rounding: Number<Radius>,
    },
    Sphere {
        radius: Number<Radius>,
    },
    Cylinder {
        radius: Number<Radius>,
        #[serde(default)]
        height: Option<Number<Length>>,
        #[serde(default)]
        axis: Axis,
    },
    Capsule {
        radius: Number<Radius>,
        height: Number<Length>,
    },
    Torus {
        ring: Number<Radius>,
        tube: Number<Radius>,
    },
    Cone {
        radius: Number<Radius>,
        height: Number<Length>,
    },
    Prism {
        corners: Corners,
        depth: Number<Length>,
    },
    Ellipsoid {
        radii: Vector<Radius>,
    },
    Paraboloid {
        focal_length: Number<Length>,
    },
    Hyperboloid {
        waist: Number<Length>,
        rise: Number<Length>,
        #[serde(default)]
        sheets: Sheets,
    },
    Quadric([Number<Plain>; 10]),
    HeightField {
        image: String,
        size: Vector<Side>,
    },
    Field {
        file: String,
        lipschitz: Lipschitz,
        size: Size,
    },
    Union(Vec<ShapeFile>),
    Intersection(Vec<ShapeFile>),
    Difference {
        from: Box<ShapeFile>,
        cut: Vec<ShapeFile>,
    },
    Complement(Box<ShapeFile>),
    Shell {
        of: Box<ShapeFile>,
        thickness: Number<Length>,
    },
    SmoothUnion {
        of: Vec<ShapeFile>,
        radius: Number<Radius>,
    },
    Offset {
        of: Box<ShapeFile>,
        by: Number<Metres>,
    },
    Translate {
        of: Box<ShapeFile>,
        by: Vector<Metres>,
    },
    Rotate {
        of: Box<ShapeFile>,
        by: Vector<Angle>,
    },
    Scale {
        of: Box<ShapeFile>,
        by: Number<Factor>,
    },
    Mirror {
        of: Box<ShapeFile>,
        axes: MirrorAxes,
    },
    Repeat {
        of: Box<ShapeFile>,
        period: Vector<Metres>,
        #[serde(default)]
        count: (u32, u32, u32),
    },
    Elongate {
        of: Box<ShapeFile>,
        by: Vector<Metres>,
    },
    Twist {
        of: Box<ShapeFile>,
        rate: Number<Angle>,
        #[serde(default)]
        lipschitz: Option<Lipschitz>,
    },
    Bend {
        of: Box<ShapeFile>,
        rate: Number<Angle>,
        #[serde(default)]
        lipschitz: Option<Lipschitz>,
    },
    Morph {
        from: Box<ShapeFile>,
        to: Box<ShapeFile>,
        amount: Number<Share>,
    },
}

/// Unit vector along a cylinder.
#[derive(Deserialize)]
#[serde(try_from = "AxisSaid")]
pub(super) struct Axis(pub Vec3);

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
pub(super) struct Corners(pub [Pair<Metres>; 3]);

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
pub(super) struct Sheets(pub bool);

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

/// For x, y and z: whether there is a mirror.
#[derive(Deserialize)]
#[serde(try_from = "String")]
pub(super) struct MirrorAxes(pub [bool; 3]);

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

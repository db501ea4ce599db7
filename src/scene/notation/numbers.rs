//! Numbers of a scene file, in the units of the file, checked while they are read.
//!
//! A surface's numbers may move. Each is a plain number, key frames, or a named value:
//!
//! ```ron
//! radius: 1.5
//! radius: Keys([(0, 1.0), (2, 3.0)])
//! radius: Value("door", 1.5)
//! ```

use crate::scene::{Motion, Quantity};
use crate::text;
use glam::Vec3;
use serde::Deserialize;
use std::marker::PhantomData;

/// The quantity of a number: its check, and its conversion to the unit of the code.
pub(crate) trait Unit {
    /// The quantity in the code.
    const QUANTITY: Quantity;

    /// The value in the unit of the code.
    ///
    /// # Errors
    /// A message that states the valid range.
    fn read(value: f32) -> Result<f32, String>;
}

fn positive(what: &str, value: f32) -> Result<f32, String> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(format!(
        "{what} must be finite and greater than 0, not {value}"
    ))
}

fn finite(what: &str, value: f32) -> Result<f32, String> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(format!("{what} must be finite, not {value}"))
}

macro_rules! units {
    ($($(#[$doc:meta])* $unit:ident = $quantity:ident, $check:ident($what:literal);)*) => {$(
        $(#[$doc])*
        pub(crate) struct $unit;

        impl Unit for $unit {
            const QUANTITY: Quantity = Quantity::$quantity;

            fn read(value: f32) -> Result<f32, String> {
                $check($what, value)
            }
        }
    )*};
}

units! {
    /// A radius in metres, greater than 0.
    Radius = Length, positive("a radius in metres");
    /// A length in metres, greater than 0.
    Length = Length, positive("a length in metres");
    /// One side of a full size in metres, greater than 0.
    Side = Length, positive("a size in metres");
    /// A factor, greater than 0.
    Factor = Factor, positive("a factor");
    /// A coordinate or a difference of coordinates, in metres.
    Metres = Position, finite("a position in metres");
    /// Any number.
    Plain = Plain, finite("a number");
}

/// An angle: degrees in the file, radians in the code.
pub(crate) struct Angle;

impl Unit for Angle {
    const QUANTITY: Quantity = Quantity::Angle;

    fn read(value: f32) -> Result<f32, String> {
        finite("an angle in degrees", value).map(f32::to_radians)
    }
}

/// From 0 to 1.
pub(crate) struct Share;

impl Unit for Share {
    const QUANTITY: Quantity = Quantity::Share;

    fn read(value: f32) -> Result<f32, String> {
        if (0.0..=1.0).contains(&value) {
            return Ok(value);
        }
        Err(format!("a share must be 0 to 1, not {value}"))
    }
}

/// A number of a surface, in the unit of the code.
#[derive(Deserialize)]
#[serde(try_from = "Said", bound = "U: Unit")]
pub(crate) struct Number<U> {
    /// Its value at time 0.
    pub start: f32,
    /// Its motion.
    pub motion: Option<Motion>,
    unit: PhantomData<U>,
}

/// Three numbers along x, y and z.
#[derive(Deserialize)]
#[serde(
    from = "(Number<U>, Number<U>, Number<U>)",
    bound(deserialize = "U: Unit")
)]
pub(crate) struct Vector<U>(pub [Number<U>; 3]);

/// Two numbers, x and y.
#[derive(Deserialize)]
#[serde(from = "(Number<U>, Number<U>)", bound(deserialize = "U: Unit"))]
pub(crate) struct Pair<U>(pub [Number<U>; 2]);

/// A number as the file writes it.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "Expected a number, Keys([(seconds, number), …]) or Value(\"name\", number)"
)]
enum Said {
    Plain(f32),
    Driven(Driven),
}

/// The motion of a number.
#[derive(Deserialize)]
enum Driven {
    Keys(Vec<(f64, f32)>),
    Value(Name, f32),
}

/// A name: up to 200 characters, all of them visible.
#[derive(Default, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Name(pub String);

impl TryFrom<String> for Name {
    type Error = String;
    fn try_from(name: String) -> Result<Name, String> {
        match text::check_name(&name) {
            Ok(()) => Ok(Name(name)),
            Err(why) => Err(format!("a name {why}")),
        }
    }
}

impl<U> Number<U> {
    /// A number that stands still.
    pub fn fixed(value: f32) -> Number<U> {
        Number {
            start: value,
            motion: None,
            unit: PhantomData,
        }
    }
}

impl<U: Unit> TryFrom<Said> for Number<U> {
    type Error = String;
    fn try_from(said: Said) -> Result<Number<U>, String> {
        let (start, motion) = match said {
            Said::Plain(value) => (U::read(value)?, None),
            Said::Driven(Driven::Value(Name(name), value)) => {
                if name.is_empty() {
                    return Err("a named value needs a name".to_owned());
                }
                (U::read(value)?, Some(Motion::Named(name)))
            }
            Said::Driven(Driven::Keys(keys)) => {
                let keys = read_keys::<U>(keys)?;
                let motion = Motion::Keys(keys);
                (motion.at(0.0).unwrap_or_default(), Some(motion))
            }
        };
        Ok(Number {
            start,
            motion,
            unit: PhantomData,
        })
    }
}

fn read_keys<U: Unit>(keys: Vec<(f64, f32)>) -> Result<Vec<(f64, f32)>, String> {
    if keys.is_empty() {
        return Err("Keys needs at least one (seconds, number)".to_owned());
    }
    if let Some((time, _)) = keys.iter().find(|(time, _)| !time.is_finite()) {
        return Err(format!("a key's time must be finite, not {time}"));
    }
    if !keys.windows(2).all(|pair| pair[0].0 < pair[1].0) {
        return Err("the times of a number's keys must increase".to_owned());
    }
    keys.into_iter()
        .map(|(time, value)| Ok((time, U::read(value)?)))
        .collect()
}

impl<U> From<(Number<U>, Number<U>, Number<U>)> for Vector<U> {
    fn from((x, y, z): (Number<U>, Number<U>, Number<U>)) -> Vector<U> {
        Vector([x, y, z])
    }
}

impl<U> From<(Number<U>, Number<U>)> for Pair<U> {
    fn from((x, y): (Number<U>, Number<U>)) -> Pair<U> {
        Pair([x, y])
    }
}

impl<U> Default for Vector<U> {
    fn default() -> Vector<U> {
        Vector([0.0; 3].map(Number::fixed))
    }
}

impl<U> Default for Number<U> {
    fn default() -> Number<U> {
        Number::fixed(0.0)
    }
}

/// Any finite number that does not move.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct Finite(pub f64);

/// An angle in degrees that does not move, kept in radians.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f32")]
pub(crate) struct Degrees(pub f32);

/// A radius in metres that does not move, finite and greater than 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(crate) struct FixedRadius(pub f32);

/// A position in metres that does not move.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "(f32, f32, f32)")]
pub(crate) struct Point(pub Vec3);

/// Full width, height and depth in metres that do not move, each finite and greater than 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "(f32, f32, f32)")]
pub(crate) struct Size(pub Vec3);

/// Maximum growth of a value, in metres a metre: the stated Lipschitz constant.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(crate) struct Lipschitz(pub f32);

impl TryFrom<f64> for Finite {
    type Error = String;
    fn try_from(value: f64) -> Result<Finite, String> {
        if value.is_finite() {
            return Ok(Finite(value));
        }
        Err(format!("a number must be finite, not {value}"))
    }
}

impl TryFrom<f32> for Degrees {
    type Error = String;
    fn try_from(degrees: f32) -> Result<Degrees, String> {
        Angle::read(degrees).map(Degrees)
    }
}

impl TryFrom<f32> for FixedRadius {
    type Error = String;
    fn try_from(metres: f32) -> Result<FixedRadius, String> {
        Radius::read(metres).map(FixedRadius)
    }
}

impl TryFrom<f32> for Lipschitz {
    type Error = String;
    fn try_from(constant: f32) -> Result<Lipschitz, String> {
        positive("a Lipschitz constant", constant).map(Lipschitz)
    }
}

impl TryFrom<(f32, f32, f32)> for Point {
    type Error = String;
    fn try_from(metres: (f32, f32, f32)) -> Result<Point, String> {
        let point = Vec3::from(metres);
        if point.is_finite() {
            return Ok(Point(point));
        }
        Err(format!("a position in metres must be finite, not {point}"))
    }
}

impl TryFrom<(f32, f32, f32)> for Size {
    type Error = String;
    fn try_from(metres: (f32, f32, f32)) -> Result<Size, String> {
        let size = Vec3::from(metres);
        if size.is_finite() && size.min_element() > 0.0 {
            return Ok(Size(size));
        }
        Err(format!(
            "a size in metres must be finite and greater than 0 in all three axes, not {size}"
        ))
    }
}

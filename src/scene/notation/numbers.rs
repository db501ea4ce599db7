//! Numbers of a scene file, which are checked while they are read, and the drivers of moving numbers.
//!
//! Each number of a surface is a plain number, a list of key frames, or a named value:
//!
//! ```ron
//! radius: 1.5
//! radius: Keys([(0, 1.0), (2, 3.0)])
//! radius: Value("door", 1.5)
//! ```

use super::Attached;
use crate::scene::{Driver, Motion, Quantity, SceneError};
use crate::text;
use glam::{Vec2, Vec3};
use serde::Deserialize;
use std::marker::PhantomData;

/// The quantity of a number: checks the number, and converts it from the unit of the file to the unit of the code.
pub(crate) trait Unit {
    /// The quantity in the code.
    const QUANTITY: Quantity;

    /// Converts the value to the unit of the code.
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

fn angle(degrees: f32) -> Result<f32, String> {
    finite("an angle in degrees", degrees).map(f32::to_radians)
}

fn share(value: f32) -> Result<f32, String> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(format!("a share must be 0 to 1, not {value}"))
}

macro_rules! units {
    ($($(#[$doc:meta])* $unit:ident = $quantity:ident, $check:ident($($what:literal)?);)*) => {$(
        $(#[$doc])*
        pub(crate) struct $unit;

        impl Unit for $unit {
            const QUANTITY: Quantity = Quantity::$quantity;

            fn read(value: f32) -> Result<f32, String> {
                $check($($what,)? value)
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
    /// An angle: degrees in the file, radians in the code.
    Angle = Angle, angle();
    /// A turn per length: degrees per metre in the file, radians per metre in the code.
    Rate = Rate, angle();
    /// A share, 0 to 1.
    Share = Share, share();
}

/// A number of a surface, in the unit of the code.
#[derive(Deserialize)]
#[serde(try_from = "Said", bound = "U: Unit")]
pub(crate) struct Number<U> {
    /// Value at time 0.
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

/// A number as it is written in the file.
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

impl<U> Number<U> {
    /// Creates a number without motion.
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

/// The three corners of a triangle.
#[derive(Deserialize)]
#[serde(try_from = "Vec<Pair<U>>", bound(deserialize = "U: Unit"))]
pub(crate) struct Corners<U>([Pair<U>; 3]);

impl<U> TryFrom<Vec<Pair<U>>> for Corners<U> {
    type Error = String;
    fn try_from(corners: Vec<Pair<U>>) -> Result<Corners<U>, String> {
        let count = corners.len();
        let three = corners.try_into().map(Corners);
        three.map_err(|_| format!("a prism has 3 corners (x, y), not {count}"))
    }
}

/// Reads one surface and collects the drivers of its numbers.
pub(crate) struct Reader<'a> {
    files: &'a Attached,
    drivers: Vec<Driver>,
    /// Prefix of the names of the numbers to be read: the indices of the children on the path from the root, such as
    /// `1.0.`.
    at: String,
}

/// A single number, or the numbers of a vector, as written in the file.
pub(crate) trait ReadNumbers: Sized {
    /// The type of the values in the file.
    type Said<U: Unit>;

    /// Returns the values at time 0 and stores the drivers.
    fn read<U: Unit>(said: Self::Said<U>, name: &str, reader: &mut Reader) -> Self;
}

impl ReadNumbers for f32 {
    type Said<U: Unit> = Number<U>;

    fn read<U: Unit>(said: Number<U>, name: &str, reader: &mut Reader) -> f32 {
        reader.number(name, said)
    }
}

impl ReadNumbers for Vec2 {
    type Said<U: Unit> = Pair<U>;

    fn read<U: Unit>(said: Pair<U>, name: &str, reader: &mut Reader) -> Vec2 {
        let [x, y] = said.0;
        Vec2::new(
            reader.number(&format!("{name}.x"), x),
            reader.number(&format!("{name}.y"), y),
        )
    }
}

impl ReadNumbers for Vec3 {
    type Said<U: Unit> = Vector<U>;

    fn read<U: Unit>(said: Vector<U>, name: &str, reader: &mut Reader) -> Vec3 {
        let [x, y, z] = said.0;
        Vec3::new(
            reader.number(&format!("{name}.x"), x),
            reader.number(&format!("{name}.y"), y),
            reader.number(&format!("{name}.z"), z),
        )
    }
}

impl ReadNumbers for [Vec2; 3] {
    type Said<U: Unit> = Corners<U>;

    fn read<U: Unit>(said: Corners<U>, name: &str, reader: &mut Reader) -> [Vec2; 3] {
        let mut corners = [Vec2::ZERO; 3];
        for (index, said) in said.0.into_iter().enumerate() {
            corners[index] = Vec2::read(said, &format!("{name}.{index}"), reader);
        }
        corners
    }
}

impl<'a> Reader<'a> {
    /// Creates a reader of a surface that finds its files in `files`.
    pub fn new(files: &'a Attached) -> Reader<'a> {
        Reader {
            files,
            drivers: Vec::new(),
            at: String::new(),
        }
    }

    /// The files that the scene names.
    pub fn files(&self) -> &'a Attached {
        self.files
    }

    /// The drivers of the numbers that were read.
    pub fn into_drivers(self) -> Vec<Driver> {
        self.drivers
    }

    /// Whether a driver moves a number whose name begins with `name`.
    pub fn moves(&self, name: &str) -> bool {
        let mut drivers = self.drivers.iter();
        drivers.any(|driver| driver.parameter.starts_with(name))
    }

    /// Returns the value of a number at time 0 and stores its driver.
    pub fn number<U>(&mut self, name: &str, said: Number<U>) -> f32 {
        if let Some(motion) = said.motion {
            let parameter = format!("{}{name}", self.at);
            self.drivers.push(Driver { parameter, motion });
        }
        said.start
    }

    /// Reads numbers of the child with this index.
    pub fn within<T>(
        &mut self,
        index: usize,
        read: impl FnOnce(&mut Reader) -> Result<T, SceneError>,
    ) -> Result<T, SceneError> {
        let before = self.at.len();
        self.at.push_str(&format!("{index}."));
        let result = read(self);
        self.at.truncate(before);
        result
    }
}

/// Defines wrapper types whose values are checked while they are read. Each has the type in the file and the check.
macro_rules! checked {
    ($($(#[$meta:meta])* $visible:vis $name:ident($value:ty) from $said:ty: $check:expr;)*) => {$(
        $(#[$meta])*
        $visible struct $name(pub $value);

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<$name, D::Error> {
                let check: fn($said) -> Result<$value, String> = $check;
                let value = check(<$said as serde::Deserialize>::deserialize(from)?);
                value.map($name).map_err(<D::Error as serde::de::Error>::custom)
            }
        }
    )*};
}
pub(in crate::scene) use checked;

checked! {
    /// A name of at most 200 visible characters.
    #[derive(Default)]
    pub(crate) Name(String) from String: name;
    /// A finite number that does not move.
    #[derive(Clone, Copy, Default)]
    pub(crate) Finite(f64) from f64: |value| match value.is_finite() {
        true => Ok(value),
        false => Err(format!("a number must be finite, not {value}")),
    };
    /// An angle in degrees that does not move, stored in radians.
    #[derive(Clone, Copy, Default)]
    pub(crate) Degrees(f32) from f32: angle;
    /// A radius in metres that does not move, finite and greater than 0.
    #[derive(Clone, Copy)]
    pub(crate) FixedRadius(f32) from f32: Radius::read;
    /// A position in metres that does not move.
    #[derive(Clone, Copy, Default)]
    pub(crate) Point(Vec3) from (f32, f32, f32): point;
    /// Full width, height and depth in metres that do not move, each finite and greater than 0.
    #[derive(Clone, Copy)]
    pub(crate) Size(Vec3) from (f32, f32, f32): size;
    /// Stated Lipschitz constant: maximum rate of change of a value, in metres per metre.
    #[derive(Clone, Copy)]
    pub(crate) Lipschitz(f32) from f32: |constant| positive("a Lipschitz constant", constant);
    /// Stated bend, per metre: an upper bound of −f″ along any line, where f is the value.
    #[derive(Clone, Copy)]
    pub(crate) MostBend(f32) from f32: |bend| match bend.is_finite() && bend >= 0.0 {
        true => Ok(bend),
        false => Err(format!("a bend must be finite and at least 0 per metre, not {bend}")),
    };
}

fn name(name: String) -> Result<String, String> {
    match text::check_name(&name) {
        Ok(()) => Ok(name),
        Err(why) => Err(format!("a name {why}")),
    }
}

fn point(metres: (f32, f32, f32)) -> Result<Vec3, String> {
    let point = Vec3::from(metres);
    if point.is_finite() {
        return Ok(point);
    }
    Err(format!("a position in metres must be finite, not {point}"))
}

fn size(metres: (f32, f32, f32)) -> Result<Vec3, String> {
    let size = Vec3::from(metres);
    if size.is_finite() && size.min_element() > 0.0 {
        return Ok(size);
    }
    Err(format!(
        "a size in metres must be finite and greater than 0 in all three axes, not {size}"
    ))
}

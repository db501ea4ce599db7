//! Quantities of the numbers in a scene, and their units in files and in code.

/// The quantity of a surface's number, which determines its unit in a scene file and its valid
/// range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate or a difference of coordinates, in metres.
    Position,
    /// A length in metres, greater than 0.
    Length,
    /// A factor, greater than 0.
    Factor,
    /// An angle, in degrees.
    Angle,
    /// A turn per length, in degrees a metre.
    Rate,
    /// From 0 to 1.
    Share,
    /// Any number.
    Plain,
}

impl Quantity {
    /// The unit after a number in a message that uses the code's own units.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Quantity::Position | Quantity::Length => " metres",
            Quantity::Angle => " radians",
            Quantity::Rate => " radians a metre",
            Quantity::Factor | Quantity::Share | Quantity::Plain => "",
        }
    }

    /// Converts a number of the code to the unit of the file.
    pub fn in_file(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_degrees(),
            _ => value,
        }
    }

    /// Converts a number of the file to the unit of the code.
    pub fn in_code(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_radians(),
            _ => value,
        }
    }

    /// A higher rank has a narrower valid range.
    pub(super) fn rank(self) -> u8 {
        match self {
            Quantity::Plain => 0,
            Quantity::Position => 1,
            Quantity::Angle | Quantity::Rate => 2,
            Quantity::Length | Quantity::Factor => 3,
            Quantity::Share => 4,
        }
    }
}

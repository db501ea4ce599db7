//! What the numbers of a scene measure, and their units in files and in code.

/// What a number of a surface measures, and so its unit in a scene file and how far it may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate or a difference of such, in metres.
    Position,
    /// A length in metres, greater than 0.
    Length,
    /// A factor, greater than 0.
    Factor,
    /// An angle, in degrees.
    Angle,
    /// A turn along a way, in degrees a metre.
    Rate,
    /// From 0 to 1.
    Share,
    /// Any number.
    Plain,
}

impl Quantity {
    /// The unit behind a number in a sentence about the code's own units.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Quantity::Position | Quantity::Length => " metres",
            Quantity::Angle => " radians",
            Quantity::Rate => " radians a metre",
            Quantity::Factor | Quantity::Share | Quantity::Plain => "",
        }
    }

    /// A number of the code in the unit of the file.
    pub fn in_file(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_degrees(),
            _ => value,
        }
    }

    /// A number of the file in the unit of the code.
    pub fn in_code(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_radians(),
            _ => value,
        }
    }

    /// The more, the less is allowed.
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

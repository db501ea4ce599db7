//! A hyperboloid of one or two sheets.

use super::part::{part, surface_kind};
use super::quadric::straight_quadric;
use super::{Bounds3, Part, Properties, Quadric, Shape};
use crate::scene::notation::{Fields, Written};
use glam::DVec3;
use serde::de::{Deserialize, Deserializer, Error};

part! {
    /// A hyperboloid about the y axis. With one sheet, x² + z² < waist² (1 + y²/rise²): a solid with a waist. With two
    /// sheets, y² > rise² (1 + (x² + z²)/waist²): two solid bowls.
    Hyperboloid {
        /// Radius at the waist, in metres. For two sheets, the radius at which the asymptotic cone has the height
        /// `rise`.
        waist: f32 as Length,
        /// Height in metres at which the asymptotic cone has the radius `waist`.
        rise: f32 as Length,
    } and {
        /// Whether there are two sheets.
        #[serde(rename = "sheets", default, deserialize_with = "two_sheets")]
        two_sheets: bool,
    }
}

/// Reads the number of sheets, and returns whether there are two.
fn two_sheets<'de, D: Deserializer<'de>>(from: D) -> Result<bool, D::Error> {
    match i64::deserialize(from)? {
        1 => Ok(false),
        2 => Ok(true),
        sheets => Err(D::Error::custom(format!(
            "a hyperboloid has 1 or 2 sheets, not {sheets}"
        ))),
    }
}

impl Part for Hyperboloid {
    surface_kind!(SMOOTH);

    fn words(&self) -> Fields {
        let sheets = if self.two_sheets { 2 } else { 1 };
        vec![("sheets", Written::Count(sheets))]
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::bound(Bounds3::EVERYWHERE)
    }

    fn own_length(&self) -> f64 {
        f64::from(self.waist.max(self.rise))
    }

    straight_quadric!();
}

impl Hyperboloid {
    fn form(&self) -> Quadric {
        let square = |length: f32| f64::from(length).powi(2);
        let (across, up) = (1.0 / square(self.waist), 1.0 / square(self.rise));
        let constant = if self.two_sheets { 1.0 } else { -1.0 };
        Quadric::straight(DVec3::new(across, -up, across), DVec3::ZERO, constant)
    }
}

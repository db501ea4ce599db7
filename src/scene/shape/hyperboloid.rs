//! A hyperboloid of one or of two sheets.

use super::part::parameters;
use super::quadric::straight_quadric;
use super::{Bounds3, Part, Properties, Quadric, Shape, SurfaceKind};
use crate::scene::notation::{Fields, Length, Number, Reader, Sheets, Written};
use crate::scene::shape::FromFile;
use crate::scene::{Quantity, SceneError};
use glam::DVec3;
use serde::Deserialize;

/// A hyperboloid about y. One sheet: x² + z² < waist² (1 + y²/rise²), a solid with a waist.
/// Two sheets: y² > rise² (1 + (x² + z²)/waist²), two solid bowls.
#[derive(Clone, Debug, PartialEq)]
pub struct Hyperboloid {
    /// Radius at the waist, in metres; for two sheets, that of the hyperbola's box.
    pub waist: f32,
    /// Height in metres over which the asymptotic cone is as wide as the waist.
    pub rise: f32,
    /// Whether there are two sheets.
    pub two_sheets: bool,
}

/// Its form in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    waist: Number<Length>,
    rise: Number<Length>,
    #[serde(default)]
    sheets: Sheets,
}

impl FromFile for File {
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
        Ok(Shape::from(Hyperboloid {
            waist: reader.number("waist", self.waist),
            rise: reader.number("rise", self.rise),
            two_sheets: self.sheets.0,
        }))
    }
}

parameters!(Hyperboloid {
    waist: Quantity::Length,
    rise: Quantity::Length
});

impl Part for Hyperboloid {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::SMOOTH
    }

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

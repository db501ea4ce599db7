//! A child cut and moved apart.

use super::part::numbers;
use super::{Exactness, Part, Properties, Shape, ShapeFile};
use glam::{DVec3, Vec3};

numbers! {
    /// Its child cut at the coordinate planes and moved apart, with the gap filled straight.
    Elongate over (of: Box<ShapeFile>) {
        /// Distance that each half moves along x, y and z, in metres.
        by: Vec3 as Metres,
    }
}

impl Part for Elongate {
    fn check(&self) -> Result<(), String> {
        if self.by.min_element() >= 0.0 {
            return Ok(());
        }
        Err("its lengths must not be negative".to_owned())
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            in_air: Exactness::bound(of.lipschitz),
            in_solid: Exactness::bound(of.lipschitz),
            bounds: of.bounds.grown(self.by.as_dvec3()),
            // A slanted side that crosses the cut gets a step; a symmetric solid becomes its sum
            // with a box of half size `by`.
            convex: of.convex && (0..3).all(|a| self.by[a] == 0.0 || of.symmetric[a]),
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.as_dvec3().abs().max_element()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let by = self.by.as_dvec3();
        children[0].value(p - p.clamp(-by, by))
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.by.as_dvec3().to_array().to_vec()
    }
}

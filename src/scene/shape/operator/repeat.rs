//! Repetition: determines the copies of a repeated field that can be nearest to a point.
//!
//! Along one axis with period P, a point q relative to the middle of copy i lies in the cell of this copy if |q| ≤ P/2.
//! If the child lies within its cell, the nearest copy is copy i or the next copy on the side of q. For every point x
//! of copy i, |q − x| ≤ |q − (x − P)| if q ≥ 0 and x ≤ P/2. If the child is also symmetric about the middle of its
//! cell, copy i is the nearest. If the child extends up to k periods beyond its cell, k more copies on either side can
//! be the nearest.
//!
//! These rules hold for exact distances. A bound of the distance may be smaller for a more distant copy. Its value
//! would jump where that copy is no longer evaluated. The value is therefore limited by the minimum value of the copies
//! that are not evaluated, see [`Cap`].

use super::{Bounds3, Exactness, Node, Part, Properties, Shape, ShapeFile, part, surface_kind};
use crate::scene::notation::{Fields, Written};
use glam::{DVec3, Vec3};
use serde::de::{Deserialize, Deserializer};

part! {
    /// The child, repeated along the axes.
    Repeat over (of: Box<ShapeFile>) {
        /// Distance between copies in metres along x, y and z; 0 for an axis without repetition.
        period: Vec3 as Metres,
    } and {
        /// Number of copies along each axis, centred on the origin; 0 for infinitely many.
        #[serde(default, deserialize_with = "counts")]
        count: [u32; 3],
    }
}

fn counts<'de, D: Deserializer<'de>>(from: D) -> Result<[u32; 3], D::Error> {
    <(u32, u32, u32)>::deserialize(from).map(<[u32; 3]>::from)
}

/// Maximum gap or overlap between touching copies due to rounding, as a share of the period.
const TOUCHING: f64 = 1e-6;

/// Exclusive upper limit of a count, up to which `f32` can distinguish neighbouring copies.
const MOST_COUNTED: u32 = 1 << 24;

impl Part for Repeat {
    surface_kind!(FLAT);

    fn copies(&self) -> bool {
        true
    }

    fn keeps_apart(&self, children: &[Shape]) -> bool {
        let size = 2.0 * children[0].properties().bounds.half_size();
        let period = self.period.as_dvec3();
        (0..3).all(|axis| period[axis] == 0.0 || size[axis] < (1.0 - TOUCHING) * period[axis])
    }

    fn words(&self) -> Fields {
        let count = self.count.map(Written::Count);
        vec![("count", Written::Tuple(count.to_vec()))]
    }

    fn check(&self) -> Result<(), String> {
        if self.count.iter().any(|count| *count >= MOST_COUNTED) {
            return Err("its counts must be below 16777216".to_owned());
        }
        if self.period.min_element() >= 0.0 && self.period.max_element() > 0.0 {
            return Ok(());
        }
        Err("its period must be greater than 0 along at least one axis, and 0 along the axes without repetition".to_owned())
    }

    fn check_over(&self, children: &[Shape]) -> Result<(), String> {
        self.copies(&children[0]).map(|_| ())
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let mut result = of;
        result.convex = false;
        result.in_solid = Exactness::bound(of.lipschitz);
        for axis in (0..3).filter(|&axis| self.period[axis] != 0.0) {
            let reach = match self.count[axis] {
                0 => f64::INFINITY,
                count => 0.5 * f64::from(count - 1) * f64::from(self.period[axis]),
            };
            result.bounds.min[axis] -= reach;
            result.bounds.max[axis] += reach;
        }
        result
    }

    fn own_length(&self) -> f64 {
        self.period.as_dvec3().max_element()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let child = &children[0];
        let cap = self.cap(child).map_or(f64::INFINITY, |cap| cap.at(p));
        let values = self.places(child, p).into_iter().map(|at| child.value(at));
        values.fold(cap, f64::min)
    }

    fn shader_numbers(&self, children: &[Shape]) -> Vec<f64> {
        let mut numbers = self.period.as_dvec3().to_array().to_vec();
        let copy = copy_box(&children[0]);
        numbers.extend(copy.min.to_array());
        numbers.extend(copy.max.to_array());
        if let Some(cap) = self.cap(&children[0]) {
            numbers.extend(cap.half_size.to_array());
            numbers.extend([cap.near, cap.inverse_slowness]);
        }
        numbers
    }
}

/// Maximum number of evaluated copies, which limits the cost of an evaluation.
const MOST_COPIES: u32 = 64;

/// The copies evaluated along one axis, relative to the cell that contains the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copies {
    /// The axis is not repeated.
    None,
    /// Only the copy in the cell that contains the point.
    Own,
    /// The copy in the point's cell, and the next copy on the point's side.
    OwnAndNext,
    /// The copy in the point's cell, and this number of copies on either side.
    Around(u32),
}

impl Copies {
    /// Number of copies.
    pub fn count(self) -> u32 {
        match self {
            Copies::None | Copies::Own => 1,
            Copies::OwnAndNext => 2,
            Copies::Around(reach) => 2 * reach + 1,
        }
    }
}

fn along(bounds: Bounds3, symmetric: bool, axis: usize, step: f64) -> Result<Copies, String> {
    let name = ["x", "y", "z"][axis];
    let (least, most) = (bounds.min[axis], bounds.max[axis]);
    if bounds.is_empty() {
        return Ok(Copies::Own);
    }
    if !(least.is_finite() && most.is_finite()) {
        return Err(format!(
            "its child is unbounded along {name}, so that copies cannot be distinguished"
        ));
    }
    let reach = (most.abs().max(least.abs()) - 0.5 * step) / step;
    // A child that touches the face of its cell counts as within the cell, despite rounding errors.
    if reach <= TOUCHING {
        return Ok(if symmetric {
            Copies::Own
        } else {
            Copies::OwnAndNext
        });
    }
    // |q − x| is at most (1 + reach) periods. The nearest copy of x is therefore at most this number of periods away,
    // rounded.
    Ok(Copies::Around((reach + 1.5).min(1e6) as u32))
}

/// An upper limit for the value of a repeated bound. Near the copies it is `near`. Farther away, it is the distance to
/// the box around all copies, divided by the slowness of the child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cap {
    pub near: f64,
    pub inverse_slowness: f64,
    pub half_size: DVec3,
}

impl Cap {
    pub fn at(&self, p: DVec3) -> f64 {
        let beyond = (p.abs() - self.half_size).max_element();
        self.near.max(beyond * self.inverse_slowness)
    }
}

impl Repeat {
    /// The cap for a bound that is evaluated for several copies; `None` if no cap is necessary.
    pub(crate) fn cap(&self, child: &Shape) -> Option<Cap> {
        let of = child.properties();
        if of.in_air == Exactness::Exact || of.bounds.is_empty() {
            return None;
        }
        let (copies, period) = (self.copies(child).ok()?, self.period.as_dvec3());
        let far = |b: Bounds3| b.min.abs().max(b.max.abs());
        let reach = far(of.bounds);
        // The least distance to the bounds of a copy at the point where its evaluation begins or ends: the middle or
        // the face of a cell.
        let along = (0..3).filter_map(|axis| match copies[axis] {
            Copies::None | Copies::Own => None,
            Copies::OwnAndNext => Some(period[axis] - reach[axis]),
            Copies::Around(more) => Some((f64::from(more) + 0.5) * period[axis] - reach[axis]),
        });
        let inverse_slowness = 1.0 / child.slowness();
        let whole = self.properties(std::slice::from_ref(child)).bounds;
        Some(Cap {
            near: along.reduce(f64::min)? * inverse_slowness,
            inverse_slowness,
            half_size: far(whole),
        })
    }

    /// The point `p` in the axes of each copy that can be the nearest.
    pub(crate) fn places(&self, child: &Shape, p: DVec3) -> Vec<DVec3> {
        let copies = self.copies(child).unwrap_or([Copies::Own; 3]);
        let period = self.period.as_dvec3();
        let along = |axis: usize| offsets(p[axis], period[axis], self.count[axis], copies[axis]);
        let (xs, ys, zs) = (along(0), along(1), along(2));
        let mut places = Vec::with_capacity(xs.len() * ys.len() * zs.len());
        for x in &xs {
            for y in &ys {
                places.extend(zs.iter().map(|z| DVec3::new(*x, *y, *z)));
            }
        }
        places
    }

    /// The copies that are evaluated along x, y and z.
    ///
    /// # Errors
    /// A message that states why the repetition is not safe.
    pub(crate) fn copies(&self, child: &Shape) -> Result<[Copies; 3], String> {
        let of = child.properties();
        let mut all = [Copies::None; 3];
        for axis in (0..3).filter(|&axis| self.period[axis] != 0.0) {
            let step = f64::from(self.period[axis]);
            all[axis] = along(of.bounds, of.symmetric[axis], axis, step)?;
        }
        let count: u64 = all.iter().map(|c| u64::from(c.count())).product();
        if count > u64::from(MOST_COPIES) {
            return Err(format!(
                "its copies overlap, and {count} of them can be nearest, more than {MOST_COPIES}: make the period longer"
            ));
        }
        Ok(all)
    }
}

/// Larger than any position in a scene, and finite in `f32` after division by the smallest component of a ray's
/// direction.
fn copy_box(child: &Shape) -> Bounds3 {
    /// Larger than any position in a scene, and finite in `f32` after division by the least slowness.
    const NO_END: DVec3 = DVec3::splat(1e15);
    let bounds = child.properties().bounds;
    if bounds.is_empty() {
        return Bounds3::centred(DVec3::ZERO);
    }
    Bounds3 {
        min: bounds.min.max(-NO_END),
        max: bounds.max.min(NO_END),
    }
}

impl Shape {
    /// Translations in metres that map the tree to itself: the periods of infinite repetitions.
    pub(crate) fn periods(&self) -> Vec<DVec3> {
        let below = || {
            self.children
                .first()
                .map(Shape::periods)
                .unwrap_or_default()
        };
        match &self.node {
            Node::Repeat(Repeat { period, count }) => {
                let endless = (0..3).filter(|&axis| period[axis] > 0.0 && count[axis] == 0);
                let own = endless.map(|axis| DVec3::AXES[axis] * f64::from(period[axis]));
                own.chain(below()).collect()
            }
            Node::Translate(_) | Node::Complement(_) | Node::Shell(_) | Node::Offset(_) => below(),
            Node::Rotate(rotate) => {
                let turn = rotate.matrix();
                below().into_iter().map(|period| turn * period).collect()
            }
            Node::Scale(scale) => {
                let by = f64::from(scale.by);
                below().into_iter().map(|period| by * period).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The cap of a [`Repeat`]; `None` if a cap is not necessary.
    pub(crate) fn cap(&self) -> Option<Cap> {
        match (&self.node, self.children.first()) {
            (Node::Repeat(repeat), Some(child)) => repeat.cap(child),
            _ => None,
        }
    }

    /// The copies of a [`Repeat`] that are evaluated along x, y and z.
    ///
    /// # Errors
    /// A message that states why the repetition is not safe.
    pub(crate) fn copies(&self) -> Result<[Copies; 3], String> {
        match (&self.node, self.children.first()) {
            (Node::Repeat(repeat), Some(child)) => repeat.copies(child),
            _ => Ok([Copies::None; 3]),
        }
    }
}

/// The coordinates of a point along one axis, relative to each copy that can be the nearest.
fn offsets(q: f64, period: f64, count: u32, copies: Copies) -> Vec<f64> {
    if copies == Copies::None || period == 0.0 {
        return vec![q];
    }
    // If the number of copies is even, there is no copy at the origin.
    let shift = if count > 0 && count.is_multiple_of(2) {
        0.5 * period
    } else {
        0.0
    };
    let q = q - shift;
    let (first, last) = match count {
        0 => (f64::NEG_INFINITY, f64::INFINITY),
        count => {
            let first = -f64::from(count / 2);
            (first, first + f64::from(count - 1))
        }
    };
    let own = (q / period).round().clamp(first, last);
    let copy = |index: f64| q - period * index.clamp(first, last);
    let side = if q >= period * own { 1.0 } else { -1.0 };
    match copies {
        Copies::None | Copies::Own => vec![copy(own)],
        Copies::OwnAndNext => vec![copy(own), copy(own + side)],
        Copies::Around(reach) => {
            let reach = i64::from(reach);
            (-reach..=reach)
                .map(|step| copy(own + step as f64))
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Sphere;
    use std::f32::consts::FRAC_PI_2;

    /// Protects distant positions in infinite repetitions. They are moved by the periods of the repetition, which are
    /// rotated and scaled with the repetition.
    #[test]
    fn periods_are_turned_and_scaled() {
        let repeat = Repeat {
            period: Vec3::new(3.0, 4.0, 0.0),
            count: [0, 2, 0],
        };
        let balls = Shape::from(Sphere { radius: 0.5 }).repeat(repeat.period, repeat.count);
        assert_eq!(balls.periods(), [DVec3::X * 3.0]);
        let scaled = balls.scale(2.0);
        assert_eq!(scaled.periods(), [DVec3::X * 6.0]);
        let turned = scaled.rotate(Vec3::Y * FRAC_PI_2);
        let [period] = turned.periods()[..] else {
            panic!("{:?}", turned.periods());
        };
        assert!(period.abs_diff_eq(DVec3::Z * -6.0, 1e-6), "{period}");
    }
}

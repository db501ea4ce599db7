//! Which copies of a repeated field can be the nearest.
//!
//! Along one axis a point q lies in the cell about copy i: |q − i P| ≤ P/2. If what is
//! repeated lies within its cell, the nearest copy is that one or the next on the side of
//! q: for every point x of it, |q − x| ≤ |q − (x − P)| for q ≥ 0 and x ≤ P/2. If it is
//! also symmetric about the cell's middle, copy i is the nearest alone. What reaches out
//! of its cell by up to k periods makes k more copies on either side matter.
//!
//! That is true of distances. A bound of the distance may be less for a copy that is further
//! away, and then would jump where that copy is evaluated no longer. So it is held at what
//! such a copy has at the least there, see [`Cap`].

use super::{Bounds3, Exactness, Field, Node, Properties};
use glam::{DVec3, Vec3};

/// Copies that are evaluated at the most: more would cost more than they are worth.
pub(super) const MOST_COPIES: u32 = 64;

/// Which copies along one axis are evaluated, relative to the cell that the point is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copies {
    /// The axis is not repeated.
    None,
    /// The copy of the cell.
    Own,
    /// That one, and the next on the point's side.
    OwnAndNext,
    /// So many to either side, and its own.
    Around(u32),
}

impl Copies {
    /// How many that are.
    pub fn count(self) -> u32 {
        match self {
            Copies::None | Copies::Own => 1,
            Copies::OwnAndNext => 2,
            Copies::Around(reach) => 2 * reach + 1,
        }
    }
}

/// What `Repeat` must evaluate along each axis, or why it cannot.
pub(super) fn copies(child: &Properties, period: Vec3) -> Result<[Copies; 3], String> {
    let mut all = [Copies::None; 3];
    for axis in 0..3 {
        let step = f64::from(period[axis]);
        if step == 0.0 {
            continue;
        }
        all[axis] = along(child.bounds, child.symmetric[axis], axis, step)?;
    }
    let count: u64 = all.iter().map(|c| u64::from(c.count())).product();
    if count > u64::from(MOST_COPIES) {
        return Err(format!(
            "its copies reach so far into each other that {count} of them can be nearest, more than {MOST_COPIES}: make the period longer"
        ));
    }
    Ok(all)
}

fn along(bounds: Bounds3, symmetric: bool, axis: usize, step: f64) -> Result<Copies, String> {
    let name = ["x", "y", "z"][axis];
    let (least, most) = (bounds.min[axis], bounds.max[axis]);
    if bounds.is_empty() {
        return Ok(Copies::Own);
    }
    if !(least.is_finite() && most.is_finite()) {
        return Err(format!(
            "what it repeats along {name} has no end there, so that copies cannot be told apart"
        ));
    }
    let reach = (most.abs().max(least.abs()) - 0.5 * step) / step;
    // What just touches its cell's face is within it, give or take rounding.
    if reach <= 1e-6 {
        return Ok(if symmetric {
            Copies::Own
        } else {
            Copies::OwnAndNext
        });
    }
    // |q − x| is at most (1 + reach) periods, so the nearest copy of x is that many, rounded.
    Ok(Copies::Around((reach + 1.5).min(1e6) as u32))
}

/// What the value of a repeated bound is held at: `near` among the copies, and further off
/// the way to the box about all of them, over the slowness of the value.
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

impl Field {
    /// The cap of a `Repeat` that needs one: of a bound that is evaluated for several copies.
    pub(crate) fn cap(&self) -> Option<Cap> {
        let Node::Repeat { period, .. } = &self.node else {
            return None;
        };
        let child = self.of.first()?.properties();
        if child.in_air == Exactness::Exact || child.bounds.is_empty() {
            return None;
        }
        let (copies, period) = (self.copies().ok()?, period.as_dvec3());
        let far = |b: Bounds3| b.min.abs().max(b.max.abs());
        let reach = far(child.bounds);
        // How far the bounds of a copy are at the least where it comes in or goes out: at the
        // middle of a cell, or at its face.
        let along = (0..3).filter_map(|axis| match copies[axis] {
            Copies::None | Copies::Own => None,
            Copies::OwnAndNext => Some(period[axis] - reach[axis]),
            Copies::Around(more) => Some((f64::from(more) + 0.5) * period[axis] - reach[axis]),
        });
        let inverse_slowness = 1.0 / self.of[0].slowness();
        Some(Cap {
            near: along.reduce(f64::min)? * inverse_slowness,
            inverse_slowness,
            half_size: far(self.properties().bounds),
        })
    }

    /// The copies of a `Repeat` that are evaluated along x, y and z.
    ///
    /// # Errors
    /// A sentence on why the repetition cannot be safe.
    pub fn copies(&self) -> Result<[Copies; 3], String> {
        match (&self.node, self.of.first()) {
            (Node::Repeat { period, .. }, Some(child)) => copies(&child.properties(), *period),
            _ => Ok([Copies::None; 3]),
        }
    }
}

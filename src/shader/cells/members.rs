//! Surfaces in the grid, their distances from the centre of a cell, and their groups.
//!
//! For a point outside the grid any surface can be the nearest. A group is skipped as a whole if its box is farther
//! away than the least distance found so far. There are about √n groups of √n surfaces each, so all √n boxes are
//! tested, but only the surfaces of few groups. The result is the least distance itself, not a bound.

use super::ENDLESS;
use crate::scene::{Bounds3, Exactness, Node, Surface};
use glam::{BVec3, DMat3, DVec3};

/// A surface in the grid.
#[derive(Clone, Debug)]
pub struct Member {
    /// Its index in the scene.
    pub index: u32,
    pub surface: Surface,
    pub bounds: Bounds3,
    /// Whether a positive value of its distance function equals the distance.
    pub exact: bool,
}

impl Member {
    pub fn new(index: u32, surface: &Surface) -> Member {
        let exact = surface.shape.properties().in_air == Exactness::Exact;
        Member {
            index,
            surface: surface.clone(),
            bounds: surface.bounds(),
            exact,
        }
    }

    /// Whether the value of the distance function at the centre of a box is the distance of that point. Without
    /// unbounded axes this is always so. With one unbounded axis it is so only for a cylinder that is infinite along
    /// this axis.
    fn is_told_by_value(&self, unbounded_axes: [bool; 3]) -> bool {
        let column = (0..3).find(|&axis| unbounded_axes[axis]);
        column.is_none_or(|axis| {
            unbounded_axes.iter().filter(|c| **c).count() == 1
                && matches!(self.surface.shape.node, Node::Cylinder(_))
                && self.bounds.min[axis].is_infinite()
        })
    }

    /// Whether its solid, or the box around it, may reach into a box.
    pub fn reaches_into(&self, bounds: Bounds3, unbounded_axes: [bool; 3], by_boxes: bool) -> bool {
        if by_boxes && unbounded_axes == [false; 3] {
            return self.box_meets(bounds);
        }
        self.least_distance(bounds, unbounded_axes) <= radius(bounds, unbounded_axes)
    }

    /// Whether the box around the surface, in the surface's own axes, may meet a box along the axes of the scene. No plane
    /// along a face of the surface's box separates two boxes that meet.
    fn box_meets(&self, other: Bounds3) -> bool {
        let rotation = self.surface.rotation.as_dquat().normalize();
        let own = rotation.inverse() * (other.middle() - self.surface.position.as_dvec3());
        let half = other.half_size();
        let turned = DMat3::from_quat(rotation.inverse());
        let reach = turned.x_axis.abs() * half.x
            + turned.y_axis.abs() * half.y
            + turned.z_axis.abs() * half.z;
        let bounds = self.surface.shape.properties().bounds;
        let rounding = radius(other, [false; 3]) - half.length();
        bounds.distance(own) <= radius(other, [false; 3])
            && bounds.grown(reach + rounding).distance(own) <= 0.0
    }

    /// A lower bound of the distance between the surface and the centre of a box.
    fn least_distance(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        let middle = middle(bounds, unbounded_axes);
        if self.is_told_by_value(unbounded_axes) {
            return f64::from(self.surface.distance(middle.as_vec3()));
        }
        let mask = BVec3::from_array(unbounded_axes);
        let flat = Bounds3 {
            min: DVec3::select(mask, DVec3::NEG_INFINITY, self.bounds.min),
            max: DVec3::select(mask, DVec3::INFINITY, self.bounds.max),
        };
        flat.distance(middle)
    }

    /// A lower bound of the surface's value at the centre of a box. If the value is only a bound of the distance, it
    /// may be less than the distance.
    pub fn least_value(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        match self.exact || self.is_told_by_value(unbounded_axes) {
            true => self.least_distance(bounds, unbounded_axes),
            false => f64::NEG_INFINITY,
        }
    }

    /// An upper bound of the distance between the surface and the centre of a box.
    pub fn most_distance(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        if !self.is_told_by_value(unbounded_axes) {
            return f64::INFINITY;
        }
        let middle = middle(bounds, unbounded_axes);
        if self.exact {
            return f64::from(self.surface.distance(middle.as_vec3()));
        }
        let far = (middle - self.bounds.min)
            .abs()
            .max((self.bounds.max - middle).abs());
        far.length()
    }
}

/// The centre of a box, 0 along unbounded axes.
fn middle(bounds: Bounds3, unbounded_axes: [bool; 3]) -> DVec3 {
    let middle = 0.5 * (bounds.min + bounds.max);
    DVec3::select(BVec3::from_array(unbounded_axes), DVec3::ZERO, middle)
}

/// Half the diagonal of a box, without its unbounded axes, plus the rounding error of a distance in `f32`.
pub fn radius(bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
    let flat = |v: DVec3| DVec3::select(BVec3::from_array(unbounded_axes), DVec3::ZERO, v);
    let half = flat(0.5 * (bounds.max - bounds.min));
    let place = flat(bounds.min.abs().max(bounds.max.abs()));
    half.length() + 8.0 * f64::from(f32::EPSILON) * place.max_element()
}

/// Bounds of all members. Along unbounded axes the bounds are infinite.
pub fn hull(members: &[Member], unbounded_axes: [bool; 3]) -> Bounds3 {
    let all = members.iter().map(|m| m.bounds).reduce(Bounds3::hull);
    let hull = all.unwrap_or(Bounds3::EVERYWHERE);
    let mask = BVec3::from_array(unbounded_axes);
    Bounds3 {
        min: DVec3::select(mask, DVec3::splat(-ENDLESS), hull.min),
        max: DVec3::select(mask, DVec3::splat(ENDLESS), hull.max),
    }
}

/// A group of nearby surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Bounds of the surfaces in world metres; ±1e9 m represents an infinite extent.
    pub bounds: Bounds3,
    /// Indices of the surfaces in the scene, in their order.
    pub surfaces: Vec<u32>,
}

/// Divides all members into groups.
pub(super) fn groups(members: &[Member]) -> Vec<Group> {
    // A value that is only a bound may be less than the distance to the box around the solid.
    let (exact, bounds): (Vec<&Member>, Vec<&Member>) = members.iter().partition(|m| m.exact);
    let most = (members.len() as f64).sqrt().ceil() as usize;
    let mut all = Vec::new();
    split(exact, most.max(1), &mut all);
    if !bounds.is_empty() {
        all.push(Group {
            bounds: ended(Bounds3::EVERYWHERE),
            ..group(&bounds)
        });
    }
    all
}

/// Halves the members by their centres along the longest axis until each part has at most `most` members.
fn split(mut members: Vec<&Member>, most: usize, all: &mut Vec<Group>) {
    if members.is_empty() {
        return;
    }
    if members.len() <= most {
        all.push(group(&members));
        return;
    }
    let middle = |member: &Member| ended(member.bounds).middle();
    let spread = Bounds3::of_points(members.iter().map(|member| middle(member)));
    let size = spread.max - spread.min;
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b]));
    let axis = axis.unwrap_or_default();
    members.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let upper = members.split_off(members.len() / 2);
    split(members, most, all);
    split(upper, most, all);
}

fn group(members: &[&Member]) -> Group {
    let bounds = members.iter().map(|member| ended(member.bounds));
    let mut surfaces: Vec<u32> = members.iter().map(|member| member.index).collect();
    surfaces.sort_unstable();
    Group {
        bounds: bounds.reduce(Bounds3::hull).unwrap_or(Bounds3::EVERYWHERE),
        surfaces,
    }
}

/// The same bounds, limited to coordinates whose squares are finite in `f32`.
fn ended(bounds: Bounds3) -> Bounds3 {
    let end = DVec3::splat(ENDLESS);
    Bounds3 {
        min: bounds.min.max(-end),
        max: bounds.max.min(end),
    }
}

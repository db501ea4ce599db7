//! Groups of nearby surfaces, for distances from outside the grid.
//!
//! Outside the grid any surface can be the nearest. A group whose box is further away than the
//! least distance yet found is skipped as a whole; about √n groups of √n surfaces each are
//! tested, and few of them need their surfaces tested. The result is the least distance itself, not
//! a bound.

use super::ENDLESS;
use super::member::Member;
use crate::scene::Bounds3;
use glam::DVec3;

/// A group of nearby surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Box that no surface of the group is nearer than (world metres); ±1e9 m represents an endless extent.
    pub bounds: Bounds3,
    /// Indices of the surfaces in the scene, in their order.
    pub surfaces: Vec<u32>,
}

/// Divides all members into groups.
pub(super) fn groups(members: &[Member]) -> Vec<Group> {
    // The value of a bound may be less than the distance to the box around the solid.
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

/// Halves the members by their centres along the longest axis until a part has at most `most`.
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

/// The same bounds, limited to coordinates that `f32` can square.
fn ended(bounds: Bounds3) -> Bounds3 {
    let end = DVec3::splat(ENDLESS);
    Bounds3 {
        min: bounds.min.max(-end),
        max: bounds.max.min(end),
    }
}

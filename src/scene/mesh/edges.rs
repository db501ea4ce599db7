//! The edges of a mesh: which triangles meet there, in which directions.

use super::MeshError;
use super::report::Defect;
use glam::Vec3;
use rayon::prelude::*;

/// One side of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The two corners, the smaller index first.
    corners: [u32; 2],
    /// Index of the triangle.
    pub triangle: u32,
    /// Number of the corner opposite of the side: 0 to 2.
    pub opposite: u8,
    /// Whether the triangle runs from the smaller to the larger index.
    pub is_forward: bool,
}

/// The sides of all triangles, sorted by their corners.
pub(super) struct Edges {
    sides: Vec<Side>,
}

impl Edges {
    pub fn of(triangles: &[[u32; 3]]) -> Edges {
        let sides_of = |(index, triangle): (usize, &[u32; 3])| {
            [0, 1, 2].map(|opposite: usize| {
                let (from, to) = (triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]);
                Side {
                    corners: [from.min(to), from.max(to)],
                    triangle: index as u32,
                    opposite: opposite as u8,
                    is_forward: from < to,
                }
            })
        };
        let all = triangles.par_iter().enumerate();
        let mut sides: Vec<Side> = all.flat_map_iter(sides_of).collect();
        sides.par_sort_unstable();
        Edges { sides }
    }

    /// The sides at each edge.
    pub fn all(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.corners == b.corners)
    }

    /// The edges with more faces on one side than on the other, and the edges with more than two faces.
    pub fn defects(&self, vertices: &[Vec3]) -> [Defect; 2] {
        let (mut open, mut crowded) = (Defect::default(), Defect::default());
        for sides in self.all() {
            let forward = sides.iter().filter(|side| side.is_forward).count();
            if 2 * forward != sides.len() {
                open.add(middle(sides, vertices));
            }
            if sides.len() > 2 {
                crowded.add(middle(sides, vertices));
            }
        }
        [open, crowded]
    }

    /// Whether two neighbouring triangles have opposite orientations.
    pub fn contradict(&self) -> bool {
        let mut pairs = self.all().filter(|sides| sides.len() == 2);
        pairs.any(|sides| sides[0].is_forward == sides[1].is_forward)
    }

    /// For each triangle, whether it must be reversed, so that neighbours have one orientation. Within each connected
    /// part the orientation of the larger area remains.
    ///
    /// # Errors
    /// [`MeshError::OneSided`] if no orientation exists.
    pub fn reversals(&self, vertices: &[Vec3], areas: &[f64]) -> Result<Vec<bool>, MeshError> {
        let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; areas.len()];
        for sides in self.all().filter(|sides| sides.len() == 2) {
            let differs = sides[0].is_forward == sides[1].is_forward;
            for (own, other) in [(sides[0], sides[1]), (sides[1], sides[0])] {
                let own = &mut neighbours[own.triangle as usize][usize::from(own.opposite)];
                *own = Some((other.triangle, differs));
            }
        }
        let mut reversed: Vec<Option<bool>> = vec![None; areas.len()];
        let mut part = Vec::new();
        for first in 0..areas.len() {
            if reversed[first].is_some() {
                continue;
            }
            reversed[first] = Some(false);
            part.clear();
            part.push(first);
            let mut next = 0;
            while let Some(&at) = part.get(next) {
                next += 1;
                for &(other, differs) in neighbours[at].iter().flatten() {
                    let wanted = reversed[at].map(|own| own != differs);
                    let known = &mut reversed[other as usize];
                    if known.is_none() {
                        *known = wanted;
                        part.push(other as usize);
                    }
                }
            }
            let area = |is: bool| -> f64 {
                let of = part.iter().filter(|at| reversed[**at] == Some(is));
                of.map(|at| areas[*at]).sum()
            };
            if area(true) > area(false) {
                for &at in &part {
                    reversed[at] = reversed[at].map(|is| !is);
                }
            }
        }
        let is_reversed = |side: &Side| reversed[side.triangle as usize] == Some(true);
        for sides in self.all().filter(|sides| sides.len() == 2) {
            let forward = |side: &Side| side.is_forward != is_reversed(side);
            if forward(&sides[0]) == forward(&sides[1]) {
                let place = middle(sides, vertices);
                return Err(MeshError::OneSided { place });
            }
        }
        Ok(reversed.into_iter().map(|is| is == Some(true)).collect())
    }
}

/// The middle of an edge.
fn middle(sides: &[Side], vertices: &[Vec3]) -> Vec3 {
    let ends = sides.first().map(|side| side.corners);
    ends.map_or(Vec3::ZERO, |[a, b]| {
        0.5 * (vertices[a as usize] + vertices[b as usize])
    })
}

/// Number of parts of triangles that have no corner in common.
pub(super) fn part_count(vertices: usize, triangles: &[[u32; 3]]) -> usize {
    let mut parent: Vec<u32> = (0..vertices as u32).collect();
    let mut is_used = vec![false; vertices];
    for &[a, b, c] in triangles {
        for corner in [a, b, c] {
            is_used[corner as usize] = true;
        }
        let root = root_of(&mut parent, a);
        for other in [b, c] {
            let other = root_of(&mut parent, other);
            parent[other as usize] = root;
        }
    }
    (0..vertices)
        .filter(|&at| is_used[at] && parent[at] as usize == at)
        .count()
}

/// The triangles of each part that is joined by edges of two faces, in order of their first triangles.
pub(super) fn joined(triangles: &[[u32; 3]]) -> Vec<Vec<usize>> {
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    for sides in Edges::of(triangles).all().filter(|sides| sides.len() == 2) {
        let roots = [sides[0], sides[1]].map(|side| root_of(&mut parent, side.triangle));
        parent[roots[0].max(roots[1]) as usize] = roots[0].min(roots[1]);
    }
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); triangles.len()];
    for at in 0..triangles.len() {
        parts[root_of(&mut parent, at as u32) as usize].push(at);
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// The representative of a part; paths to it are shortened by half.
fn root_of(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        let above = parent[parent[at as usize] as usize];
        parent[at as usize] = above;
        at = above;
    }
    at
}

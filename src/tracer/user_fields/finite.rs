//! Checks whether a value is finite where waves can be.
//!
//! Bisection between a finite sample and a neighbouring sample that is not finite locates their boundary. The field is
//! rejected if the boundary is in the air, or in the solid within the depth that is checked.

use super::stars::Stars;
use super::{Error, Grid, Probe, SIDE, TraceError, WaveDomain, neighbours};
use crate::scene::halton;
use glam::Vec3;

/// Maximum number of boundaries that are located in one pass.
const BOUNDARIES: usize = 1024;

/// Bisections of a boundary. They locate it within a rounding error of a step of the grid.
const BISECTIONS: usize = 20;

/// Distances from a boundary at which the check looks for air, as shares of the depth.
const DISTANCES: [f32; 4] = [1.0, 0.5, 0.25, 0.0625];

/// Number of directions in which the check looks for air.
const DIRECTIONS: usize = 16;

/// Offset, as a share of the box, of the point whose value replaces a sample that is not finite. The offset is off
/// every line that a text is likely to treat specially, and less than a step of the grid.
const ASIDE: Vec3 = Vec3::new(5.3e-5, -6.2e-5, 5.8e-5);

/// A point whose value is finite, and a point whose value is not finite.
type Boundary = (Vec3, Vec3);

impl Probe<'_> {
    pub(super) fn check_finite_grid(&self, grid: &Grid) -> Result<(), Error> {
        let Grid { points, values } = grid;
        let Some(none) = values.iter().position(|value| !value.is_finite()) else {
            return Ok(());
        };
        let is_none_finite = !values.iter().any(|value| value.is_finite());
        if is_none_finite || self.waves == WaveDomain::BothSides {
            return Err(self.not_finite(points[none], values[none]));
        }
        let differ =
            |&(from, to): &(usize, usize)| values[from].is_finite() != values[to].is_finite();
        let boundaries =
            neighbours()
                .filter(differ)
                .map(|(from, to)| match values[from].is_finite() {
                    true => (points[from], points[to]),
                    false => (points[to], points[from]),
                });
        self.check_boundaries(boundaries.collect())
    }

    pub(super) fn check_finite_stars(&self, stars: &Stars, grid: &Grid) -> Result<(), Error> {
        let all = stars.points.iter().zip(&stars.values);
        let mut none = all.filter(|(_, value)| !value.is_finite()).peekable();
        if let (Some((place, value)), WaveDomain::BothSides) = (none.peek(), self.waves) {
            return Err(self.not_finite(**place, **value));
        }
        // If the nearest sample of the grid is not finite either, the boundaries of the grid have already been checked.
        let boundaries = none.map(|(place, _)| (grid.points[self.nearest(*place)], *place));
        self.check_boundaries(boundaries.collect())
    }

    /// Replaces samples deep in the solid that are not finite by values at points beside them.
    pub(super) fn fill(&self, grid: &mut Grid) -> Result<(), Error> {
        let none: Vec<usize> = (0..grid.values.len())
            .filter(|&index| !grid.values[index].is_finite())
            .collect();
        let half = 0.5 * self.field.size;
        let aside =
            |&index: &usize| (grid.points[index] + ASIDE * self.field.size).clamp(-half, half);
        let aside: Vec<Vec3> = none.iter().map(aside).collect();
        let deep = -self.field.lipschitz * half.min_element();
        for (index, value) in none.iter().zip(self.values(&aside)?) {
            let is_solid = value.is_finite() && value < 0.0;
            grid.values[*index] = if is_solid { value } else { deep };
        }
        Ok(())
    }

    /// The index of the sample of the grid that is nearest to a point.
    fn nearest(&self, place: Vec3) -> usize {
        let share = place / self.field.size + 0.5;
        let along = (share * (SIDE - 1) as f32).round();
        let [x, y, z] = along.to_array().map(|a| (a as usize).min(SIDE - 1));
        (z * SIDE + y) * SIDE + x
    }

    /// Rejects a field that has air at one of these boundaries or next to it.
    fn check_boundaries(&self, mut boundaries: Vec<Boundary>) -> Result<(), Error> {
        let every = boundaries.len().div_ceil(BOUNDARIES).max(1);
        boundaries = boundaries.into_iter().step_by(every).collect();
        if boundaries.is_empty() {
            return Ok(());
        }
        for _ in 0..BISECTIONS {
            let middles: Vec<Vec3> = boundaries.iter().map(|(a, b)| a.midpoint(*b)).collect();
            let values = self.values(&middles)?;
            for (boundary, (middle, value)) in boundaries.iter_mut().zip(middles.iter().zip(values))
            {
                match value.is_finite() {
                    true => boundary.0 = *middle,
                    false => boundary.1 = *middle,
                }
            }
        }
        let points: Vec<Vec3> = boundaries
            .iter()
            .flat_map(|b| self.around_boundary(b))
            .collect();
        let values = self.values(&points)?;
        let around = values.chunks(1 + DISTANCES.len() * DIRECTIONS);
        let is_in_air = |values: &[f32]| values.iter().any(|value| *value > 0.0);
        let Some(worst) = around.into_iter().position(is_in_air) else {
            return Ok(());
        };
        let place = boundaries[worst].1;
        let value = self.values(&[place])?[0];
        Err(self.not_finite(place, value))
    }

    /// The finite end of a boundary, and points around the other end.
    fn around_boundary(&self, (known, none): &Boundary) -> impl Iterator<Item = Vec3> {
        let half = 0.5 * self.field.size;
        let (depth, none) = (self.depth(), *none);
        let directions = (1..=DIRECTIONS).map(|index| 2.0 * halton(index).as_vec3() - 1.0);
        let ways = directions.flat_map(move |way| {
            DISTANCES.map(|share| none + share * depth * way.normalize_or_zero())
        });
        std::iter::once(*known).chain(ways.map(move |point| point.clamp(-half, half)))
    }

    fn not_finite(&self, place: Vec3, value: f32) -> Error {
        let file = self.field.file.display().to_string();
        TraceError::FieldNotFinite { file, place, value }.into()
    }
}

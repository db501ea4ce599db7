//! The start of waves from a source in an edge or a corner of a field.
//!
//! There differences of the field's value, by which [`ExactScene`](crate::reference::ExactScene) mirrors, do not give
//! the normal of any face. But the sheets that meet there are known: each mirrors waves that fly against it.

use super::check::PROBE_IN_TOUCHES;
use super::surfaces::{Surfaces, Vertex};
use glam::DVec3;

/// The edges of fields in which a source lies.
pub(super) struct EdgeStart<'a> {
    surfaces: &'a Surfaces,
    /// The sheets that meet there, as reflections at the source.
    sheets: Vec<Vertex>,
}

impl EdgeStart<'_> {
    pub fn at(source: DVec3, surfaces: &Surfaces) -> EdgeStart<'_> {
        let of = |field| surfaces.sheets_at(field, source);
        let edges = surfaces.fields().map(of).filter(|sheets| sheets.len() > 1);
        EdgeStart {
            sheets: edges.flatten().collect(),
            surfaces,
        }
    }

    /// The reflection at the source of a wave that starts along the unit vector `direction`; `None` if it leaves
    /// freely. If it flies against several sheets, it meets the one over which it flies first.
    pub fn reflection(&self, direction: DVec3) -> Option<&Vertex> {
        let ahead = direction * (PROBE_IN_TOUCHES * self.surfaces.touch);
        let meets = |sheet: &&Vertex| {
            let value = self.surfaces.value(sheet.surface, sheet.point + ahead);
            direction.dot(sheet.normal) < 0.0 && value.is_some_and(|value| value < 0.0)
        };
        let is_over = |sheet: &&Vertex| {
            let over = sheet.point + ahead.reject_from_normalized(sheet.normal);
            self.surfaces.has(sheet.surface, over)
        };
        let mut met = self.sheets.iter().filter(meets);
        met.clone().find(is_over).or_else(|| met.next())
    }
}

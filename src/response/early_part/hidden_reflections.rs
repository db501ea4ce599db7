//! Reflections at plane faces whose paths an object hides. Diffraction bends them around it.

use crate::geometry::SAME_NORMAL;
use crate::response::exact_paths::{Candidates, EarlyPaths, Ends, Found, NoPath, Vertex};

/// The hidden reflections among candidates.
#[derive(Default)]
pub(super) struct HiddenReflections {
    /// Each reflection once.
    pub reflections: Vec<Vertex>,
    /// For each candidate, the index of its reflection; empty if they are not needed.
    of_candidate: Vec<Option<usize>>,
}

impl HiddenReflections {
    /// The reflections at plane faces that an object hides, also where it covers the point of reflection.
    pub fn among(
        candidates: &Candidates,
        found: &Found,
        (paths, ends): (&EarlyPaths, &Ends),
    ) -> HiddenReflections {
        let mut reflections: Vec<Vertex> = Vec::new();
        let mut index_of = |vertex: &Vertex| {
            let is_same = |known: &Vertex| {
                let between = known.point - vertex.point;
                let height = between.dot(vertex.normal).abs();
                // A tilt of the plane by `SAME_NORMAL` raises a point by this share of its distance.
                known.normal.distance(vertex.normal) <= SAME_NORMAL
                    && height <= SAME_NORMAL * between.length().max(1.0)
            };
            let known = reflections.iter().position(is_same);
            known.unwrap_or_else(|| {
                reflections.push(*vertex);
                reflections.len() - 1
            })
        };
        let mut of = |index: usize| match (candidates.get(index)?.vertices, &found.outcomes[index])
        {
            ([vertex], Err(NoPath::Blocked)) if paths.are_flat(&[*vertex]) => {
                Some(index_of(vertex))
            }
            _ => None,
        };
        let of_candidate = (0..candidates.len()).map(&mut of).collect();
        for vertex in paths.reflections_in_solids(ends) {
            index_of(&vertex);
        }
        HiddenReflections {
            reflections,
            of_candidate,
        }
    }

    /// The index of the hidden reflection of a candidate.
    pub fn of(&self, candidate: usize) -> Option<usize> {
        self.of_candidate.get(candidate).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{EarlyPart, Search};
    use super::*;
    use crate::scene::Scene;

    /// Protects the time of responses without diffraction: hidden reflections are sought only if sound bends.
    #[test]
    fn hidden_reflections_are_found_only_for_diffraction() {
        let text = "Scene(surfaces: [Surface(shape: Plane), \
                    Surface(shape: Box(size: (0.2, 6, 400)), position: (0, 3, 0))], \
                    source: Source(position: (-5, 1, 0)), listener: Listener(position: (6, 1.5, 1), radius: 0.2))";
        let scene = Scene::from_ron(text, "wall").expect("a scene");
        let hidden = |diffracts: bool| {
            let pair = scene.pair(0, 0).expect("a pair");
            let search = Search {
                pair,
                paths: &EarlyPaths::new(pair).expect("a valid scene"),
                waves: 1,
                order: 1,
                diffracts,
            };
            let part = EarlyPart::find(&search, &[], Vec::new());
            let surfaces = part
                .hidden_reflections()
                .iter()
                .map(|vertex| vertex.surface);
            surfaces.collect::<Vec<u32>>()
        };
        assert_eq!(hidden(true), [1]);
        assert_eq!(hidden(false), [0; 0]);
    }
}

//! The parts of a straight line that lie in solids.

use super::closed_form::Placed;
use super::exact::ExactScene;
use super::false_position::root;
use glam::DVec3;

/// Minimum step along a line, as a share of its length. Parts of the line that are shorter can be missed: 10 nm on a
/// line of 10 m.
const LEAST_STEP: f64 = 1e-9;

/// Depth below which a point counts as on the surface, in error bounds of positions.
const DEPTH: f64 = 8.0;

/// Maximum number of steps along a line. A line that approaches a plane at 0.2° takes 10,000.
const MOST_STEPS: usize = 20_000;

/// Half the step of the difference quotients of a normal, as a share of the line's length.
const DIFFERENCE: f64 = 1e-7;

/// A part of a line that lies in the solid of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chord {
    /// Number of the surface, from 1.
    pub surface: u32,
    /// Distance in metres from the start of the line to the point at which the line enters the solid.
    pub enters_m: f64,
    /// Distance in metres to the point at which the line leaves the solid.
    pub leaves_m: f64,
    /// Cosines of the angles of the line to the normals of the surface, at both points: 0 to 1.
    pub cosines: [f64; 2],
    /// The groups of the faces of a mesh at both points; `None` for other surfaces.
    pub groups: [Option<usize>; 2],
}

/// Half the step of the difference quotients of a normal, as a share of the scene's extent.
const NORMAL_STEP: f64 = 1e-7;

/// The part of a line that lies in solids in contact.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SolidsAhead {
    /// Parts of the line in solids, by their start. Distances are measured from `start`.
    pub chords: Vec<Chord>,
    /// A point of the line just before it enters the first solid.
    pub start: DVec3,
}

/// The longest way through solids in metres: the thickest solid whose sound reduction index can
/// be stated.
const LONGEST: f64 = 100.0;

/// Distance before a wave's hit at which its line starts, as a share of the scene's extent. Hits are computed in
/// `f32`, with errors of 1e-7 of the extent normal to the surface, and of 1e-6 of it along a line at 6° to the surface.
const BEFORE_HIT: f64 = 1e-6;

/// Width of an air gap up to which solids are in contact, as a share of the scene's extent. Coordinates are `f32`, with
/// errors of 6e-8 of their size.
const CONTACT: f64 = 1e-6;

impl ExactScene {
    /// The solids in contact that a line in this direction passes from a point of a surface. `None` if the line does
    /// not enter a solid at this point, or a solid has no far side.
    pub(crate) fn solids_ahead(&self, point: DVec3, direction: DVec3) -> Option<SolidsAhead> {
        let extent = self.extent_m();
        let start = point - direction * (BEFORE_HIT * extent);
        let line = Line {
            origin: start,
            direction,
            length: LONGEST,
            depth: DEPTH * self.error_bound,
        };
        let gap = CONTACT * extent;
        let mut chords: Vec<Chord> = Vec::new();
        let mut reach = 2.0 * BEFORE_HIT * extent;
        loop {
            let known = chords.len();
            chords.clear();
            for index in self.near(&line, reach) {
                line.add_chords_within(
                    &self.surfaces[index],
                    index as u32 + 1,
                    reach,
                    &mut chords,
                )?;
            }
            let ends = chords.iter().map(|chord| chord.leaves_m);
            reach = ends.fold(0.0, f64::max) + gap;
            if chords.len() == known {
                break;
            }
        }
        sort(&mut chords);
        (!chords.is_empty()).then_some(SolidsAhead { chords, start })
    }

    /// The unit normal of a surface (numbered from 1) at a point, from the solid into the air; `None` where the
    /// distance has no gradient.
    pub(crate) fn outward(&self, surface: u32, point: DVec3) -> Option<DVec3> {
        let placed = self.surfaces.get((surface as usize).checked_sub(1)?)?;
        gradient(placed, point, NORMAL_STEP * self.extent_m()).try_normalize()
    }

    /// The indices of the surfaces that a line may meet within `reach` metres.
    fn near(&self, line: &Line, reach: f64) -> Vec<usize> {
        let mut near = Vec::new();
        for hierarchy in &self.hierarchies {
            hierarchy.along(line.origin, line.direction, reach, |index, until| {
                near.push(index);
                until
            });
        }
        near
    }

    /// The parts of the line from `a` to `b` that lie in solids, by their start. Both points lie in the air.
    ///
    /// `None` if a line that grazes a surface takes too many steps, or an end lies in a solid.
    pub(crate) fn chords(&self, a: DVec3, b: DVec3) -> Option<Vec<Chord>> {
        let (direction, length) = (b - a).normalize_and_length();
        let line = Line {
            origin: a,
            direction,
            length,
            depth: DEPTH * self.error_bound,
        };
        let mut chords = Vec::new();
        for index in self.near(&line, length) {
            let (placed, surface) = (&self.surfaces[index], index as u32 + 1);
            line.add_chords_within(placed, surface, length, &mut chords)?;
        }
        sort(&mut chords);
        Some(chords)
    }
}

/// The gradient of the distance to a surface, times twice the step in metres of the difference quotients.
fn gradient(placed: &Placed, point: DVec3, step: f64) -> DVec3 {
    let along =
        |axis: DVec3| placed.distance(point + axis * step) - placed.distance(point - axis * step);
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// Sorts chords by their start.
fn sort(chords: &mut [Chord]) {
    chords.sort_by(|a, b| {
        let by_start = a.enters_m.total_cmp(&b.enters_m);
        by_start.then(a.surface.cmp(&b.surface))
    });
}

/// A line between two points in the air.
struct Line {
    origin: DVec3,
    direction: DVec3,
    length: f64,
    /// Depth in metres below which a point counts as on the surface.
    depth: f64,
}

impl Line {
    /// Adds the parts of the line in the solid of one surface that start within `reach` metres. `None` if the line ends
    /// in the solid, or takes too many steps.
    fn add_chords_within(
        &self,
        placed: &Placed,
        surface: u32,
        reach: f64,
        chords: &mut Vec<Chord>,
    ) -> Option<()> {
        let mut enters: Option<f64> = None;
        let mut from = 0.0;
        loop {
            let end = if enters.is_some() { self.length } else { reach };
            let Some(at) = self.next_change(placed, from, end, enters.is_some())? else {
                break;
            };
            enters = match enters {
                None => Some(at),
                Some(enters_m) => {
                    chords.push(Chord {
                        surface,
                        enters_m,
                        leaves_m: at,
                        cosines: [enters_m, at].map(|t| self.cosine(placed, t)),
                        groups: [
                            self.group(placed, enters_m, self.direction),
                            self.group(placed, at, -self.direction),
                        ],
                    });
                    None
                }
            };
            from = at;
        }
        enters.is_none().then_some(())
    }

    /// The first point after `from`, and before `end`, at which the line enters the solid, or leaves it if `is_inside`.
    /// The outer `None` stands for too many steps.
    ///
    /// No point is nearer to the surface than the value of its distance, so this value is a safe step on both sides. At
    /// meshes a step reaches the next face. Steps double while the line is in contact with the surface, so that a line
    /// along a plane ends.
    fn next_change(
        &self,
        placed: &Placed,
        from: f64,
        end: f64,
        is_inside: bool,
    ) -> Option<Option<f64>> {
        let least = LEAST_STEP * self.length;
        let mut floor = least;
        let mut t = from;
        for _ in 0..MOST_STEPS {
            if t >= end {
                return Some(None);
            }
            let here = self.origin + self.direction * t;
            let line = (here, self.direction);
            let free = placed.length_on_side(line, is_inside, self.depth / DEPTH);
            floor = if free < least { 2.0 * floor } else { least };
            let next = (t + free.max(floor)).min(end);
            if self.is_inside(placed, next) != is_inside {
                return Some(Some(self.change(placed, t, next)));
            }
            t = next;
        }
        None
    }

    /// The point between `low` and `high` at which the line passes the surface.
    fn change(&self, placed: &Placed, low: f64, high: f64) -> f64 {
        let height = |t: f64| self.distance(placed, t) + self.depth;
        root(
            height,
            [low, high].map(|t| (t, height(t))),
            self.depth / DEPTH,
        )
    }

    fn is_inside(&self, placed: &Placed, t: f64) -> bool {
        self.distance(placed, t) < -self.depth
    }

    fn distance(&self, placed: &Placed, t: f64) -> f64 {
        placed.distance(self.origin + self.direction * t)
    }

    /// The group of the face of a mesh that a flight in this direction meets at a point of the line.
    fn group(&self, placed: &Placed, t: f64, flight: DVec3) -> Option<usize> {
        let step = DIFFERENCE * self.length;
        let before = self.origin + self.direction * t - flight * step;
        placed.group_met(before, flight, (self.depth, 2.0 * step))
    }

    /// The cosine of the angle between the line and the normal at a point of the surface; 1 without a normal.
    fn cosine(&self, placed: &Placed, t: f64) -> f64 {
        let point = self.origin + self.direction * t;
        let normal = gradient(placed, point, DIFFERENCE * self.length).try_normalize();
        normal.map_or(1.0, |normal| normal.dot(self.direction).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Plane, Sphere, Torus};
    use crate::{Listener, Scene, Source, Surface};
    use glam::Vec3;

    fn chords(surfaces: Vec<Surface>, a: DVec3, b: DVec3) -> Vec<Chord> {
        let (source, listener) = (Source::at(a.as_vec3()), Listener::at(b.as_vec3(), 0.1));
        let scene = Scene::new("chords", surfaces, source, listener);
        ExactScene::new(&scene).unwrap().chords(a, b).unwrap()
    }

    /// Protects the ends and angles of the parts in a solid, for shapes in closed form and for marched fields.
    #[test]
    fn chords_end_at_the_surfaces() {
        let ball = Surface::new(Sphere { radius: 1.0 });
        let ring = Surface::new(Torus {
            ring: 3.0,
            tube: 0.5,
        });
        let found = chords(
            vec![ring, ball],
            DVec3::new(-9.0, 0.0, 0.0),
            DVec3::new(9.0, 0.0, 0.0),
        );
        let expected = [(1, 5.5, 6.5), (2, 8.0, 10.0), (1, 11.5, 12.5)];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (chord, (surface, enters_m, leaves_m)) in found.iter().zip(expected) {
            assert_eq!(chord.surface, surface);
            assert!((chord.enters_m - enters_m).abs() < 1e-9, "{chord:?}");
            assert!((chord.leaves_m - leaves_m).abs() < 1e-9, "{chord:?}");
            assert!(chord.cosines.iter().all(|cosine| *cosine > 1.0 - 1e-6));
        }
        assert!((found[1].leaves_m - found[1].enters_m - 2.0).abs() < 1e-9);
    }

    /// Protects oblique lines: cosine and length of a chord give the thickness of a slab.
    #[test]
    fn cosine_times_length_is_the_thickness_of_a_slab() {
        let slab = Surface::new(Cuboid {
            size: Vec3::new(0.25, 90.0, 90.0),
        });
        for degrees in [0.0_f64, 30.0, 60.0, 80.0, 86.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let b = DVec3::new(2.0, 2.0 * sin / cos, 0.0);
            let found = chords(vec![slab.clone()], -b, b);
            let thickness = (found[0].leaves_m - found[0].enters_m) * found[0].cosines[1];
            assert!((thickness - 0.25).abs() < 1e-8, "{degrees}: {found:?}");
        }
    }

    /// Protects lines along a surface: they end, and do not count as in the solid.
    #[test]
    fn a_line_along_a_plane_is_in_the_air() {
        let ground = vec![Surface::new(Plane)];
        let found = chords(
            ground,
            DVec3::new(-9.0, 0.0, 1.0),
            DVec3::new(9.0, 0.0, 2.0),
        );
        assert_eq!(found, []);
    }
}

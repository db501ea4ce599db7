//! Diffracted paths with a reflection: the space of a scene, continued behind a plane face by its mirror image.
//!
//! # Theory
//! A reflection at a plane is a straight way to the image of the source. A way that bends and is reflected is therefore a
//! bent way in the space that consists of the scene in front of the plane and its mirror image behind it, joined at the
//! face (Allen and Berkley 1979 for the images; Pierce 1974 for a barrier on the ground). Outside the face the plane is
//! closed to a way that bends; what the ends of the face take from a free reflection follows from `face.rs`. In this space
//! strings and edges are found as in any other.
//!
//! From the image of the source to the listener a string crosses the plane once: the sound is reflected before the edge
//! or after it. From the source itself to the listener it crosses the plane twice, or not at all.

use super::lit::{Change, Lit};
use super::space::{Obstacle, Space};
use super::{DiffractedPath, Ends, ways_around};
use crate::bands::Bands;
use crate::geometry::ExactScene;
use glam::DVec3;

/// Distance up to which a point counts as on a face, in units of the scene's rounding: fields are marched to some tens
/// of units.
const TOUCH_IN_ROUNDINGS: f64 = 1e4;

/// Distance in metres up to which a point counts as on a face.
pub(super) fn on_face_m(exact: &ExactScene) -> f64 {
    TOUCH_IN_ROUNDINGS * exact.rounding()
}

/// Length behind a point met at which the solid is tested, in errors of the places of surfaces.
const PAST_IN_ERRORS: f64 = 4.0;

/// A plane face that reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Mirror {
    /// Number of its surface, from 1.
    pub surface: u32,
    /// A point on the plane, in world metres.
    pub point: DVec3,
    /// Unit vector from the solid into the air.
    pub normal: DVec3,
}

/// The space in front of a plane face, and its mirror image behind it.
pub(super) struct MirroredSpace<'a> {
    pub exact: &'a ExactScene,
    pub mirror: Mirror,
    /// Whether the plane is closed beside the face; otherwise it reflects there too.
    pub has_ends: bool,
}

impl Mirror {
    /// Height of a point in front of the plane in metres.
    fn height(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }

    /// The image of a point.
    pub fn image(&self, point: DVec3) -> DVec3 {
        point - self.normal * (2.0 * self.height(point))
    }

    fn is_behind(&self, point: DVec3) -> bool {
        self.height(point) < 0.0
    }

    /// The point itself in front of the plane, its image behind it.
    fn in_front(&self, point: DVec3) -> DVec3 {
        match self.is_behind(point) {
            true => self.image(point),
            false => point,
        }
    }

    /// The path in the scene of a path from a source, or from its image, to a listener.
    fn folded(&self, path: DiffractedPath, [from, to]: [DVec3; 2]) -> DiffractedPath {
        let mut folded = DiffractedPath {
            points: Vec::new(),
            surfaces: Vec::new(),
            reflections: Vec::new(),
            ..path
        };
        let mut before = from;
        let ends = path.points.iter().zip(&path.surfaces);
        let ends = ends.map(|(point, surface)| (*point, Some(*surface)));
        for (point, surface) in ends.chain([(to, None)]) {
            if self.is_behind(before) != self.is_behind(point) {
                let [height, next] = [before, point].map(|end| self.height(end).abs());
                folded.reflections.push(folded.points.len());
                folded
                    .points
                    .push(before.lerp(point, height / (height + next)));
                folded.surfaces.push(self.surface);
            }
            if let Some(surface) = surface {
                folded.points.push(self.in_front(point));
                folded.surfaces.push(surface);
            }
            before = point;
        }
        if self.is_behind(from) {
            folded.departure = path.departure.reflect(self.normal);
        }
        folded
    }
}

impl Space for MirroredSpace<'_> {
    fn first(&self, origin: DVec3, direction: DVec3, until: f64) -> Option<Obstacle> {
        let MirroredSpace { exact, mirror, .. } = self;
        let (start, along) = match mirror.is_behind(origin) {
            true => (mirror.image(origin), direction.reflect(mirror.normal)),
            false => (origin, direction),
        };
        let (height, descent) = (mirror.height(start), -along.dot(mirror.normal));
        let crossing = height / descent;
        if descent <= 0.0 || crossing >= until {
            return exact.first(start, along, until);
        }
        let error_m = on_face_m(exact);
        // Faces of other surfaces in the plane do not count, also if rounding moves them to its front. A surface that stands
        // on the plane has a solid behind the point met.
        let placing_m = exact.placing_error_m();
        let in_plane = placing_m / descent;
        let is_in_plane = |met: &Obstacle| {
            let is_near = (met.metres - crossing).abs() <= in_plane;
            let past = origin + direction * (met.metres + PAST_IN_ERRORS * placing_m);
            met.surface != mirror.surface && is_near && self.distance(past) > 0.0
        };
        let before = exact.first(start, along, crossing - error_m / descent);
        if let Some(before) = before.filter(|met| !is_in_plane(met)) {
            return Some(before);
        }
        let point = start + along * crossing;
        if self.has_ends && !exact.is_on(mirror.surface, point, error_m) {
            // The plane has no face there.
            return Some(Obstacle {
                metres: crossing,
                surface: mirror.surface,
            });
        }
        let back = along.reflect(mirror.normal);
        let next = |from: DVec3, passed: f64| {
            let next = exact.first(from, back, until - crossing - passed)?;
            Some(Obstacle {
                metres: crossing + passed + next.metres,
                surface: next.surface,
            })
        };
        match next(point + mirror.normal * error_m, 0.0) {
            Some(met) if is_in_plane(&met) => next(point + back * in_plane, in_plane),
            met => met,
        }
    }

    fn distance(&self, point: DVec3) -> f64 {
        self.exact
            .distance_in_front(self.mirror.in_front(point), self.face())
    }

    fn nearest(&self, point: DVec3) -> u32 {
        self.exact
            .nearest_in_front(self.mirror.in_front(point), self.face())
    }

    fn in_scene(&self, point: DVec3) -> DVec3 {
        self.mirror.in_front(point)
    }
}

impl MirroredSpace<'_> {
    /// The number of the surface that reflects, and a point of its face with the unit normal there.
    fn face(&self) -> (u32, (DVec3, DVec3)) {
        (self.mirror.surface, (self.mirror.point, self.mirror.normal))
    }

    /// The diffracted paths with one reflection, or with two if the source is hidden from the listener; none if the
    /// reflection at the plane alone reaches the listener.
    pub fn around(
        &self,
        (source, listener): Ends,
        speed: f64,
        coefficients: impl Fn(u32, DVec3) -> Bands,
    ) -> Vec<DiffractedPath> {
        let image = self.mirror.image(source);
        let Some(once) = ways_around(self, (image, listener)) else {
            return Vec::new();
        };
        let paths = once.paths(self, speed, &coefficients);
        let mut all: Vec<DiffractedPath> = paths
            .into_iter()
            .map(|path| self.mirror.folded(path, [image, listener]))
            .collect();
        if let Some(mut twice) = ways_around(self, (source, listener)) {
            // The other ways have no reflection.
            twice.retain(|point| self.mirror.is_behind(point));
            let paths = twice.paths(self, speed, &coefficients);
            all.extend(
                paths
                    .into_iter()
                    .map(|path| self.mirror.folded(path, [source, listener])),
            );
        }
        all
    }

    /// The change of the reflection at the plane by the edges beside its way.
    pub fn beside(
        &self,
        (source, listener): Ends,
        speed: f64,
        coefficients: impl Fn(u32, DVec3) -> Bands,
    ) -> Change {
        let lit = Lit::between(self, (self.mirror.image(source), listener));
        lit.map_or(Change::NONE, |lit| lit.change(self, speed, coefficients))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{around, around_mirrored, beside, beside_mirrored, tests};
    use super::*;
    use crate::bands::BAND_COUNT;

    const SPEED: f64 = 343.0;
    const RIGID: fn(u32, DVec3) -> Bands = |_, _| [1.0; BAND_COUNT];
    const SOURCE: DVec3 = DVec3::new(-3.0, 0.4, 0.3);
    const LISTENER: DVec3 = DVec3::new(2.5, 0.9, -0.4);

    fn exact(surfaces: &str) -> ExactScene {
        tests::exact(surfaces, (SOURCE, LISTENER))
    }

    fn ground(surface: u32) -> Mirror {
        Mirror {
            surface,
            point: DVec3::ZERO,
            normal: DVec3::Y,
        }
    }

    /// Each path's length, direction of arrival and energies.
    fn sorted(paths: &[DiffractedPath]) -> Vec<(f64, DVec3, Bands)> {
        let heard = |path: &DiffractedPath| (path.length_m, path.arrival_direction, path.energy);
        let mut all: Vec<_> = paths.iter().map(heard).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    fn assert_same(found: &[DiffractedPath], expected: &[DiffractedPath]) {
        assert!(!expected.is_empty());
        assert_eq!(found.len(), expected.len(), "{found:?}\n{expected:?}");
        for (found, expected) in sorted(found).iter().zip(sorted(expected)) {
            assert!(
                (found.0 - expected.0).abs() < 1e-6,
                "{} m, {} m",
                found.0,
                expected.0
            );
            assert!(found.1.distance(expected.1) < 1e-6);
            for band in 0..BAND_COUNT {
                let apart_db = 10.0 * (found.2[band] / expected.2[band]).log10();
                assert!(apart_db.abs() < 0.02, "band {band}: {apart_db} dB");
            }
        }
    }

    const WALL: &str = "Surface(shape: Box(size: (0.2, 2, 4)), position: (0, 1, 0))";
    const DOUBLE_WALL: &str = "Surface(shape: Box(size: (0.2, 4, 4)))";

    /// Protects reflections behind a wall on the ground: they bend as the image of the source does behind a wall of twice
    /// the height in the open. The ground is a plane, a half-space, a solid box, the wall of a room, or a face of a mesh.
    #[test]
    fn reflections_at_the_ground_bend_as_around_a_wall_of_twice_the_height() {
        let double = exact(DOUBLE_WALL);
        let expected = around(&double, (ground(1).image(SOURCE), LISTENER), SPEED, RIGID);
        for floor in [
            "Surface(shape: Plane)",
            "Surface(shape: HalfSpace(normal: (0, 1, 0), offset: 0))",
            "Surface(shape: Box(size: (100, 2, 100)), position: (0, -1, 0))",
            "Surface(shape: Room(size: (100, 60, 100)), position: (0, 30, 0))",
            "Surface(shape: Rooms(of: [(name: \"r\", from: (-50, 0, -50), to: (50, 60, 50))]))",
        ] {
            let scene = exact(&format!("{floor}, {WALL}"));
            let paths = around_mirrored(&scene, ground(1), (SOURCE, LISTENER), SPEED, RIGID);
            let once: Vec<_> = paths
                .into_iter()
                .filter(|path| path.reflections.len() == 1)
                .collect();
            assert_same(&once, &expected);
        }
    }

    /// Protects obstacles whose foot is near the point of a flat reflection, in a wide scene: a line that meets the wall
    /// within the rounding of the plane does not pass it.
    #[test]
    fn a_wall_near_a_flat_reflection_hides_it() {
        let ends = (DVec3::new(-500.0, 0.5, 0.0), DVec3::new(500.0, 1.5, 0.0));
        let wall = "Surface(shape: Box(size: (0.2, 3, 4)), position: (-249.95, 1.5, 0))";
        let scene = tests::exact(&format!("Surface(shape: Plane), {wall}"), ends);
        let paths = around_mirrored(&scene, ground(1), ends, SPEED, RIGID);
        assert!(paths.iter().any(|path| path.reflections.len() == 1));
    }

    /// Protects paths with a reflection on each side of the wall: they are the ways under the wall of twice the height.
    #[test]
    fn paths_are_reflected_on_both_sides_of_a_wall() {
        let double = exact(DOUBLE_WALL);
        let around = around(&double, (SOURCE, LISTENER), SPEED, RIGID);
        let under: Vec<_> = around
            .into_iter()
            .filter(|path| path.points[0].y < -1.0)
            .collect();
        let scene = exact(&format!("Surface(shape: Plane), {WALL}"));
        let paths = around_mirrored(&scene, ground(1), (SOURCE, LISTENER), SPEED, RIGID);
        let twice: Vec<_> = paths
            .into_iter()
            .filter(|path| path.reflections.len() == 2)
            .collect();
        assert_eq!((twice.len(), under.len()), (1, 1));
        assert!((twice[0].length_m - under[0].length_m).abs() < 1e-6);
        assert_eq!(
            twice[0].reflections.len() + under[0].points.len(),
            twice[0].points.len()
        );
        assert!(twice[0].points.iter().all(|point| point.y > -1e-9));
    }

    /// Protects the points of a path: it is as long as the line through them, and its ends have its directions.
    #[test]
    fn folded_paths_lead_through_the_scene() {
        let scene = exact(&format!("Surface(shape: Plane), {WALL}"));
        for path in around_mirrored(&scene, ground(1), (SOURCE, LISTENER), SPEED, RIGID) {
            let points = [&[SOURCE], &path.points[..], &[LISTENER]].concat();
            let length: f64 = points
                .windows(2)
                .map(|ends| ends[0].distance(ends[1]))
                .sum();
            assert!(
                (length - path.length_m).abs() < 1e-2,
                "{length} m, {} m",
                path.length_m
            );
            let departure = (points[1] - points[0]).normalize();
            assert!(departure.distance(path.departure) < 1e-2, "{path:?}");
            let last = points.len() - 1;
            let arrival = (points[last] - points[last - 1]).normalize();
            assert!(arrival.distance(path.arrival_direction) < 1e-2, "{path:?}");
            for reflection in &path.reflections {
                assert!(path.points[*reflection].y.abs() < 1e-9);
                assert_eq!(path.surfaces[*reflection], 1);
            }
        }
    }

    /// Protects reciprocity: paths with reflections before and after the bends have the same energies if source and
    /// listener change places, and lead through the same points in the opposite order.
    #[test]
    fn source_and_listener_may_change_places() {
        for obstacles in [
            WALL,
            "Surface(shape: Box(size: (0.7, 1.3, 2)), position: (0.4, 0.65, 0.3), rotation: (0, 25, 0))",
            "Surface(shape: Sphere(radius: 1.2), position: (-0.3, 0.9, 0.2))",
            "Surface(shape: Box(size: (0.2, 2, 4)), position: (-1, 1, 0)), \
             Surface(shape: Box(size: (0.3, 1.5, 6)), position: (1, 0.75, 0))",
        ] {
            let scene = exact(&format!("Surface(shape: Plane), {obstacles}"));
            for (source, listener) in [
                (SOURCE, LISTENER),
                (DVec3::new(-2.5, 1.1, -0.7), DVec3::new(3.0, 0.2, 0.5)),
                (DVec3::new(-4.0, 0.1, 0.1), DVec3::new(2.2, 0.6, 0.9)),
            ] {
                let [there, back] = [(source, listener), (listener, source)]
                    .map(|ends| around_mirrored(&scene, ground(1), ends, SPEED, RIGID));
                assert!(!there.is_empty(), "{obstacles}");
                assert_eq!(there.len(), back.len(), "{obstacles}");
                for (there, back) in there.iter().zip(&back) {
                    for band in 0..BAND_COUNT {
                        let apart_db = 10.0 * (there.energy[band] / back.energy[band]).log10();
                        assert!(
                            apart_db.abs() < 0.1,
                            "{obstacles}, band {band}: {apart_db} dB"
                        );
                    }
                    let mut reversed = back.clone();
                    reversed.points.reverse();
                    assert_eq!(reversed.points, there.points);
                    for index in &there.reflections {
                        let same = there.points.len() - 1 - index;
                        assert!(back.reflections.contains(&same), "{there:?}, {back:?}");
                    }
                    assert_eq!(back.departure, -there.arrival_direction);
                }
            }
        }
    }

    /// Protects reciprocity beside a free reflection.
    #[test]
    fn ends_of_a_free_reflection_may_change_places() {
        let low = "Surface(shape: Box(size: (0.2, 0.2, 40)), position: (0, 0.1, 0))";
        let scene = exact(&format!("Surface(shape: Plane), {low}"));
        let (source, listener) = (DVec3::new(-3.0, 0.8, 0.0), DVec3::new(1.0, 1.8, 0.4));
        let [there, back] = [(source, listener), (listener, source)]
            .map(|ends| beside_mirrored(&scene, ground(1), ends, SPEED, RIGID).energy);
        for (there, back) in there.into_iter().zip(back) {
            let apart_db = 10.0 * (there / back).log10();
            assert!(apart_db.abs() < 0.1, "{apart_db} dB");
        }
    }

    /// Protects reflections that reach the listener: they do not bend, and a low wall beside their way changes them as
    /// one of twice the height does in the open.
    #[test]
    fn edges_beside_a_reflection_change_it() {
        let low = "Surface(shape: Box(size: (0.2, 0.2, 40)), position: (0, 0.1, 0))";
        let scene = exact(&format!("Surface(shape: Plane), {low}"));
        let ends = (DVec3::new(-3.0, 0.8, 0.0), DVec3::new(1.0, 1.8, 0.4));
        let mirror = ground(1);
        assert!(around_mirrored(&scene, mirror, ends, SPEED, RIGID).is_empty());
        let open = exact("Surface(shape: Box(size: (0.2, 0.4, 40)))");
        let expected = beside(&open, (mirror.image(ends.0), ends.1), SPEED, RIGID).energy;
        let found = beside_mirrored(&scene, mirror, ends, SPEED, RIGID).energy;
        assert!(
            expected.iter().any(|share| (share - 1.0).abs() > 0.05),
            "{expected:?}"
        );
        for band in 0..BAND_COUNT {
            let apart_db = 10.0 * (found[band] / expected[band]).log10();
            assert!(apart_db.abs() < 0.02, "band {band}: {apart_db} dB");
        }
    }

    /// Protects the ends of faces: nothing leads through the plane beside its face.
    #[test]
    fn nothing_is_reflected_beside_a_face() {
        let scene = exact("Surface(shape: Box(size: (2, 1, 2)), position: (0, -0.5, 0))");
        let space = MirroredSpace {
            exact: &scene,
            mirror: ground(1),
            has_ends: true,
        };
        assert!(space.is_free(DVec3::new(-0.5, -1.0, 0.2), DVec3::new(0.8, 1.0, 0.0)));
        assert!(!space.is_free(DVec3::new(1.5, -1.0, 0.2), DVec3::new(1.8, 1.0, 0.0)));
        assert!(space.is_free(DVec3::new(1.5, 0.5, 0.2), DVec3::new(1.8, 1.0, 0.0)));
    }
}

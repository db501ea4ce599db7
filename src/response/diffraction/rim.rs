//! Edges beside a free way: they diffract although they hide nothing.
//!
//! In each half-plane the tent that is free is raised further, until an obstacle blocks it. The edge that it then touches
//! adds its diffracted pressure, which has the opposite sign to that behind an edge: together with the direct sound the
//! pressure is continuous at the boundary of the shadow. A plane has no diffracted pressure, and drops out.

use super::bend::Bend;
use super::edge::{Edge, MOST_SEARCHES, ON_SURFACE, TURN, face_distance_m};
use super::narrow::factor_of;
use super::ring::{self, Basin, LEAST_DETOUR_M, Samples, all_samples};
use super::space::Space;
use super::string::{FINE, HALF_PLANES, HalfPlanes, STEP, TautString};
use super::tent::bisect;
use super::wedge::{Wedge, behind_screen};
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Detour in metres from which edges beside the way are left out: at 63 Hz they change the level by 1 dB at most.
pub(super) const MOST_DETOUR_M: f64 = 4.0;

/// Difference in radians between the angle of the air and half a turn up to which an edge is a plane.
const PLANE: f64 = 0.01;

/// Distance from an edge at which the normals of its faces are measured, as a share of the leg.
const NEAR_EDGE: f64 = 0.01;

/// An edge beside the way.
pub(super) struct Rim {
    source: DVec3,
    listener: DVec3,
    edge: Edge,
    /// Unit vector from the edge to the straight way.
    inwards: DVec3,
    pub length_m: f64,
    /// The way that would just touch the edge.
    grazing: Option<Bend>,
    own: Vec<Samples>,
    lines: Vec<Samples>,
    /// Whether the listener hears the reflections at the first and at the second face, which are paths of their own.
    are_heard: [bool; 2],
    /// The half-planes on the edge's side of the straight way in which it is the first obstacle.
    pub half_planes: [bool; HALF_PLANES],
}

/// The pressures that an edge adds, relative to the direct sound.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Added {
    /// To the direct sound.
    pub direct: Complex64,
    /// To reflections at its faces in the direction of the direct sound, which end together with it.
    ending: Complex64,
    /// To reflections at its faces that the listener does not hear there.
    pub reflected: Complex64,
    /// The pressure behind the edge at the boundary of its shadow, relative to that behind a thin screen.
    pub behind: Complex64,
}

impl Rim {
    /// The edges beside the straight way if `strings` is empty, otherwise those beyond the strings.
    pub fn all(
        space: &impl Space,
        planes: &HalfPlanes,
        strings: &[Option<TautString>],
    ) -> Vec<Rim> {
        let above = |index: usize| strings.get(index).map(Option::as_ref);
        let detours = ring::detours(|azimuth| {
            let touch = match above((azimuth / STEP).round() as usize) {
                Some(None) => None,
                known => touched(space, planes, (azimuth, known.flatten()), &SIDES),
            };
            touch.map(|(touch, _)| planes.detour_m(touch))
        });
        let mut rims: Vec<Rim> = Vec::new();
        for basin in Basin::all(&detours) {
            let above = above(basin.shortest).flatten();
            let Some(mut rim) = Rim::of(space, planes, basin.shortest as f64 * STEP, above) else {
                continue;
            };
            let samples = basin.samples(&detours);
            let side = planes.azimuth_of(rim.point());
            let mut half_planes = [false; HALF_PLANES];
            for index in basin.half_planes() {
                half_planes[index] = (index as f64 * STEP - side).cos() > 0.0;
            }
            // Beyond a string no edge is near the boundary of the direct sound.
            rim.grazing = match strings.is_empty() {
                true => rim.touching(space),
                false => None,
            };
            rim.are_heard = rim.are_reflections_heard(space);
            match rims.iter_mut().find(|other| other.is_same(&rim)) {
                Some(other) => other.add(samples, half_planes),
                None => {
                    rim.add(samples, half_planes);
                    rims.push(rim);
                }
            }
        }
        rims
    }

    fn of(
        space: &impl Space,
        planes: &HalfPlanes,
        mut azimuth: f64,
        above: Option<&TautString>,
    ) -> Option<Rim> {
        let mut last = None;
        for _ in 0..MOST_SEARCHES {
            let (touch, side) = touched(space, planes, (azimuth, above), &SIDES)?;
            let beside = |turn: f64| touched(space, planes, (azimuth + turn, above), &[side]);
            let (other, _) = [TURN, -TURN].into_iter().find_map(beside)?;
            let edge = Edge {
                point: touch,
                along: (other - touch).try_normalize()?,
            };
            let (source, listener) = planes.ends();
            let point = edge.shortest(source, listener);
            let rim = |point: DVec3| Rim::at(planes, Edge { point, ..edge }, azimuth);
            if planes.detour_m(touch) < LEAST_DETOUR_M {
                return Some(rim(touch));
            }
            let moved = rim(point);
            if moved.is_on_solid(space) {
                return moved.is_edge(space).then_some(moved);
            }
            last.get_or_insert_with(|| rim(touch));
            azimuth = planes.azimuth_of(point);
        }
        last.filter(|rim: &Rim| rim.is_edge(space))
    }

    fn at(planes: &HalfPlanes, edge: Edge, azimuth: f64) -> Rim {
        let (source, listener) = planes.ends();
        let line = |azimuth: f64| planes.on_line(&edge, azimuth);
        let lines = ring::detours(|azimuth| line(azimuth).map(|point| planes.detour_m(point)));
        Rim {
            source,
            listener,
            inwards: -planes.upwards(azimuth),
            length_m: source.distance(edge.point) + edge.point.distance(listener),
            edge,
            own: Vec::new(),
            grazing: None,
            lines: all_samples(&lines),
            are_heard: [false; 2],
            half_planes: [false; HALF_PLANES],
        }
    }

    /// Adds half-planes in which tents touch the edge.
    fn add(&mut self, samples: Samples, half_planes: [bool; HALF_PLANES]) {
        self.own.push(samples);
        for (known, added) in self.half_planes.iter_mut().zip(half_planes) {
            *known |= added;
        }
    }

    fn touching(&self, space: &impl Space) -> Option<Bend> {
        let after_m = self.edge.point.distance(self.listener);
        Bend::grazing(space, self.source, self.edge, after_m, self.inwards)
    }

    fn is_same(&self, other: &Rim) -> bool {
        self.edge.point.distance(other.edge.point) < ON_SURFACE.sqrt() * self.length_m
    }

    fn is_on_solid(&self, space: &impl Space) -> bool {
        let error = ON_SURFACE * self.length_m;
        let lifted = self.edge.point + self.inwards * error;
        space.distance(self.edge.point).abs() <= error
            && space.is_free(self.source, lifted)
            && space.is_free(self.listener, lifted)
    }

    /// Whether the surface is not plane there.
    fn is_edge(&self, space: &impl Space) -> bool {
        // The zone of the wave number 0 is endless: the legs limit the distance.
        let radius = self.face_m(0.0);
        let is_edge = |share: f64| {
            let wedge = self.wedge(space, share * radius);
            wedge.is_some_and(|wedge| wedge.air_angle > PI + PLANE)
        };
        is_edge(1.0) || is_edge(0.1)
    }

    /// Whether the points of reflection at the planes of both faces lie on the faces, near the edge or far from it.
    fn are_reflections_heard(&self, space: &impl Space) -> [bool; 2] {
        let ends = [self.source, self.listener];
        [0, 1].map(|face| {
            let beside = [ends[face], ends[1 - face]];
            let radius = NEAR_EDGE * self.edge.point.distance(beside[0]);
            let Some((_, normal)) = self.edge.face_beside(space, beside, radius) else {
                return false;
            };
            let heights = ends.map(|end| (end - self.edge.point).dot(normal));
            let share = heights[0] / (heights[0] + heights[1]);
            let point = self.source.lerp(self.listener, share)
                - normal * (2.0 * heights[0] * heights[1] / (heights[0] + heights[1]));
            let error = ON_SURFACE * self.length_m;
            heights.iter().all(|height| *height > 0.0) && space.distance(point).abs() <= error
        })
    }

    /// Distance in metres from the edge at which sound of the wave number `k` perceives its faces.
    fn face_m(&self, k: f64) -> f64 {
        let legs = [self.source, self.listener].map(|end| end.distance(self.edge.point));
        face_distance_m(k, legs, legs[0].min(legs[1]))
    }

    fn wedge(&self, space: &impl Space, radius: f64) -> Option<Wedge> {
        let ends = [self.source, self.listener];
        self.edge.wedge(space, ends, self.inwards, radius)
    }

    /// The pressures that the edge adds for the wave number `k`. `face` is the pressure reflection coefficient of its
    /// faces, and `wide` is how much its obstacle differs from a thin screen, from 0 to 1.
    pub fn added(&self, space: &impl Space, k: f64, (face, wide): (f64, f64)) -> Option<Added> {
        let detour_m = self.detour_m();
        let straight = behind_screen(k * detour_m) * Complex64::cis(k * detour_m);
        let ends = 1.0 + (ring::sum(&self.own, k) - ring::sum(&self.lines, k)) / straight;
        let strength = ends * self.nearness();
        let round = match &self.grazing {
            Some(grazing) => grazing.most_round(space, k),
            None => 0.0,
        };
        let mut added = match self.wedge(space, self.face_m(k)) {
            Some(wedge) => self.added_by_edge(&wedge, k, face),
            // A body that is smaller than the zone has no faces there.
            None if round == 1.0 => Added::default(),
            None => return None,
        };
        let [mut ratio, mut behind] = [Complex64::ONE; 2];
        if let Some(grazing) = &self.grazing {
            // Twice the pressures at the boundary of the shadow: an edge of a thin screen halves it.
            behind = factor_of(2.0 * grazing.pressure(space, k, &[face])?, wide);
            let edge = 2.0 * grazing.edge_pressure(space, k, face);
            ratio = behind / (edge * (1.0 - round) + round);
            added.direct = added.direct * (1.0 - round) - straight * round;
            added.ending *= 1.0 - round;
            added.reflected *= 1.0 - round;
        }
        // At the boundary of the shadow the whole pressure is that behind the edge, times the ratio.
        Some(Added {
            direct: (added.direct * (2.0 - ratio) + added.ending * ratio) * strength,
            ending: Complex64::ZERO,
            reflected: added.reflected * strength,
            behind,
        })
    }

    fn added_by_edge(&self, wedge: &Wedge, k: f64, face: f64) -> Added {
        let diffracted = wedge.diffracted(k);
        let mut added = Added {
            direct: diffracted.direct,
            ..Added::default()
        };
        let shares = wedge.shares_of_direct();
        let terms = diffracted.reflected.into_iter().zip(shares);
        for ((term, share), is_heard) in terms.zip(self.are_heard) {
            added.ending += face * share * term;
            if !is_heard {
                added.reflected += face * (1.0 - share * share).sqrt() * term;
            }
        }
        added
    }

    /// Difference in metres between the way over the edge and the straight way.
    pub fn detour_m(&self) -> f64 {
        self.length_m - self.source.distance(self.listener)
    }

    /// How much the edge counts: 1 on the straight way, 0 at the greatest detour.
    pub fn nearness(&self) -> f64 {
        (1.0 - (self.detour_m() / MOST_DETOUR_M).powi(2))
            .max(0.0)
            .powi(2)
    }

    /// Whether the edge lies on the straight way.
    pub fn touches_the_straight_way(&self) -> bool {
        self.detour_m() < LEAST_DETOUR_M
    }

    /// Unit vector from the edge to the straight way.
    pub fn inwards(&self) -> DVec3 {
        self.inwards
    }

    /// The point at which the way bends.
    pub fn point(&self) -> DVec3 {
        self.edge.point
    }
}

/// Directions along a face.
const SIDES: [f64; 2] = [1.0, -1.0];

/// The point at which an obstacle above the straight line, or above a string, touches the lowest tent that it blocks. If a
/// tent touches a plane face, it is the end of the face with the shortest detour, of those on these sides. Also the side.
fn touched(
    space: &impl Space,
    planes: &HalfPlanes,
    (azimuth, above): (f64, Option<&TautString>),
    sides: &[f64],
) -> Option<(DVec3, f64)> {
    let touch = planes.beyond(space, azimuth, above, MOST_DETOUR_M)?;
    let along = planes.along_face(space, azimuth, touch)?;
    let end = |side: &f64| Some((end_of_face(space, planes, touch, along * *side)?, *side));
    let ends = sides.iter().filter_map(end);
    let nearest = ends.min_by(|a, b| planes.detour_m(a.0).total_cmp(&planes.detour_m(b.0)));
    Some(nearest.unwrap_or((touch, sides[0])))
}

/// Distance at which the search for the end of a face begins, as a share of the distance between source and listener, and
/// the factor between distances that are tried.
const FIRST: f64 = 0.01;
const LONGER: f64 = 1.5;
/// Distance from a face up to which a point is on it, as a share of the distance between source and listener.
const ON_FACE: f64 = 10.0 * FINE;

/// The end of a plane face along a unit vector from a point on it; `None` if the surface is curved, or goes on.
fn end_of_face(
    space: &impl Space,
    planes: &HalfPlanes,
    touch: DVec3,
    along: DVec3,
) -> Option<DVec3> {
    let error = ON_FACE * planes.apart_m();
    let height = |metres: f64| space.distance(touch + along * metres);
    let mut on_face = 0.0;
    let mut next = FIRST * planes.apart_m();
    while height(next) <= error {
        if height(next) < -error || planes.detour_m(touch + along * next) > MOST_DETOUR_M {
            return None;
        }
        on_face = next;
        next *= LONGER;
    }
    let (_, end) = bisect(next, on_face, error, |metres| height(metres) <= error);
    // A curved surface leaves its tangent before.
    (height(0.5 * end) < 0.1 * error).then(|| touch + along * end)
}

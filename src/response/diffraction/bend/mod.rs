//! A way around an obstacle: a taut string that is stationary over its edges, and the pressure at its end (`pressure.rs`).

mod abutment;
mod pressure;
mod remembered;

use super::brink::{self, Brink};
use super::curvature::{curvature, least_curvature_step_m, on_surface, turns_of};
use super::edge::{Edge, MOST_SEARCHES, ON_SURFACE, TURN, shorten, turn_for};
use super::round::Arc;
use super::space::Space;
use super::string::{self, HalfPlanes, TautString};
use super::turn::Turn;
use super::wedge::Wedge;
pub(super) use abutment::Abutment;
use glam::DVec3;
use num_complex::Complex64;
use remembered::Remembered;

/// Angle in radians of a turn that only touches a surface.
const GRAZING: f64 = 1e-3;

/// Greatest length of a rounding, as a share of the shorter leg, over whose line a way goes on where no string is found.
const NARROW: f64 = 0.1;

/// Distance over which curvature is measured, as a share of the radius along the way.
const ACROSS: f64 = 0.03;

/// A way over edges and along curved surfaces.
#[derive(Clone, Debug)]
pub(super) struct Bend {
    /// Source, the apexes of the turns, listener.
    pub points: Vec<DVec3>,
    /// Azimuth of the half-plane in radians.
    pub azimuth: f64,
    /// Unit vector from the straight line into the half-plane: away from the solid.
    outwards: DVec3,
    /// Length in metres.
    pub length_m: f64,
    /// One turn for each apex.
    pub turns: Vec<Turn>,
    /// The line of the edge, or the direction in which a round body goes on, for each turn.
    pub edges: Vec<Edge>,
    /// The ends of the faces along which the string arrives at its first edge and leaves its last.
    brinks: [Option<Brink>; 2],
    /// The same way over faces without ends, if a face has one.
    endless: Option<Box<Bend>>,
    /// The wedges at turns, by the index and the distance in metres at which the faces are measured.
    wedges: Remembered<(usize, f64), Option<Wedge>>,
    /// The pressures by turns at edges, by the index, the wave number and the reflection coefficient of the faces.
    at_edges: Remembered<(usize, f64, f64), Complex64>,
}

impl Bend {
    /// Moves the turns of a string to the stationary way.
    pub fn of(space: &impl Space, planes: &HalfPlanes, mut azimuth: f64) -> Option<Bend> {
        let mut last = None;
        for _ in 0..MOST_SEARCHES {
            let Some(string) = planes.string(space, azimuth) else {
                break;
            };
            let Some(bend) = Bend::in_half_plane(space, planes, &string) else {
                break;
            };
            let mut points = bend.points.clone();
            shorten(&mut points, &bend.edges);
            let moved = planes.azimuth_of(points[1]);
            if bend.is_sharp() {
                let stationary = bend.clone().moved_to(points);
                if stationary.is_on_solid(space) {
                    return Some(stationary);
                }
            } else if (moved - azimuth).sin().abs() < ON_SURFACE {
                return Some(bend);
            }
            // The edge is curved or ends: the search goes on where the straight one had its shortest way.
            azimuth = moved;
            let is_shorter = |best: &Bend| string::length(&best.points) <= string.length_m();
            if !last.as_ref().is_some_and(is_shorter) {
                last = Some(bend);
            }
        }
        // The way round a corner, which is not stationary along either edge.
        last
    }

    /// The way over `edge` just below the boundary of the shadow, `after_m` metres before its end. `outwards` points away from
    /// the solid. `None` if the way leads into the solid, as beyond the near edge of a jamb whose inner face the source
    /// sees: no shadow begins at this edge.
    pub fn grazing(
        space: &impl Space,
        source: DVec3,
        edge: Edge,
        after_m: f64,
        outwards: DVec3,
    ) -> Option<Bend> {
        let along = (edge.point - source).try_normalize()?;
        let below = along - outwards.reject_from_normalized(along) * GRAZING;
        let end = edge.point + below.try_normalize()? * after_m;
        let points = vec![source, edge.point, end];
        let turn = Turn::along(source, &[edge.point], end);
        let length_m = string::length(&points);
        let turn = on_surface(space, &turn, &points, least_curvature_step_m(length_m));
        let grazing = Bend {
            points,
            azimuth: 0.0,
            outwards,
            length_m,
            turns: vec![turn],
            edges: vec![edge],
            brinks: [None; 2],
            endless: None,
            wedges: Remembered::default(),
            at_edges: Remembered::default(),
        };
        let beyond = edge.point + below.normalize() * (brink::FIRST * after_m);
        match grazing.is_sharp() && space.distance(beyond) < 0.0 {
            true => None,
            false => Some(grazing.with_brinks(space)),
        }
    }

    /// A string and the lines of its edges, from the string in a half-plane next to its own.
    fn in_half_plane(space: &impl Space, planes: &HalfPlanes, string: &TautString) -> Option<Bend> {
        let turns = turns_of(space, string);
        let beside = |turn: f64| {
            let other = turns_of(space, &planes.string(space, string.azimuth + turn)?);
            (other.len() == turns.len()).then_some(other)
        };
        let heights_m = turns.iter().map(|turn| planes.height_m(turn.apex));
        let turn = turn_for(heights_m.fold(f64::INFINITY, f64::min), planes.apart_m());
        // A narrow body may end before a greater turn.
        let all = [turn, -turn, TURN, -TURN].into_iter();
        let mut others = all.take(if turn > TURN { 4 } else { 2 }).filter_map(beside);
        let first = others.next()?;
        let is_straight = |other: &Vec<Turn>| are_on_edges(space, &turns, other, planes.apart_m());
        let other = match is_straight(&first) {
            true => first,
            false => others.find(is_straight).unwrap_or(first),
        };
        let edge = |(turn, other): (&Turn, &Turn)| {
            Some(Edge {
                point: turn.apex,
                along: (other.apex - turn.apex).try_normalize()?,
            })
        };
        let edges = turns
            .iter()
            .zip(&other)
            .map(edge)
            .collect::<Option<Vec<Edge>>>()?;
        let apexes = turns.iter().map(|turn| turn.apex);
        let points: Vec<DVec3> = [string.source]
            .into_iter()
            .chain(apexes)
            .chain([string.listener])
            .collect();
        let least_m = least_curvature_step_m(planes.apart_m());
        let legs = points.windows(3);
        let turns = turns.iter().zip(legs);
        let turns = turns
            .map(|(turn, legs)| on_surface(space, turn, legs, least_m))
            .collect();
        Some(Bend {
            points,
            azimuth: string.azimuth,
            outwards: planes.upwards(string.azimuth),
            length_m: string.length_m(),
            turns,
            edges,
            brinks: [None; 2],
            endless: None,
            wedges: Remembered::default(),
            at_edges: Remembered::default(),
        })
    }

    /// The same edges, met at other points.
    fn moved_to(mut self, points: Vec<DVec3>) -> Bend {
        for (index, turn) in self.turns.iter_mut().enumerate() {
            let at = [points[index], points[index + 1], points[index + 2]];
            *turn = Turn::along(at[0], &[at[1]], at[2]);
            self.edges[index].point = at[1];
        }
        self.length_m = string::length(&points);
        self.points = points;
        self
    }

    /// Unit vector away from the solid.
    pub fn outwards(&self) -> DVec3 {
        self.outwards
    }

    /// Whether all turns are at edges.
    pub fn is_sharp(&self) -> bool {
        self.turns.iter().all(|turn| turn.arc_m == 0.0)
    }

    /// Whether the way turns at edges alone whose faces have no end beside it.
    pub fn is_plain(&self) -> bool {
        self.is_sharp() && self.brinks == [None; 2]
    }

    /// Whether all its edges are parallel.
    pub fn has_parallel_edges(&self) -> bool {
        let mut neighbours = self.edges.windows(2);
        neighbours.all(|edges| edges[0].is_parallel_to(&edges[1]))
    }

    /// Whether all turns are at edges, or at roundings that are much smaller than the legs.
    pub fn is_narrow(&self) -> bool {
        let turns = self.turns.iter().enumerate();
        turns
            .into_iter()
            .all(|(index, turn)| turn.arc_m <= NARROW * shorter_leg(&self.points, index + 1))
    }

    /// Whether all edges lie on surfaces, and the legs are free.
    fn is_on_solid(&self, space: &impl Space) -> bool {
        self.is_within(space, 0.0, &[])
    }

    /// Whether all edges, or their images in these faces, lie within `height` metres of surfaces, and the legs are free up to
    /// the faces.
    fn is_within(&self, space: &impl Space, height: f64, faces: &[Abutment]) -> bool {
        let error = ON_SURFACE * self.length_m;
        self.turns.iter().all(|turn| {
            let (point, _) = Abutment::in_front(faces, turn.apex, DVec3::ZERO);
            let skew_m = Abutment::skew_m(faces, turn.apex);
            space.distance(point).abs() <= error + height + skew_m
        }) && self.is_free(space, error, faces)
    }

    /// Whether the legs are free up to these faces, if each contact is lifted off the solid by `lift` metres.
    fn is_free(&self, space: &impl Space, lift: f64, faces: &[Abutment]) -> bool {
        let last = self.points.len() - 1;
        let lifted = |index: usize| {
            let point = self.points[index];
            if index == 0 || index == last {
                return point;
            }
            let outwards = (point - self.points[index - 1]).normalize_or_zero()
                + (point - self.points[index + 1]).normalize_or_zero();
            point + outwards.normalize_or_zero() * lift
        };
        (0..last).all(|index| {
            let leg = [lifted(index), lifted(index + 1)];
            let face = faces
                .iter()
                .find(|face| leg.iter().any(|end| face.is_behind(*end)));
            match face {
                Some(face) => face.is_free_up_to(space, leg, lift),
                None => space.is_free(leg[0], leg[1]),
            }
        })
    }

    /// Whether two ways turn at the same points.
    pub fn is_same(&self, other: &Bend) -> bool {
        let near = ON_SURFACE.sqrt() * self.length_m;
        let pairs = self.turns.iter().zip(&other.turns);
        self.turns.len() == other.turns.len()
            && pairs
                .into_iter()
                .all(|(a, b)| a.middle.distance(b.middle) < near)
    }

    /// Finds the ends of the faces beside the first and the last leg.
    pub fn with_brinks(mut self, space: &impl Space) -> Bend {
        let last = self.points.len() - 1;
        let is_edge = |index: usize| self.turns[index].arc_m == 0.0;
        let beside = |index: usize, other: usize, end: usize| {
            let [other, end] = [other, end].map(|point| self.points[point]);
            let brink = || Brink::beside(space, &self.edges[index], other, end);
            is_edge(index).then(brink).flatten()
        };
        let brinks = [beside(0, 2, 0), beside(last - 2, last - 2, last)];
        if brinks != [None; 2] {
            self.endless = Some(Box::new(self.clone()));
            self.brinks = brinks;
        }
        self
    }

    /// The way along the surface of a turn.
    pub fn arc(&self, index: usize) -> Arc {
        let turn = &self.turns[index];
        let before_m = self.before_m(index);
        turn.arc(before_m, self.length_m - before_m - turn.arc_m)
    }

    /// Length in metres from the source to the entry of a turn.
    fn before_m(&self, index: usize) -> f64 {
        let mut from = self.points[0];
        let mut sum = 0.0;
        for turn in &self.turns[..index] {
            sum += from.distance(turn.entry) + turn.arc_m;
            from = turn.exit;
        }
        sum + from.distance(self.turns[index].entry)
    }

    /// Curvature across the way, in 1/m, of the surface at a turn: 0 on a cylinder.
    pub fn across(&self, space: &impl Space, index: usize) -> f64 {
        let turn = &self.turns[index];
        let step = ACROSS * turn.radius_m();
        if step == 0.0 {
            return 0.0;
        }
        let along = self.edges[index].along;
        curvature(space, turn.middle, along, step)
    }

    /// Length in metres of the way over the lines of the same edges in the half-plane of an azimuth; `None` if it does
    /// not cross them.
    pub fn length_over_lines(&self, planes: &HalfPlanes, azimuth: f64) -> Option<f64> {
        let points = self.points_on_lines(planes, azimuth)?;
        Some(string::length(&points) - string::length(&self.points) + self.length_m)
    }

    /// Length in metres of the shortest way over the lines of the edges, also where the edges end before.
    pub fn length_over_endless_lines(&self) -> f64 {
        let mut points = self.points.clone();
        shorten(&mut points, &self.edges);
        string::length(&points) - string::length(&self.points) + self.length_m
    }

    /// Whether the way over the lines of the edges lies on them, and is free, in each of the half-planes with these
    /// azimuths. An edge that ends in a face at right angles to it counts as endless there.
    pub fn are_free_over_lines(
        &self,
        space: &impl Space,
        planes: &HalfPlanes,
        azimuths: &[f64],
    ) -> Vec<bool> {
        if !self.is_narrow() {
            return vec![false; azimuths.len()];
        }
        // The legs before and after a rounding meet above it, higher where they turn more.
        let heights = self.turns.iter().map(|turn| space.distance(turn.apex));
        let height = 2.0 * heights.fold(0.0, f64::max);
        let faces = Abutment::of(space, self);
        let is_free = |azimuth: &f64| {
            self.points_on_lines(planes, *azimuth)
                .is_some_and(|points| {
                    self.clone()
                        .moved_to(points)
                        .is_within(space, height, &faces)
                })
        };
        azimuths.iter().map(is_free).collect()
    }

    /// Source, the points on the lines of the edges in the half-plane of an azimuth, listener.
    fn points_on_lines(&self, planes: &HalfPlanes, azimuth: f64) -> Option<Vec<DVec3>> {
        let last = self.points.len() - 1;
        let mut points = vec![self.points[0]];
        for edge in &self.edges {
            points.push(planes.on_line(edge, azimuth)?);
        }
        points.push(self.points[last]);
        Some(points)
    }
}

/// Whether the lines between the turns of neighbouring strings lie on edges of solids: between an edge and the next one,
/// as a jamb and a lintel, they do not.
fn are_on_edges(space: &impl Space, turns: &[Turn], others: &[Turn], apart_m: f64) -> bool {
    turns.iter().zip(others).all(|(turn, other)| {
        let middle = 0.5 * (turn.apex + other.apex);
        turn.arc_m > 0.0 || space.distance(middle).abs() <= ON_SURFACE * apart_m
    })
}

/// Length in metres of the shorter leg at the point `contact` of a way.
fn shorter_leg(points: &[DVec3], contact: usize) -> f64 {
    let leg = |other: usize| points[other].distance(points[contact]);
    leg(contact - 1).min(leg(contact + 1))
}

//! A way around an obstacle: a taut string that is stationary over its edges, and the pressure at its end.

use super::brink::Brink;
use super::edge::{Edge, MOST_SEARCHES, ON_SURFACE, TURN, face_distance_m, shorten};
use super::round::Arc;
use super::space::Space;
use super::string::{self, FINE, HalfPlanes, TautString};
use super::turn::Turn;
use super::wedge::{Wedge, shadow_function};
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Radius of curvature, as a share of the distance at which faces are perceived, up to which a rounding is an edge, and
/// from which creeping waves follow it.
const SMALL: [f64; 2] = [0.25, 1.0];

/// Growth of the angle between the faces over a doubled distance, as a share of the angle by which they turn, up to which
/// a rounding is an edge, and from which creeping waves follow it: 0 at an edge, a half on a ball.
const FLAT: [f64; 2] = [0.1, 0.3];

/// Distance between two edges, times the wave number, at which they count half as two.
const THIN: f64 = 1.0;

/// Distance over which the curvature of a surface is measured that a way only touches, as a share of the shorter leg.
const TOUCH: f64 = 1e-3;

/// Greatest curvature of a round body, times that distance: an edge of 340° or less has more.
const ROUND_TOUCH: f64 = 0.1;

/// Least distance over which curvature is measured, in errors of a contact: at an edge, a shorter one may lie on one face.
const CONTACT_ERRORS: f64 = 30.0;

/// Angle in radians of a turn that only touches a surface.
const GRAZING: f64 = 1e-3;

/// Greatest length of a rounding, as a share of the shorter leg, over whose line a way goes on where no string is found.
const NARROW: f64 = 0.1;

/// Distance over which curvature is measured, as a share of the radius along the way.
const ACROSS: f64 = 0.03;

/// A way over edges and along curved surfaces.
#[derive(Clone, Debug, PartialEq)]
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

    /// The way that just touches `edge` on the line from the source, `after_m` metres before its end. `outwards` points
    /// away from the solid.
    pub fn grazing(
        space: &impl Space,
        source: DVec3,
        edge: Edge,
        after_m: f64,
        outwards: DVec3,
    ) -> Option<Bend> {
        let along = (edge.point - source).try_normalize()?;
        let end = edge.point + along * after_m;
        let step = TOUCH * source.distance(edge.point).min(after_m);
        let curvature = curvature(space, edge.point, along, step);
        let radius_m = 1.0 / curvature.max(f64::MIN_POSITIVE);
        let turn = Turn {
            angle: GRAZING,
            ..Turn::along(source, &[edge.point], end)
        };
        let turn = turn.with_radius(radius_m.min(after_m));
        Some(Bend {
            points: vec![source, edge.point, end],
            azimuth: 0.0,
            outwards,
            length_m: source.distance(end),
            turns: vec![turn],
            edges: vec![edge],
            brinks: [None; 2],
        })
    }

    /// A string and the lines of its edges, from the string in a half-plane next to its own.
    fn in_half_plane(space: &impl Space, planes: &HalfPlanes, string: &TautString) -> Option<Bend> {
        let turns = turns_of(space, string);
        let beside = |turn: f64| {
            let other = turns_of(space, &planes.string(space, string.azimuth + turn)?);
            (other.len() == turns.len()).then_some(other)
        };
        let other = [TURN, -TURN].into_iter().find_map(beside)?;
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
    fn is_sharp(&self) -> bool {
        self.turns.iter().all(|turn| turn.arc_m == 0.0)
    }

    /// Whether the way turns at edges alone whose faces have no end beside it.
    pub fn is_plain(&self) -> bool {
        self.is_sharp() && self.brinks == [None; 2]
    }

    /// Whether all turns are at edges, or at roundings that are much smaller than the legs.
    fn is_narrow(&self) -> bool {
        let turns = self.turns.iter().enumerate();
        turns
            .into_iter()
            .all(|(index, turn)| turn.arc_m <= NARROW * shorter_leg(&self.points, index + 1))
    }

    /// Whether all edges lie on surfaces, and the legs are free.
    fn is_on_solid(&self, space: &impl Space) -> bool {
        self.is_within(space, 0.0)
    }

    /// Whether all edges lie within `height` metres of surfaces, and the legs are free.
    fn is_within(&self, space: &impl Space, height: f64) -> bool {
        let error = ON_SURFACE * self.length_m;
        self.turns
            .iter()
            .all(|turn| space.distance(turn.apex).abs() <= error + height)
            && self.is_free(space, error)
    }

    /// Whether the legs are free, if each contact is lifted off the solid by `lift` metres.
    fn is_free(&self, space: &impl Space, lift: f64) -> bool {
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
        (0..last).all(|index| space.is_free(lifted(index), lifted(index + 1)))
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

    /// Pressure at the listener for the wave number `k`, relative to that of the source in the open at the way's length,
    /// without the focus of curved edges. `faces` are the pressure reflection coefficients at the turns.
    pub fn pressure(&self, space: &impl Space, k: f64, faces: &[f64]) -> Option<Complex64> {
        let product = self.product(space, k, faces)?;
        let widths = self.brinks.iter().flatten().map(|brink| brink.width_m);
        let Some(width_m) = widths.min_by(f64::total_cmp) else {
            return Some(product);
        };
        let whole = Bend {
            brinks: [None; 2],
            ..self.clone()
        };
        let whole = whole.product(space, k, faces)?;
        let [before, after] = [0, 1].map(|side| self.brink_factor(space, side, k, faces));
        // At the boundary of its shadow the end of a face is an edge of the string, far above it none.
        let hidden = 2.0 * (1.0 - before.norm().min(after.norm())).clamp(0.0, 0.5);
        Some(both(product * before * after, whole, k * width_m, hidden))
    }

    /// The factor by the end of a face before the first turn, or after the last.
    fn brink_factor(&self, space: &impl Space, side: usize, k: f64, faces: &[f64]) -> Complex64 {
        let Some(brink) = self.brinks[side] else {
            return Complex64::ONE;
        };
        let last = self.points.len() - 1;
        let (start, end, face) = match side {
            0 => (self.points[1], self.points[0], faces[0]),
            _ => (
                self.points[last - 1],
                self.points[last],
                faces[faces.len() - 1],
            ),
        };
        let after = start.distance(end);
        let before = self.length_m - after;
        let width = brink.width_m;
        // As for two edges of the string.
        let near = nearness(width, self.length_m, [before + width, after]);
        let factor = brink.factor(space, (start, before), end, k * near.min(1.0), face);
        factor.unwrap_or(Complex64::ONE)
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
        self.brinks = [beside(0, 2, 0), beside(last - 2, last - 2, last)];
        self
    }

    fn product(&self, space: &impl Space, k: f64, faces: &[f64]) -> Option<Complex64> {
        let (mut product, mut last) = self.turn_pressure(space, 0, k, faces[0])?;
        for index in 1..faces.len() {
            // Pierce 1974, equation 26: between two turns the front has spread less than over the whole way.
            let (single, is_edge) = self.turn_pressure(space, index, k, faces[index])?;
            let between = self.between_m(index);
            let reaches = [
                self.before_m(index - 1) + between,
                between + self.length_m - self.before_m(index),
            ];
            let near = k * nearness(between, self.length_m, reaches);
            let spread = match product.norm() < single.norm() {
                true => product * self.turn_pressure(space, index, near, faces[index])?.0,
                false => single * self.product_until(space, index, near, faces)?,
            };
            // On a face between two edges sound and its reflection are one.
            let apart = match last {
                true => spread / (1.0 + faces[index]),
                false => spread,
            };
            let merged = (last && is_edge).then(|| self.merged(space, index, k, faces[index]));
            product = match merged.flatten() {
                Some(merged) => both(apart, merged, k * between, 1.0),
                None => apart,
            };
            last = is_edge;
        }
        Some(product)
    }

    fn product_until(
        &self,
        space: &impl Space,
        index: usize,
        k: f64,
        faces: &[f64],
    ) -> Option<Complex64> {
        let mut product = Complex64::ONE;
        for (before, face) in faces.iter().enumerate().take(index) {
            product *= self.turn_pressure(space, before, k, *face)?.0;
        }
        Some(product)
    }

    /// Distance in metres between a turn and the one before it.
    fn between_m(&self, index: usize) -> f64 {
        self.turns[index - 1].exit.distance(self.turns[index].entry)
    }

    /// Pressure by a turn and the one before it, as by one edge where the legs before and after them meet: they are one
    /// to sound of a long wavelength.
    fn merged(&self, space: &impl Space, index: usize, k: f64, face: f64) -> Option<Complex64> {
        let (first, second) = (&self.turns[index - 1], &self.turns[index]);
        let before = self.points[index - 1];
        let after = self.points[index + 2];
        let turn = Turn::along(before, &[first.entry, second.exit], after);
        let mut points = self.points[..index].to_vec();
        points.push(turn.apex);
        points.extend(&self.points[index + 2..]);
        let [along, other] = [index - 1, index].map(|edge| self.edges[edge].along);
        let along = along + other * other.dot(along).signum();
        let edge = Edge {
            point: turn.apex,
            along: along.try_normalize()?,
        };
        let radius = face_distance_m(k, way_lengths(&points, index), shorter_leg(&points, index));
        let wedge = wedge_at(space, &points, index, &edge, (self.outwards, radius))?;
        Some(wedge.behind(k, face))
    }

    /// Pressure at the listener for the wave number `k` by one turn, relative to the open at the way's length, and whether
    /// it is an edge.
    fn turn_pressure(
        &self,
        space: &impl Space,
        index: usize,
        k: f64,
        face: f64,
    ) -> Option<(Complex64, bool)> {
        let round = self.roundness(space, index, k);
        let mut factor = Complex64::ZERO;
        if round > 0.0 {
            factor += round * 0.5 * (1.0 + face) * self.arc(index).pressure(k);
        }
        if round < 1.0 {
            let edge = match self.wedge(space, index, k, 1.0) {
                Some(wedge) => wedge.behind(k, face),
                // A body that is smaller than the zone has no faces there.
                None => 0.5 * shadow_function(self.arc(index).argument(k)),
            };
            factor += (1.0 - round) * edge;
        }
        Some((factor, round < 0.5))
    }

    /// How much a turn is round to sound of the wave number `k`, from 0 at an edge to 1: the angle between the faces of
    /// an edge does not depend on the distance at which they are measured.
    fn roundness(&self, space: &impl Space, index: usize, k: f64) -> f64 {
        let radius_m = self.turns[index].radius_m();
        if radius_m == 0.0 {
            return 0.0;
        }
        let small = 1.0 - smooth(radius_m / self.face_m(index, k), SMALL);
        if small == 0.0 {
            return 1.0;
        }
        let solid = |share: f64| Some(self.wedge(space, index, k, share)?.air_angle - PI);
        let (Some(near), Some(far)) = (solid(0.5), solid(1.0)) else {
            return 1.0;
        };
        let growth = (far - near).abs() / far.max(f64::MIN_POSITIVE);
        1.0 - small * (1.0 - smooth(growth, FLAT))
    }

    /// Distance in metres from a turn at which sound of the wave number `k` perceives its faces.
    fn face_m(&self, index: usize, k: f64) -> f64 {
        let contact = index + 1;
        let mut nearest = shorter_leg(&self.points, contact);
        for (brink, at) in self.brinks.iter().zip([0, self.turns.len() - 1]) {
            if let Some(brink) = brink.filter(|_| at == index) {
                nearest = nearest.min(brink.width_m);
            }
        }
        face_distance_m(k, way_lengths(&self.points, contact), nearest)
    }

    /// How much the roundest turn is round to sound of the wave number `k`.
    pub fn most_round(&self, space: &impl Space, k: f64) -> f64 {
        let turns = 0..self.turns.len();
        let roundness = |index: usize| self.roundness(space, index, k);
        turns.map(roundness).fold(0.0, f64::max)
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

    /// The wedge at a turn. Its faces are measured at `share` of half a Fresnel zone.
    fn wedge(&self, space: &impl Space, index: usize, k: f64, share: f64) -> Option<Wedge> {
        let faces = (self.outwards, share * self.face_m(index, k));
        wedge_at(space, &self.points, index + 1, &self.edges[index], faces)
    }

    /// Length in metres of the way over the lines of the same edges in the half-plane of an azimuth; `None` if it does
    /// not cross them.
    pub fn length_over_lines(&self, planes: &HalfPlanes, azimuth: f64) -> Option<f64> {
        let points = self.points_on_lines(planes, azimuth)?;
        Some(string::length(&points) - string::length(&self.points) + self.length_m)
    }

    /// Whether the way over the lines of the edges lies on them, and is free, in the half-plane of an azimuth.
    pub fn is_free_over_lines(
        &self,
        space: &impl Space,
        planes: &HalfPlanes,
        azimuth: f64,
    ) -> bool {
        let Some(points) = self
            .points_on_lines(planes, azimuth)
            .filter(|_| self.is_narrow())
        else {
            return false;
        };
        // The legs before and after a rounding meet above it, higher where they turn more.
        let heights = self.turns.iter().map(|turn| space.distance(turn.apex));
        let height = 2.0 * heights.fold(0.0, f64::max);
        let moved = self.clone().moved_to(points);
        moved.is_within(space, height)
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

/// The wedge at the point `contact` of a way, which lies on `edge`: its legs are as long as the way on either side, in the
/// directions of the neighbouring points. `outwards` points away from the solid; `radius` is the distance in metres at
/// which its faces are measured.
fn wedge_at(
    space: &impl Space,
    points: &[DVec3],
    contact: usize,
    edge: &Edge,
    (outwards, radius): (DVec3, f64),
) -> Option<Wedge> {
    let [before, after] = way_lengths(points, contact);
    let end = |neighbour: usize, length: f64| {
        let towards = (points[neighbour] - edge.point).try_normalize()?;
        Some(edge.point + towards * length)
    };
    let ends = [end(contact - 1, before)?, end(contact + 1, after)?];
    edge.wedge(space, ends, outwards, radius)
}

/// Lengths in metres of a way before and after its point `contact`.
fn way_lengths(points: &[DVec3], contact: usize) -> [f64; 2] {
    [&points[..=contact], &points[contact..]].map(string::length)
}

/// Length in metres of the shorter leg at the point `contact` of a way.
fn shorter_leg(points: &[DVec3], contact: usize) -> f64 {
    let leg = |other: usize| points[other].distance(points[contact]);
    leg(contact - 1).min(leg(contact + 1))
}

/// w L / (a b) for two turns w apart on a way of length L, whose parts from the source to the second turn and from the
/// first turn to the listener have the lengths a and b: 1 if the turns are far from both ends.
fn nearness(between_m: f64, length_m: f64, [to_second, from_first]: [f64; 2]) -> f64 {
    between_m * length_m / (to_second * from_first)
}

/// The pressure behind two edges, from that of both one after the other and that of a single edge in their place. `width`
/// is their distance times the wave number, and `hidden` how much both edges hide the listener, from 0 to 1.
///
/// Two hiding edges leave less than either value: the inverse of the pressure is the sixth root of the sum of the sixth
/// powers of both inverses. The boundary-element values of `tests/diffraction` for bars lie within 1 dB (root mean square)
/// of it; the single values are up to 2.5 dB above.
fn both(apart: Complex64, merged: Complex64, width: f64, hidden: f64) -> Complex64 {
    let wide = width / (width + THIN);
    let inverse = |pressure: Complex64| pressure.norm_sqr().max(f64::MIN_POSITIVE.cbrt()).powi(-3);
    let size = (inverse(merged) + wide * inverse(apart)).powf(-1.0 / 6.0);
    let mean = apart * wide + merged * (1.0 - wide);
    match mean.norm() > 0.0 {
        true => mean * (1.0 - hidden + hidden * size / mean.norm()),
        false => merged,
    }
}

/// The turns of a string. Where it touches a round body so little that the error of its contacts parts them, they are one
/// turn.
fn turns_of(space: &impl Space, string: &TautString) -> Vec<Turn> {
    let turns = string.turns();
    let [first, .., last] = &turns[..] else {
        return turns;
    };
    let legs = [
        string.source.distance(first.entry),
        string.listener.distance(last.exit),
    ];
    if first.entry.distance(last.exit) > TOUCH * legs[0].min(legs[1]) {
        return turns;
    }
    let middle = turns[turns.len() / 2].middle;
    let touch = Turn::along(string.source, &[middle], string.listener);
    let least_m = least_curvature_step_m(string.source.distance(string.listener));
    let ends = [string.source, middle, string.listener];
    let touch = on_surface(space, &touch, &ends, least_m);
    match touch.arc_m > 0.0 {
        true => vec![touch],
        false => turns,
    }
}

/// Least distance in metres over which curvature is measured at a contact, for ends `apart_m` metres apart.
fn least_curvature_step_m(apart_m: f64) -> f64 {
    CONTACT_ERRORS * FINE * apart_m
}

/// A turn with the curvature of the surface, where the string touches a round body so little that it has one contact.
/// `legs` are the turn and the points before and after it.
fn on_surface(space: &impl Space, turn: &Turn, legs: &[DVec3], least_m: f64) -> Turn {
    let shorter = legs[0]
        .distance(turn.middle)
        .min(legs[2].distance(turn.middle));
    let step = TOUCH * shorter;
    let along = (legs[2] - legs[0]).normalize_or_zero();
    if turn.arc_m > 0.0 || step < least_m {
        return *turn;
    }
    let curvature = curvature(space, turn.middle, along, step);
    // An arc is shorter than the legs: a contact on a plane has a curvature by rounding alone.
    let is_round = curvature * shorter > turn.angle && curvature * step < ROUND_TOUCH;
    match is_round {
        true => turn.with_radius(1.0 / curvature),
        false => *turn,
    }
}

/// Curvature of a surface at a point on it along a unit vector, in 1/m, by differences over `step` metres; 0 where it is
/// hollow.
fn curvature(space: &impl Space, point: DVec3, along: DVec3, step: f64) -> f64 {
    let at = |offset: DVec3| space.distance(point + offset * step);
    let slope = |axis: DVec3| (at(axis) - at(-axis)) / (2.0 * step);
    let slope = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).length();
    let second = (at(along) + at(-along) - 2.0 * at(DVec3::ZERO)) / (step * step);
    (second / slope.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0 / step)
}

/// A smooth step from 0 to 1.
fn smooth(x: f64, [from, to]: [f64; 2]) -> f64 {
    let share = ((x - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

//! The pressure at the end of a bent way: the product of the pressures by its turns (Pierce 1974), each between that of an
//! edge and that of a curved surface.

use super::Bend;
use crate::response::diffraction::edge::{Edge, face_distance_m};
use crate::response::diffraction::space::Space;
use crate::response::diffraction::string;
use crate::response::diffraction::turn::Turn;
use crate::response::diffraction::wedge::{Wedge, shadow_function};
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Radii of curvature, as shares of the distance at which faces are perceived. Up to the first a rounding counts as an
/// edge. From the second on creeping waves follow it.
const SMALL: [f64; 2] = [0.25, 1.0];

/// Growth of the angle between the faces if the distance is doubled, as a share of the angle by which they turn: 0 at
/// an edge, a half on a ball. Up to the first number a rounding counts as an edge. From the second on creeping waves
/// follow it.
const FLAT: [f64; 2] = [0.1, 0.3];

/// Distance between two edges, times the wave number across them, at which they count half as two. On a way that meets the
/// edges at the angle β both are the share sin β of those along the way.
const THIN: f64 = 1.0;

impl Bend {
    /// Pressure at the listener for the wave number `k`, relative to that of the source in the open at the way's length,
    /// without the focus of curved edges. `faces` are the pressure reflection coefficients at the turns.
    pub fn pressure(&self, space: &impl Space, k: f64, faces: &[f64]) -> Option<Complex64> {
        let product = self.product(space, k, faces)?;
        let across = [0, 1].into_iter().filter_map(|side| {
            let (width_m, along_way_m) = (self.brinks[side]?.width_m, self.to_brink_m(side)?);
            Some(width_m * width_m / along_way_m)
        });
        let Some(across_m) = across.min_by(f64::total_cmp) else {
            return Some(product);
        };
        let whole = self.with_endless_faces().product(space, k, faces)?;
        let [before, after] = [0, 1].map(|side| self.brink_factor(space, side, k, faces));
        // At the boundary of its shadow the end of a face is an edge of the string, far above it none.
        let hidden = 2.0 * (1.0 - before.norm().min(after.norm())).clamp(0.0, 0.5);
        Some(both(product * before * after, whole, k * across_m, hidden))
    }

    /// The first or the last edge, and the end of the way next to it.
    fn outer_leg(&self, side: usize) -> (DVec3, DVec3) {
        let last = self.points.len() - 1;
        match side {
            0 => (self.points[1], self.points[0]),
            _ => (self.points[last - 1], self.points[last]),
        }
    }

    /// Distance in metres along the way from the first or the last edge to the end of the face beside its leg.
    fn to_brink_m(&self, side: usize) -> Option<f64> {
        let (start, end) = self.outer_leg(side);
        let brink = self.brinks[side]?;
        Some(brink.beside_leg(start, end).distance(start))
    }

    /// The factor by the end of a face before the first turn, or after the last.
    fn brink_factor(&self, space: &impl Space, side: usize, k: f64, faces: &[f64]) -> Complex64 {
        let (Some(brink), Some(width)) = (self.brinks[side], self.to_brink_m(side)) else {
            return Complex64::ONE;
        };
        let (start, end) = self.outer_leg(side);
        let face = faces[if side == 0 { 0 } else { faces.len() - 1 }];
        let after = start.distance(end);
        let before = self.length_m - after;
        // As for two edges of the string.
        let near = nearness(width, self.length_m, [before + width, after]);
        let factor = brink.factor(space, (start, before), end, k * near.min(1.0), face);
        factor.unwrap_or(Complex64::ONE)
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
                Some(merged) => both(apart, merged, k * self.across_m(index, between), 1.0),
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

    /// Distance between a turn and the one before it in metres, `between_m` along the way, times the square of the sine of the
    /// way's angle to the edges.
    fn across_m(&self, index: usize, between_m: f64) -> f64 {
        let towards = self.turns[index].entry - self.turns[index - 1].exit;
        let across = self.edges[index].across(towards).length();
        across * across / between_m.max(f64::MIN_POSITIVE)
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
        let shorter_m = shorter_leg_across(&edge, &points, index);
        let radius = face_distance_m(k, way_lengths(&points, index), shorter_m);
        let wedge = wedge_at(space, &points, index, &edge, (self.outwards, radius))?;
        // Edges that cross each other, as two at a corner, do not merge: the faces about their mean direction enclose no
        // solid.
        (wedge.air_angle > PI).then(|| wedge.behind(k, face))
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
            factor += (1.0 - round) * self.edge_at(space, index, k, face);
        }
        Some((factor, round < 0.5))
    }

    fn edge_at(&self, space: &impl Space, index: usize, k: f64, face: f64) -> Complex64 {
        let compute = || match self.wedge(space, index, k, 1.0) {
            Some(wedge) => wedge.behind(k, face),
            // A body that is smaller than the zone has no faces there.
            None => 0.5 * shadow_function(self.arc(index).argument(k)),
        };
        self.at_edges.get((index, k, face), compute)
    }

    /// Pressure at the listener for the wave number `k` by the first turn as an edge of faces without ends, relative to the
    /// open at the way's length.
    pub fn edge_pressure(&self, space: &impl Space, k: f64, face: f64) -> Complex64 {
        self.with_endless_faces().edge_at(space, 0, k, face)
    }

    fn with_endless_faces(&self) -> &Bend {
        self.endless.as_deref().unwrap_or(self)
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
        let mut nearest = shorter_leg_across(&self.edges[index], &self.points, contact);
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

    /// The wedge at a turn. Its faces are measured at `share` of half a Fresnel zone.
    fn wedge(&self, space: &impl Space, index: usize, k: f64, share: f64) -> Option<Wedge> {
        let radius = share * self.face_m(index, k);
        let faces = (self.outwards, radius);
        let compute = || wedge_at(space, &self.points, index + 1, &self.edges[index], faces);
        self.wedges.get((index, radius), compute)
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

/// Length in metres, at right angles to an edge, of the shorter leg at its point `contact` of a way.
fn shorter_leg_across(edge: &Edge, points: &[DVec3], contact: usize) -> f64 {
    let leg = |other: usize| edge.across(points[other] - points[contact]).length();
    leg(contact - 1).min(leg(contact + 1))
}

/// Lengths in metres of a way before and after its point `contact`.
fn way_lengths(points: &[DVec3], contact: usize) -> [f64; 2] {
    [&points[..=contact], &points[contact..]].map(string::length)
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

/// A smooth step from 0 to 1.
fn smooth(x: f64, [from, to]: [f64; 2]) -> f64 {
    let share = ((x - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

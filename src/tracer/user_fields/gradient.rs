//! Checks whether the gradient that a text states, or the derivative of the text, is the gradient of its value.
//!
//! The gradient is compared with differences at points on the surface, where normals are needed, and at points in the
//! air (in the whole box if waves can be on both sides). Five values in a row along each axis give four slopes. Where
//! the value is smooth, these slopes nearly agree, and the gradient must agree with them. Where they differ because of
//! curvature, an edge or rounding, the gradient may differ by the same amount. The comparison uses four distances
//! between values, and the most precise one counts. No two of the distances have a common divisor, so that no ripple
//! looks flat at all of them.

use super::{Probe, TraceError, WaveDomain};
use crate::error::Error;
use crate::scene::halton;
use glam::Vec3;

/// Number of points in the box at which the gradient is checked, in addition to those on the surface.
const SPREAD: usize = 1024;

/// Distances of neighbouring values, as shares of the largest coordinate.
const DISTANCES: [f32; 4] = [1.0 / 16.0, 1.0 / 61.0, 1.0 / 251.0, 1.0 / 1021.0];

/// Minimum coordinate for these distances, as a share of the box, so that the distances are not 0 at the origin.
const LEAST_SCALE: f32 = 1.0 / 1024.0;

/// Offsets of the neighbours along an axis, in multiples of the distance.
const NEIGHBOURS: [f32; 4] = [-2.0, -1.0, 1.0, 2.0];

/// Number of values around a point.
const AROUND: usize = DISTANCES.len() * 3 * NEIGHBOURS.len();

/// Tolerated error of a component in addition to that of the differences, as a share of the gradient's length. An angle
/// of a hundredth of a radian is not visible in a picture.
const TOLERANCE: f64 = 0.01;

/// The rounding error of a coordinate, as in `glsl/common/rounding.glsl`. If the gradient is not finite at a point, the
/// shader evaluates it at an offset of this size.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// A direction that is off every line that a text is likely to treat specially, as in `glsl/user/gradient.glsl`.
const ASIDE: Vec3 = Vec3::new(0.53, -0.62, 0.58);

/// The estimate of a component from differences at one distance.
#[derive(Clone, Copy)]
struct Slope {
    slope: f64,
    /// Difference between the smallest and the largest of the neighbouring slopes.
    doubt: f64,
}

impl Probe<'_> {
    /// Rejects a stated gradient whose error is greater than the differences allow.
    pub(super) fn check_gradient(&self, surface: &[Vec3]) -> Result<(), Error> {
        if !self.field.states_gradient() {
            return Ok(());
        }
        self.worst_gradient(surface)?
            .map_or(Ok(()), |error| Err(error.into()))
    }

    /// The point with the greatest error, if an error is greater than the differences allow.
    pub(super) fn worst_gradient(&self, surface: &[Vec3]) -> Result<Option<TraceError>, Error> {
        let half = 0.5 * self.field.size;
        let spread = (1..=SPREAD).map(|index| half * (2.0 * halton(index).as_vec3() - 1.0));
        let spread: Vec<Vec3> = spread.collect();
        let in_air = self.values(&spread)?;
        let is_with_waves = |value: f32| self.waves == WaveDomain::BothSides || value > 0.0;
        let spread = spread.iter().zip(in_air);
        let spread = spread.filter(|(_, value)| is_with_waves(*value));
        let spread = spread.map(|(place, _)| *place);
        let places: Vec<Vec3> = surface.iter().copied().chain(spread).collect();
        let stated = self.stated(&places)?;
        let middle = self.values(&places)?;
        let points: Vec<Vec3> = places.iter().flat_map(|p| self.neighbours_of(*p)).collect();
        let values = self.values(&points)?;
        let mut worst: Option<(f64, TraceError)> = None;
        let around = points.chunks(AROUND).zip(values.chunks(AROUND));
        for (index, (points, values)) in around.enumerate() {
            let place = places[index];
            let known = self.slopes(place, middle[index], points, values);
            let (excess, found) = compared(stated[index], &known);
            if excess > worst.as_ref().map_or(0.0, |(most, _)| *most) {
                let error = TraceError::FieldGradientOff {
                    file: self.field.file.display().to_string(),
                    place,
                    stated: stated[index],
                    found,
                };
                worst = Some((excess, error));
            }
        }
        Ok(worst.map(|(_, error)| error))
    }

    /// The stated gradients as a shader uses them: evaluated at a small offset where they are undefined.
    fn stated(&self, places: &[Vec3]) -> Result<Vec<Vec3>, Error> {
        let mut stated = self.gradients(places)?;
        let none: Vec<usize> = (0..places.len())
            .filter(|&i| !stated[i].is_finite())
            .collect();
        if none.is_empty() {
            return Ok(stated);
        }
        let half = 0.5 * self.field.size;
        let aside = |&index: &usize| {
            let place = places[index];
            let far = place.abs().max(half).max_element();
            (place + ROUNDING * far * ASIDE).clamp(-half, half)
        };
        let aside: Vec<Vec3> = none.iter().map(aside).collect();
        for (index, gradient) in none.into_iter().zip(self.gradients(&aside)?) {
            stated[index] = gradient;
        }
        Ok(stated)
    }

    pub(super) fn gradients(&self, points: &[Vec3]) -> Result<Vec<Vec3>, Error> {
        let texels = self.texels(points)?;
        let gradient = |texel: &[f32]| Vec3::new(texel[1], texel[2], texel[3]);
        Ok(texels.chunks(4).take(points.len()).map(gradient).collect())
    }

    /// The neighbours of a point, limited to the box: by distance, then by axis.
    fn neighbours_of(&self, place: Vec3) -> impl Iterator<Item = Vec3> {
        let half = 0.5 * self.field.size;
        let scale = place.abs().max(LEAST_SCALE * half).max_element();
        let offsets = DISTANCES.into_iter().flat_map(move |distance| {
            let along = move |axis| NEIGHBOURS.map(|n: f32| n * distance * scale * axis);
            Vec3::AXES.into_iter().flat_map(along)
        });
        offsets.map(move |offset| (place + offset).clamp(-half, half))
    }

    /// The slopes of each component, for all distances at which all neighbours are in the box.
    fn slopes(&self, place: Vec3, middle: f32, points: &[Vec3], values: &[f32]) -> [Vec<Slope>; 3] {
        let mut known = [const { Vec::new() }; 3];
        let rows = points
            .chunks(NEIGHBOURS.len())
            .zip(values.chunks(NEIGHBOURS.len()));
        for (row, (points, values)) in rows.enumerate() {
            let axis = row % 3;
            let ends = [0, 1, 2, 3].map(|i| (f64::from(points[i][axis]), f64::from(values[i])));
            let own = (f64::from(place[axis]), f64::from(middle));
            let line = [ends[0], ends[1], own, ends[2], ends[3]];
            // Deep in the solid a value may be not finite.
            if !line.iter().all(|(_, value)| value.is_finite()) {
                continue;
            }
            let slope = |from: (f64, f64), to: (f64, f64)| (to.1 - from.1) / (to.0 - from.0);
            let slopes = [0, 1, 2, 3].map(|i| slope(line[i], line[i + 1]));
            let (least, most) = slopes
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), s| {
                    (least.min(*s), most.max(*s))
                });
            let doubt = most - least;
            // If two neighbours are limited to the box, they may be the same point.
            if doubt.is_finite() {
                let slope = slope(line[1], line[3]);
                known[axis].push(Slope { slope, doubt });
            }
        }
        known
    }
}

/// The error of a gradient as a multiple of the allowed error, or 0 if the error is allowed. Also returns the gradient
/// from differences.
fn compared(stated: Vec3, known: &[Vec<Slope>; 3]) -> (f64, Vec3) {
    let told = [0, 1, 2].map(|axis| best(&known[axis]));
    let found = Vec3::from(told.map(|told| told.slope as f32));
    let length = f64::from(found.length());
    let excess = |axis: usize| {
        let off = (f64::from(stated[axis]) - told[axis].slope).abs();
        let allowed = told[axis].doubt + TOLERANCE * length;
        // A gradient that is not a number is an error for every allowed error.
        if off <= allowed {
            0.0
        } else {
            (off / allowed).max(1.0)
        }
    };
    let most = [0, 1, 2].map(excess).into_iter().fold(0.0, f64::max);
    (most, found)
}

/// The most precise of the slopes at all distances. The slopes are sorted from the widest distance to the narrowest. A
/// ripple may look flat at a wide distance, and rounding may disturb a narrow one. The doubt of a slope therefore
/// includes two differences: its difference from any narrower slope plus the doubt of that slope, and its difference
/// from any wider slope minus the doubt of that slope.
fn best(slopes: &[Slope]) -> Slope {
    let nothing = Slope {
        slope: 0.0,
        doubt: f64::INFINITY,
    };
    let held = |(index, one): (usize, &Slope)| {
        let others = slopes.iter().enumerate().map(|(other_index, other)| {
            let off = (one.slope - other.slope).abs();
            off + if other_index > index {
                other.doubt
            } else {
                -other.doubt
            }
        });
        Slope {
            slope: one.slope,
            doubt: one.doubt + others.fold(0.0, f64::max),
        }
    };
    let better = |best: Slope, next: Slope| {
        if next.doubt < best.doubt { next } else { best }
    };
    slopes.iter().enumerate().map(held).fold(nothing, better)
}

//! Detours in neighbouring half-planes, and the integral of their phases.
//!
//! Detours are interpolated by cubic polynomials between half-planes; on each part of an interval the phase is linear,
//! and its integral exact. Beyond the outer half-planes they grow without bounds, or end.

use super::string::{HALF_PLANES, STEP};
use super::wedge::shadow_function;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Parts of the interval between half-planes on which the phase is linear.
const PARTS: usize = 12;

/// Greatest slope of the interpolation at a half-plane: a multiple of the lesser change to its neighbours, above which the
/// cubic polynomial would leave the range of its nodes, and a share of the node. Where strings lead over another edge from
/// one half-plane to the next, the change on one side says nothing about the other side. Over a straight edge the changes
/// on both sides differ by 4 % of the node.
const MOST_SLOPE: f64 = 3.0;
const SLOPE_OF_NODE: f64 = 0.1;

/// Interpolated detours in neighbouring half-planes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Samples {
    /// Index of the first half-plane.
    first: usize,
    /// Detours in metres, [`PARTS`] for each interval between half-planes.
    detours: Vec<f64>,
    /// The detours before the first half-plane and after the last.
    ends: [End; 2],
}

/// Detours beyond an outer half-plane, within an angle in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// They grow without bounds.
    Growing { angle: f64 },
    /// They change to `detour_m`, and 1/√δ evenly.
    Until { angle: f64, detour_m: f64 },
}

impl End {
    /// The angle in radians.
    pub fn angle(self) -> f64 {
        match self {
            End::Growing { angle } | End::Until { angle, .. } => angle,
        }
    }

    /// The integral of exp(ikδ) from the detour of the outer half-plane on.
    fn sum(self, k: f64, outer_m: f64) -> Complex64 {
        match self {
            End::Growing { angle } => angle * tail(k * outer_m),
            End::Until { angle, detour_m } => {
                let [outer, last] = [outer_m, detour_m].map(inverse);
                if (outer - last).abs() < EVEN * outer {
                    return angle * Complex64::cis(0.5 * k * (outer_m + detour_m));
                }
                // The integral over 1/√δ from 0 to its value at an angle is this value, times the tail.
                let growing = |inverse: f64| inverse * tail(k / (inverse * inverse));
                angle * (growing(outer) - growing(last)) / (outer - last)
            }
        }
    }
}

impl Samples {
    /// Detours in metres in the half-planes from `first` on, interpolated between those that have one. `is_endless` says
    /// whether they go on before the first and after the last.
    pub fn interpolated(first: usize, nodes: Vec<Option<f64>>, is_endless: [bool; 2]) -> Samples {
        let nodes: Vec<f64> = nodes.into_iter().flatten().map(inverse).collect();
        let last = nodes.len() - 1;
        let slope = |index: usize| match index {
            _ if last == 0 => 0.0,
            0 => end_slope(is_endless[0], [nodes[0], nodes[1]], nodes.get(2)),
            _ if index == last => {
                let further = last.checked_sub(2).map(|further| &nodes[further]);
                -end_slope(is_endless[1], [nodes[last], nodes[last - 1]], further)
            }
            _ => {
                let [before, after] =
                    [1, 0].map(|back| nodes[index + 1 - back] - nodes[index - back]);
                let most =
                    MOST_SLOPE * before.abs().min(after.abs()) + SLOPE_OF_NODE * nodes[index];
                (0.5 * (before + after)).clamp(-most, most)
            }
        };
        let mut detours = Vec::with_capacity(last * PARTS + 1);
        let mut add = |inverse: f64| detours.push(1.0 / (inverse * inverse).max(f64::MIN_POSITIVE));
        for index in 0..last {
            for part in 0..PARTS {
                let t = part as f64 / PARTS as f64;
                let ends = [nodes[index], nodes[index + 1]];
                add(hermite(ends, [slope(index), slope(index + 1)], t));
            }
        }
        add(nodes[last]);
        let end = |is_endless: bool, node: f64, fall: f64| End::Growing {
            angle: match is_endless && fall > 0.0 {
                true => STEP * (node / fall).min(1.0),
                false => 0.0,
            },
        };
        Samples {
            first,
            detours,
            ends: [
                end(is_endless[0], nodes[0], slope(0)),
                end(is_endless[1], nodes[last], -slope(last)),
            ],
        }
    }

    /// The same with other ends, where they are known.
    pub fn with_ends(mut self, ends: [Option<End>; 2]) -> Samples {
        for (own, end) in self.ends.iter_mut().zip(ends) {
            *own = end.unwrap_or(*own);
        }
        self
    }

    /// The detours before the first half-plane and after the last.
    pub fn ends(&self) -> [End; 2] {
        self.ends
    }

    /// The first and the last half-plane, each with its detour in metres.
    pub fn outer(&self) -> [(usize, f64); 2] {
        let last = self.detours.len() - 1;
        [0, last].map(|sample| {
            let index = (self.first + sample / PARTS) % HALF_PLANES;
            (index, self.detours[sample])
        })
    }

    /// The shortest detour in metres.
    pub fn least(&self) -> f64 {
        self.detours.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The integral of exp(ikδ), times a factor that changes from half-plane to half-plane, divided by 2π. `factor`
    /// takes the index of the half-plane.
    pub fn weighted_sum(&self, k: f64, factor: impl Fn(usize) -> Complex64) -> Complex64 {
        let width = STEP / PARTS as f64;
        let count = (self.detours.len() - 1) / PARTS;
        let factors: Vec<Complex64> = (0..=count)
            .map(|index| factor((self.first + index) % HALF_PLANES))
            .collect();
        let mut within = Complex64::ZERO;
        for (interval, ends) in factors.windows(2).enumerate() {
            if ends == [Complex64::ZERO; 2] {
                continue;
            }
            let detours = &self.detours[interval * PARTS..=(interval + 1) * PARTS];
            let mut before = Complex64::cis(k * detours[0]);
            for part in 0..PARTS {
                let share = (part as f64 + 0.5) / PARTS as f64;
                let factor = ends[0] * (1.0 - share) + ends[1] * share;
                let after = Complex64::cis(k * detours[part + 1]);
                let half = 0.5 * k * (detours[part + 1] - detours[part]);
                within += mean_phase([before, after], half) * factor * width;
                before = after;
            }
        }
        let [before, after] = self.ends;
        let before = factors[0] * before.sum(k, self.detours[0]);
        let after = factors[count] * after.sum(k, self.detours[count * PARTS]);
        (within + before + after) / TAU
    }
}

/// 1/√δ, which is a cosine of the azimuth for a straight edge.
fn inverse(detour_m: f64) -> f64 {
    1.0 / detour_m.max(LEAST_DETOUR_M).sqrt()
}

/// Change of 1/√δ, as a share of it, below which the phase in the middle counts: the phases at the ends then differ by
/// 0.12 rad at 8 kHz and a detour of 4 m, and the mean is wrong by 0.06 %.
const EVEN: f64 = 1e-4;

/// The mean of e^{iφ} over phases φ that grow evenly between two ends, from e^{iφ} at both ends and half of their
/// difference in radians.
fn mean_phase([from, to]: [Complex64; 2], half: f64) -> Complex64 {
    if half.abs() > SMALL {
        return (to - from) / Complex64::new(0.0, 2.0 * half);
    }
    // tan(x)/x
    let square = half * half;
    let series = TANGENT.iter().rev().fold(0.0, |sum, c| sum * square + c);
    0.5 * (from + to) * series
}

/// Half difference of two phases in radians below which the mean between them is a power series. The next term is below
/// 1e-12; the quotient of differences above has a relative error below 1e-14.
const SMALL: f64 = 0.1;

/// Coefficients of tan(x)/x by powers of x².
const TANGENT: [f64; 5] = [1.0, 1.0 / 3.0, 2.0 / 15.0, 17.0 / 315.0, 62.0 / 2835.0];

/// Least detour in metres: its phase is below 1e-5 rad.
pub(super) const LEAST_DETOUR_M: f64 = 1e-7;

/// The integral of exp(iy/u²) over u from 0 to 1.
fn tail(y: f64) -> Complex64 {
    let root = y.sqrt();
    let shadow = Complex64::cis(-FRAC_PI_4) * (PI.sqrt() * root) * shadow_function(root);
    Complex64::cis(y) * (1.0 - shadow)
}

/// Slope at an end, per interval inwards: 0 where the detours turn back, and that of a parabola where they go on.
fn end_slope(is_endless: bool, [end, inner]: [f64; 2], further: Option<&f64>) -> f64 {
    let towards = inner - end;
    match (is_endless, further) {
        (false, _) => 0.0,
        (true, Some(further)) => {
            let most = MOST_SLOPE * towards.abs() + SLOPE_OF_NODE * end;
            (2.0 * towards - 0.5 * (further - end)).clamp(-most, most)
        }
        (true, None) => towards,
    }
}

/// The cubic polynomial with these values and slopes at 0 and 1.
fn hermite([a, b]: [f64; 2], [slope_a, slope_b]: [f64; 2], t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    a * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope_a * (t3 - 2.0 * t2 + t)
        + b * (3.0 * t2 - 2.0 * t3)
        + slope_b * (t3 - t2)
}

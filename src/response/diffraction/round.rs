//! Diffraction around smooth convex bodies: creeping waves.
//!
//! # Theory
//! A ray that touches a smooth body follows its surface as a geodesic and leaves it along a tangent. With the legs m
//! and l, the radius of curvature a along the way and the turn θ, the pressure relative to the open at the way's length
//! is, for rigid surfaces (Pathak, *An asymptotic analysis of the scattering of plane waves by a smooth convex
//! cylinder*, Radio Science 14, 1979, here with the time dependence e^{−iωt}),
//!
//! ```text
//! A = ½ W(x) − √(2/kL′) M e^{iπ/4} q(ξ),   x = θ √(kL′/2),  L′ = ml/(m + l),  M = (ka/2)^⅓,  ξ = Mθ,
//! ```
//!
//! with the shadow function W of an edge and Pekeris' function q for hard surfaces. For large ξ q is 1/(2√π ξ) and a sum
//! over the residues at the zeros of Ai′: the creeping modes.
//!
//! Where the radius changes along the way, ξ is the integral of (k/2)^⅓ ρ^(−2/3) over the arc. Across the way the ray
//! tube narrows on a body that is curved there too; `ring.rs` sums the ways where several share a focus.
//!
//! # Accuracy
//! The theory is asymptotic: M should be above 1. `tests/diffraction` compares with the exact solutions of ball and
//! cylinder.

use super::wedge::shadow_function;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_4, PI};

/// The negative zeros of Ai′ (without sign), and Ai there (Abramowitz and Stegun, table 10.13).
const MODES: [(f64, f64); 10] = [
    (1.018_792_97, 0.535_656_66),
    (3.248_197_58, -0.419_015_48),
    (4.820_099_21, 0.380_406_47),
    (6.163_307_36, -0.357_907_94),
    (7.372_177_26, 0.342_301_24),
    (8.488_486_73, -0.330_476_23),
    (9.535_449_05, 0.321_022_29),
    (10.527_660_4, -0.313_185_39),
    (11.475_056_63, 0.306_517_29),
    (12.384_788_37, -0.300_730_83),
];

/// Turn ξ from which ten modes give q within 1e-4.
const MODES_FROM: f64 = 0.7;

/// Coefficients of Pekeris' function by powers of ξ, real and imaginary: a least-squares fit over −0.2 … 1 to its
/// integral, right to 4e-7 there.
const NEAR_ZERO: [(f64, f64); 7] = [
    (-2.660_169_57e-1, 1.535_850_1e-1),
    (1.318_675_85e-1, -2.284_025_8e-1),
    (1.684_121_64e-5, 2.011_907e-2),
    (2.103_772_31e-2, 3.640_726e-2),
    (-1.543_701_32e-2, -8.341_23e-3),
    (1.252_270_38e-3, -1.049_46e-3),
    (7.045_774_22e-4, 2.534_4e-4),
];

/// Turn ξ beyond which only creeping modes count. The optical part should be 0 there, but its error is as large as the
/// modes.
const OPTICAL_UNTIL: f64 = 4.0;

/// A way along a curved surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Length of the way before the surface in metres.
    pub before_m: f64,
    /// Length of the way after the surface in metres.
    pub after_m: f64,
    /// Length on the surface in metres.
    pub arc_m: f64,
    /// Angle between the directions before and after in radians.
    pub angle: f64,
    /// Integral of ρ^(−2/3) over the arc in m^(1/3), where ρ is the radius of curvature.
    pub creeping: f64,
}

impl Arc {
    /// Pressure for the wave number `k`, relative to the open at the way's length, without the focus of a surface that
    /// is curved across the way.
    pub fn pressure(&self, k: f64) -> Complex64 {
        let reach = self.reach_m();
        let radius = self.arc_m / self.angle.max(f64::MIN_POSITIVE);
        let xi = (0.5 * k).cbrt() * self.creeping;
        let x = self.argument(k);
        let scale = (0.5 * k * radius).cbrt();
        let share = (2.0 / (k * reach)).sqrt() * scale * Complex64::cis(FRAC_PI_4);
        if xi < MODES_FROM {
            return 0.5 * shadow_function(x) - share * near_zero(xi);
        }
        let optical = 0.5 * shadow_function(x) - Complex64::cis(FRAC_PI_4) / (2.0 * PI.sqrt() * x);
        optical * (-(xi / OPTICAL_UNTIL).powi(4)).exp() - share * modes(xi)
    }

    /// Argument x of the shadow function: that of a thin edge with the same legs and the same angle.
    pub fn argument(&self, k: f64) -> f64 {
        self.angle * (0.5 * k * self.reach_m()).sqrt()
    }

    /// Width of the ray tube at the end, as a share of that in the open, for a surface with the curvature `across` the
    /// way in 1/m: negative beyond a focus.
    pub fn width(&self, across: f64) -> f64 {
        let radius = self.arc_m / self.angle.max(f64::MIN_POSITIVE);
        let curvature = (across / radius).max(0.0).sqrt();
        let (sine, cosine) = (curvature * self.arc_m).sin_cos();
        let over = match curvature * self.arc_m > 0.0 {
            true => sine / curvature,
            false => self.arc_m,
        };
        let at_end = self.before_m * cosine + over;
        let width = at_end + self.after_m * (cosine - self.before_m * curvature * sine);
        width / (self.before_m + self.arc_m + self.after_m)
    }

    /// m l/(m + l) in metres.
    fn reach_m(&self) -> f64 {
        self.before_m * self.after_m / (self.before_m + self.after_m)
    }
}

fn near_zero(xi: f64) -> Complex64 {
    let terms = NEAR_ZERO.into_iter().rev();
    terms.fold(Complex64::ZERO, |sum, (re, im)| {
        sum * xi + Complex64::new(re, im)
    })
}

/// Pekeris' function without its part 1/(2√π ξ).
fn modes(xi: f64) -> Complex64 {
    let term = |(zero, airy): (f64, f64)| {
        Complex64::from_polar(xi * zero, 5.0 * PI / 6.0).exp() / (zero * airy * airy)
    };
    let sum: Complex64 = MODES.into_iter().map(term).sum();
    // −i e^{−2iπ/3} = e^{5iπ/6}
    Complex64::cis(5.0 * PI / 6.0) * sum / (2.0 * PI.sqrt())
}

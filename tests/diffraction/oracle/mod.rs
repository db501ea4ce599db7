//! Exact sound fields round rigid bodies, in `f64`, that share no code with the library.
//!
//! Time dependence e^{−iωt}: a point source radiates e^{+ikR}/R. Every pressure is the quotient of the total field and
//! the free field at the direct distance, so it is 1 where there is no body. Lengths are in m, angles in radians, wave
//! numbers k = 2πf/c in 1/m.

pub mod bessel;
pub mod half_plane;

mod ball;
mod boundary_elements;
mod cylinder;
mod quadrature;
pub mod scaled;
mod wedge;

pub use ball::ball;
pub use boundary_elements::{Body, Row, boundary_elements};
pub use cylinder::{cylinder, cylinder_line_source};
pub use wedge::Wedge;

use quadrature::integrate;
use rustfft::num_complex::Complex64;

/// Speed of sound of the anchors in m/s.
pub const SPEED_OF_SOUND: f64 = 343.0;

/// Wave number in 1/m at `frequency` Hz for the speed of sound `c` in m/s.
pub fn wave_number(frequency: f64, c: f64) -> f64 {
    std::f64::consts::TAU * frequency / c
}

/// Level in dB of a pressure relative to the free field.
pub fn level_db(pressure: Complex64) -> f64 {
    10.0 * pressure.norm_sqr().log10()
}

/// Level in dB, relative to the free field, of the octave band about `centre_hz`: the mean of |p|² over the logarithm
/// of the frequency from `centre_hz`/√2 to `centre_hz`·√2, by two panels of 24 Gauss–Legendre nodes. They resolve two
/// paths whose lengths differ by up to 15 wavelengths at `centre_hz`. `pressure` takes a frequency in Hz.
pub fn band_level_db(pressure: impl Fn(f64) -> Complex64, centre_hz: f64) -> f64 {
    let energy = integrate(&[-0.5, 0.0, 0.5], |octaves| {
        pressure(centre_hz * octaves.exp2()).norm_sqr().into()
    });
    10.0 * energy.re.log10()
}

/// Distance between two points in m.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

/// Length of a vector in m.
fn length(a: [f64; 3]) -> f64 {
    distance(a, [0.0; 3])
}

/// Terms of a series about a body of radius `a` in m to 1e-16, source and receiver at `r_s` and `r_r` in m from its
/// centre or axis. Beyond the order ka the terms fall over about 8 (ka)^⅓ orders (creeping waves), and everywhere at
/// least as (a²/(rS·rR))ⁿ.
fn term_count(k: f64, a: f64, r_s: f64, r_r: f64) -> usize {
    /// Natural logarithm of 1e-17, without its sign.
    const DECAY: f64 = 40.0;
    let turning = k * a + 10.0 * (k * a).cbrt();
    (turning + DECAY / (r_s * r_r / (a * a)).ln()).ceil() as usize + 10
}

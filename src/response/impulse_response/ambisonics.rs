//! Real spherical harmonics for ambisonics, in the order ACN and with the normalisation SN3D.
//!
//! Channel l² + l + m is the harmonic of degree l and order m, −l ≤ m ≤ l:
//!
//! Y(l, m) = √((2 − δ(m)) (l − |m|)! / (l + |m|)!) P(l, |m|) (sin ε) · cos mα or sin |m|α,
//!
//! with the azimuth α to the left, the elevation ε upwards, and the associated Legendre functions P without the phase
//! (−1)^m (C. Nachbar et al., *AmbiX – A Suggested Ambisonics Format*, 2011). The squares of all harmonics of a degree
//! add up to 1, so each has 1 / (2l + 1) of the energy of a diffuse field.
//!
//! The functions are polynomials of the components of the unit vector: P(l, m) = cos^m ε · Q(l, m), and cos^m ε · e^(imα)
//! = (x + iy)^m. The recurrence of Q over l is stable (W. H. Press et al., *Numerical Recipes*, section 6.7).

use crate::response::ResponseError;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The order of ambisonics: the greatest degree of the harmonics, 1 to 7. The default is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(try_from = "u8", into = "u8")]
pub struct AmbisonicOrder(u8);

/// Number of channels of the greatest order.
pub(super) const MOST_CHANNELS: usize = AmbisonicOrder::MOST.channels();

impl AmbisonicOrder {
    /// First order: four channels.
    pub const FIRST: AmbisonicOrder = AmbisonicOrder(1);

    /// The greatest order, 7: 64 channels.
    pub const MOST: AmbisonicOrder = AmbisonicOrder(7);

    /// The order of this number.
    ///
    /// # Errors
    /// [`ResponseError::BadNumber`] if the number is not 1 to 7.
    pub fn new(order: u8) -> Result<AmbisonicOrder, ResponseError> {
        match (1..=AmbisonicOrder::MOST.0).contains(&order) {
            true => Ok(AmbisonicOrder(order)),
            false => Err(ResponseError::BadNumber {
                what: "the order of ambisonics",
                must: "1 to 7",
                value: order.into(),
            }),
        }
    }

    /// The number, 1 to 7.
    pub fn number(self) -> u8 {
        self.0
    }

    /// Number of channels, (order + 1)².
    pub const fn channels(self) -> usize {
        (self.0 as usize + 1).pow(2)
    }
}

impl Default for AmbisonicOrder {
    fn default() -> AmbisonicOrder {
        AmbisonicOrder::FIRST
    }
}

impl TryFrom<u8> for AmbisonicOrder {
    type Error = ResponseError;

    fn try_from(order: u8) -> Result<AmbisonicOrder, ResponseError> {
        AmbisonicOrder::new(order)
    }
}

impl From<AmbisonicOrder> for u8 {
    fn from(order: AmbisonicOrder) -> u8 {
        order.0
    }
}

/// The degree of the harmonic of a channel.
pub(super) fn degree(channel: usize) -> usize {
    channel.isqrt()
}

/// The harmonics in the direction of a unit vector: x ahead, y to the left, z up. Channels beyond the order are 0.
pub(super) fn harmonics(order: AmbisonicOrder, direction: DVec3) -> [f64; MOST_CHANNELS] {
    let DVec3 { x, y, z } = direction;
    let most = usize::from(order.0);
    let mut harmonics = [0.0; MOST_CHANNELS];
    // (x + iy)^m, the diagonal Q(m, m), and the normalisation of degree m.
    let (mut cos, mut sin) = (1.0, 0.0);
    let mut diagonal = 1.0;
    for m in 0..=most {
        let (mut before, mut now) = (0.0, diagonal);
        for degree in m..=most {
            let middle = degree * degree + degree;
            let scaled = normalisation(degree, m) * now;
            harmonics[middle + m] = scaled * cos;
            if m > 0 {
                harmonics[middle - m] = scaled * sin;
            }
            let next = (2 * degree + 1) as f64 * z * now - (degree + m) as f64 * before;
            (before, now) = (now, next / (degree + 1 - m) as f64);
        }
        (cos, sin) = (x * cos - y * sin, x * sin + y * cos);
        diagonal *= (2 * m + 1) as f64;
    }
    harmonics
}

/// √((2 − δ(m)) (l − m)! / (l + m)!).
fn normalisation(degree: usize, m: usize) -> f64 {
    let factorials: f64 = (degree - m + 1..=degree + m)
        .map(|factor| factor as f64)
        .product();
    let both = if m == 0 { 1.0 } else { 2.0 };
    (both / factorials).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;

    /// Legendre's polynomials from their sums of powers, which share nothing with the recurrence above.
    fn legendre(degree: usize, x: f64) -> f64 {
        let choose = |n: usize, k: usize| {
            (0..k)
                .map(|i| (n - i) as f64 / (i + 1) as f64)
                .product::<f64>()
        };
        let term = |k: usize| {
            choose(degree, k).powi(2)
                * (x - 1.0).powi((degree - k) as i32)
                * (x + 1.0).powi(k as i32)
        };
        (0..=degree).map(term).sum::<f64>() / 2_f64.powi(degree as i32)
    }

    /// Protects all harmonics up to rotations within a degree, and their normalisation: the addition theorem. The sum of
    /// the products of a degree's harmonics in two directions is Legendre's polynomial of the cosine of their angle.
    #[test]
    fn the_addition_theorem_holds() {
        let directions: Vec<DVec3> = lattice(20).collect();
        let of = |direction: &DVec3| harmonics(AmbisonicOrder::MOST, *direction);
        for a in &directions {
            for b in &directions {
                let products: Vec<f64> = of(a).iter().zip(of(b)).map(|(a, b)| a * b).collect();
                for l in 0..=7_usize {
                    let sum: f64 = products[l * l..(l + 1).pow(2)].iter().sum();
                    assert!((sum - legendre(l, a.dot(*b))).abs() < 1e-12, "{l}: {sum}");
                }
            }
        }
    }

    /// Protects the order and the signs of the channels: the closed forms of the first and second degree, the sectoral
    /// harmonics of the third, and the zonal one of the fourth.
    #[test]
    fn channels_have_their_closed_forms() {
        let root = f64::sqrt;
        for direction in lattice(50) {
            let DVec3 { x, y, z } = direction;
            let found = harmonics(AmbisonicOrder::MOST, direction);
            let expected = [
                (0, 1.0),
                (1, y),
                (2, z),
                (3, x),
                (4, root(3.0) * x * y),
                (5, root(3.0) * y * z),
                (6, 0.5 * (3.0 * z * z - 1.0)),
                (7, root(3.0) * x * z),
                (8, root(0.75) * (x * x - y * y)),
                (9, root(5.0 / 8.0) * y * (3.0 * x * x - y * y)),
                (15, root(5.0 / 8.0) * x * (x * x - 3.0 * y * y)),
                (20, (35.0 * z.powi(4) - 30.0 * z * z + 3.0) / 8.0),
            ];
            for (channel, value) in expected {
                assert!((found[channel] - value).abs() < 1e-13, "{channel}");
            }
            let lower = harmonics(AmbisonicOrder(2), direction);
            assert_eq!(lower[..9], found[..9]);
            assert_eq!(lower[9..], [0.0; MOST_CHANNELS - 9]);
        }
    }

    /// Protects callers from orders that have no channels here.
    #[test]
    fn orders_out_of_range_are_refused() {
        for order in [0, 8, 255] {
            let message = AmbisonicOrder::new(order).unwrap_err().to_string();
            assert_eq!(
                message,
                format!("the order of ambisonics must be 1 to 7, not {order}")
            );
        }
        assert_eq!(AmbisonicOrder::MOST.channels(), 64);
        assert_eq!((degree(0), degree(3), degree(4), degree(63)), (0, 1, 2, 7));
    }
}

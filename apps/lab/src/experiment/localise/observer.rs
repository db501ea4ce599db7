//! The observer model: estimates a direction from the levels of two channels.
//!
//! # Theory
//! For each wave that arrives at the point **n** of the unit sphere around the listener, the final pass adds (1 ∓ side)
//! / 2 to the two channels, where side = **n** · right. The panning value is therefore the mean side of all arrivals.
//!
//! Consider a point source in the open, at the distance *D* from a listener of radius *R*. The point of the sphere
//! nearest to the source lies in the source's direction **u**. The arrivals cover a cap around **u** that is symmetric
//! about this axis, so that the mean of **n** is *m* **u**, where *m* is the mean of **n** · **u**. With *k* = *R*/*D*,
//! a wave that leaves the source at the angle *α* to the axis arrives where
//!
//! **n** · **u** = (sin² *α* + cos *α* √(*k*² − sin² *α*)) / *k*.
//!
//! Waves leave the source uniformly over the sphere, so cos *α* is uniform between *c* = √(1 −
//! *k*²) and 1, and both terms can be integrated:
//!
//! *m*(*k*) = [(1 − *c*) − (1 − *c*³)/3 + *k*³/3] / [*k* (1 − *c*)],
//!
//! which is about 2/3 + *k*/2 for a distant source, and 1 for a source that touches the listener. The *lateral angle* λ
//! of a source is the angle between its direction and the median plane: sin λ = **u** · right. The panning value of the
//! source is *m* sin λ. The observer computes the panning value from the levels of the channels by the panning law, and
//! answers λ = asin(pan / *m*).
//!
//! # Limits of the observer
//! Two levels contain only one number. Front and back have the same levels, and so do above and below. Only the lateral
//! angle can be determined. For a source at the height of the ears, it is the azimuth folded to the front. The observer
//! knows *R* and the true distance *D*. A test subject does not know *D*, because the source is not in the picture. The
//! *blind* observer ([`Observer::blind`]) does not know *D* either, and assumes a distant source, *m* = 2/3. A near
//! source then seems further to the side than it is. Neither observer knows the reflections.

use echomarch::audio::PanningLaw;
use echomarch::scene::Scene;
use glam::DVec3;

/// Limit of the centre in degrees: smaller lateral angles to either side are in the centre. The value is more than
/// twice the required accuracy of the observer, which is a few degrees.
pub const CENTRE_DEG: f64 = 15.0;

/// Levels of the two channels, as root mean squares relative to full scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Levels {
    /// Level of the left channel.
    pub left: f64,
    /// Level of the right channel.
    pub right: f64,
}

impl Levels {
    /// The levels of interleaved samples (left, right, …); 0 if there are no samples.
    pub fn of(interleaved: &[f32]) -> Levels {
        let (mut left, mut right) = (0.0, 0.0);
        let pairs = interleaved.as_chunks::<2>().0;
        for pair in pairs {
            left += f64::from(pair[0]).powi(2);
            right += f64::from(pair[1]).powi(2);
        }
        let count = pairs.len().max(1) as f64;
        Levels {
            left: (left / count).sqrt(),
            right: (right / count).sqrt(),
        }
    }

    /// The panning value, −1 … 1, that gives these levels under the law; 0 for silence.
    pub fn pan(&self, law: PanningLaw) -> f64 {
        let sum = self.left + self.right;
        if sum.is_nan() || sum <= 0.0 {
            return 0.0;
        }
        match law {
            PanningLaw::Linear => (self.right - self.left) / sum,
            PanningLaw::ConstantPower => {
                self.right.atan2(self.left) / std::f64::consts::FRAC_PI_4 - 1.0
            }
        }
    }
}

/// A direction, as accurately as two levels determine it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// More than [`CENTRE_DEG`] to the left.
    Left,
    /// Within [`CENTRE_DEG`] of the median plane.
    Centre,
    /// More than [`CENTRE_DEG`] to the right.
    Right,
}

impl Side {
    /// All sides, in the order of the confusion tables.
    pub const ALL: [Side; 3] = [Side::Left, Side::Centre, Side::Right];

    /// The side of a lateral angle in degrees.
    pub fn of(lateral_deg: f64) -> Side {
        if lateral_deg < -CENTRE_DEG {
            Side::Left
        } else if lateral_deg > CENTRE_DEG {
            Side::Right
        } else {
            Side::Centre
        }
    }

    /// The side's name, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Centre => "centre",
            Side::Right => "right",
        }
    }
}

/// The observer model, which knows either both the listener's radius and the source's distance, or neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    mean_side: f64,
    law: PanningLaw,
}

impl Observer {
    /// An observer in `scene` that hears with the panning law `law`.
    pub fn new(scene: &Scene, law: PanningLaw) -> Observer {
        let ratio = f64::from(scene.listeners[0].radius) / direct_distance(scene);
        Observer {
            mean_side: mean_side(ratio),
            law,
        }
    }

    /// An observer that does not know the distance, and uses the *m* of a distant source.
    pub fn blind(law: PanningLaw) -> Observer {
        Observer {
            mean_side: mean_side(0.0),
            law,
        }
    }

    /// *m*: the panning value of a source in the open, exactly to the side.
    pub fn mean_side(&self) -> f64 {
        self.mean_side
    }

    /// The lateral angle estimated from a panning value, in degrees from −90 (left) to 90 (right).
    pub fn lateral_deg(&self, pan: f64) -> f64 {
        (pan / self.mean_side).clamp(-1.0, 1.0).asin().to_degrees()
    }

    /// The observer's answer to the levels, in degrees; 0 for silence.
    pub fn answer_deg(&self, levels: Levels) -> f64 {
        self.lateral_deg(levels.pan(self.law))
    }
}

/// *m*(*k*) of the module documentation, where `ratio` is *k*: the listener's radius divided by the distance of the
/// source. Returns 1 for a source on or inside the listener's sphere.
pub fn mean_side(ratio: f64) -> f64 {
    let k = ratio;
    if k.is_nan() || k >= 1.0 {
        return 1.0;
    }
    if k < 1e-4 {
        // For small k, the closed form is a difference of nearly equal numbers, so a series is used.
        return 2.0 / 3.0 + 0.5 * k;
    }
    let c = (1.0 - k * k).sqrt();
    // 1 − c, computed without cancellation.
    let cap = k * k / (1.0 + c);
    let along = cap * (1.0 - (1.0 + c + c * c) / 3.0);
    (along + k.powi(3) / 3.0) / (k * cap)
}

/// Distance from the listener's centre to the source, in metres.
pub fn direct_distance(scene: &Scene) -> f64 {
    to_source(scene).length()
}

/// The azimuth of the source from the listener in degrees: 0 ahead, 90 to the right, −180 … 180. A source exactly above
/// or below counts as ahead.
pub fn azimuth_deg(scene: &Scene) -> f64 {
    let (right, ahead) = horizontal_axes(scene);
    let to_source = to_source(scene);
    to_source
        .dot(right)
        .atan2(to_source.dot(ahead))
        .to_degrees()
}

/// The angle between the direct path to the source and the median plane, in degrees from −90 (left) to 90 (right). For
/// a source at the height of the ears, it is the azimuth folded to the front. A source at the listener's centre has the
/// angle 0.
pub fn lateral_deg(scene: &Scene) -> f64 {
    let (right, _) = horizontal_axes(scene);
    let sine = to_source(scene).normalize_or_zero().dot(right);
    sine.clamp(-1.0, 1.0).asin().to_degrees()
}

/// Folds an azimuth in degrees to the front, because levels cannot distinguish front and back.
pub fn folded_deg(azimuth_deg: f64) -> f64 {
    azimuth_deg.to_radians().sin().asin().to_degrees()
}

/// The listener's horizontal directions right and ahead, independent of the pitch.
pub fn horizontal_axes(scene: &Scene) -> (DVec3, DVec3) {
    let (sin, cos) = f64::from(scene.listeners[0].yaw).sin_cos();
    (DVec3::new(cos, 0.0, sin), DVec3::new(sin, 0.0, -cos))
}

fn to_source(scene: &Scene) -> DVec3 {
    scene.sources[0].position.as_dvec3() - scene.listeners[0].position.as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::audio::Mixer;

    /// Protects the closed form from errors: the test compares it with a sum over waves that uses only the same
    /// geometry.
    #[test]
    fn the_mean_side_is_that_of_rays_on_a_sphere() {
        for ratio in [1e-3, 0.0838, 0.4, 0.9] {
            let rays = 200_000;
            let least = (1.0f64 - ratio * ratio).sqrt();
            let (mut sum, source) = (0.0, DVec3::X / ratio);
            for ray in 0..rays {
                let cos = least + (1.0 - least) * (f64::from(ray) + 0.5) / f64::from(rays);
                let way = DVec3::new(-cos, (1.0 - cos * cos).sqrt(), 0.0);
                let (half, rest) = (source.dot(way), source.length_squared() - 1.0);
                let flight = -half - (half * half - rest).max(0.0).sqrt();
                sum += (source + flight * way).x;
            }
            let mean = sum / f64::from(rays);
            let formula = mean_side(ratio);
            assert!((mean - formula).abs() < 1e-5, "{ratio}: {mean}, {formula}");
        }
        assert!((mean_side(1e-9) - 2.0 / 3.0).abs() < 1e-8);
        assert!((mean_side(1.1e-4) - mean_side(0.9e-4) - 1e-5).abs() < 1e-7);
        assert_eq!(mean_side(1.0), 1.0);
    }

    /// Protects the conversion of levels to the panning value, for both laws and any sound.
    #[test]
    fn levels_tell_the_pan_again() {
        for law in [PanningLaw::Linear, PanningLaw::ConstantPower] {
            for pan in [-1.0f32, -0.3, 0.0, 0.6, 1.0] {
                let mono = [0.5, -0.25, 0.125];
                let mut stereo = [0.0; 6];
                Mixer::new(law).mix(&mono, pan, &mut stereo).unwrap();
                let heard = Levels::of(&stereo).pan(law);
                assert!(
                    (heard - f64::from(pan)).abs() < 1e-6,
                    "{law}: {pan}, {heard}"
                );
            }
            assert_eq!(Levels::of(&[]).pan(law), 0.0);
        }
    }

    /// Protects the folding: it moves directions from behind to the front, and keeps the side.
    #[test]
    fn azimuths_fold_to_the_front() {
        for (azimuth, folded) in [(0.0, 0.0), (180.0, 0.0), (135.0, 45.0), (-100.0, -80.0)] {
            assert!((folded_deg(azimuth) - folded).abs() < 1e-9, "{azimuth}");
        }
    }
}

//! The sphere in which late arrivals are counted. It is larger than the listener if the larger size only reduces the
//! noise, which falls with 1/radius, and changes little else.
//!
//! Beyond the exact paths, the energy at a point hardly differs from the energy a metre away if no surface focuses
//! sound and no object is in between. Late arrivals are therefore counted in a sphere of [`RADIUS_M`] in an empty room,
//! and in a smaller one elsewhere ([`radius_in_shadows_m`]). Sound does not know the unit of length: in a room of twice
//! the size, a sphere of twice the radius has the same bias, and eight times less noise at the same number of waves per
//! volume. The radius therefore grows with the mean distance of the surfaces ([`scale`]).
//!
//! If a surface focuses sound, the same waves are also counted in an inner sphere, and the two are compared
//! (`late/inner.rs`). If the larger one is biased, the inner one takes its place. The sphere does not reach behind surfaces, because there may be another room (`late/reach.rs`). The
//! walls of a `Room` are an exception, because nothing is behind them: the sphere reaches at most as far behind such a
//! wall as the listener is in front of it. The energy is the mean over the unobstructed part of the sphere. The times
//! are those of paths to its centre, as in the listener's own sphere.
//!

use super::reach::{self, Reach};
use crate::response::{Accuracy, CommonErrors, ResponseSettings};
use crate::scene::{Listener, Node, Pair, Scene};
use crate::tracer::{Detector, Limits, NO_LIMITS};

/// Radius in metres. In random rooms (docs/acoustics.md) T30 is 2.5 times as accurate as with 0.3 m. The bias of the
/// mean over the sphere is still below the noise; with 1.5 m the bias exceeds the noise.
const RADIUS_M: f32 = 1.0;

/// Errors of figures from the mean over the sphere, one standard deviation. T30 was 0.2 to 0.4 % off in all bands in a
/// room of 4.4 × 3 × 4.3 m; C80 0.02 to 0.03 dB in a room of 3.1 × 8.5 × 6.4 m; EDT up to 0.8 % and C80 up to 0.04 dB
/// in a room of 24.8 × 2.5 × 3.8 m.
const ERRORS: CommonErrors = CommonErrors {
    decay_share: 0.003,
    early_decay_share: 0.005,
    clarity_db: 0.02,
    strength_db: 0.003,
    centre_s: 0.0,
};

/// The errors of a sphere of [`RADIUS_M`] if an object is in the room: the object hides part of the flutter echo between
/// walls, and a large sphere extends beyond that shadow. In 14 random rooms with a ball or a box, T30 differed from T30
/// in the listener's own sphere of 0.3 m by 1.1 % (rms of all bands, without noise) with 1 m, 0.6 % with 0.7 m and 0.4 %
/// with 0.5 m. In the worst of these rooms the difference was 4.4, 2.8 and 1.8 %. If all surfaces scatter 0.1, the worst
/// difference was 2.2 % with 1 m and 1.7 % with 0.5 m. G above the audience of the scene hall was 0.08 dB higher in a
/// sphere of 4 m than in one of 1 m.
const ERRORS_IN_SHADOWS: CommonErrors = CommonErrors {
    decay_share: 0.011,
    early_decay_share: 0.014,
    clarity_db: 0.08,
    strength_db: 0.08,
    centre_s: 0.0,
};

/// The exponent of the radius in the errors above: 1.1, 0.6 and 0.4 % with 1, 0.7 and 0.5 m.
const GROWTH_OF_ERRORS: f64 = 1.46;

/// The bias from the mean over the sphere that is accepted without a requested accuracy, as a share of decay times. The
/// biases of other figures are in proportion to their just noticeable differences.
const USUAL_BIAS: f64 = 0.004;

/// The share of a requested accuracy that the mean over the sphere may take. The noise then takes 87 %, because both
/// add by their squares.
const SHARE_OF_ACCURACY: f64 = 0.5;

/// The greatest mean distance in metres from a listener to the surfaces in the random rooms above.
const MEAN_DISTANCE_M: f64 = 3.0;

/// Additional error of a sphere of [`RADIUS_M`] in a room that scatters. Sound from a nearby point of scattering that passes
/// beside the sphere's centre is timed like sound from far away, which is too early by b²/2l (b: distance from the
/// centre, l: distance from the point of scattering). In two random rooms Ts was 0.03 to 0.35 ms too early, and C50
/// 0.03 to 0.10 dB too high.
const SCATTERED_CLARITY_DB: f64 = 0.06;
const SCATTERED_CENTRE_S: f64 = 2e-4;

/// The sphere of a listener.
#[derive(Clone, Copy, Debug)]
pub(in crate::response) struct LateSphere {
    /// Radius in metres in which waves are detected, at least the radius of the listener.
    pub radius_m: f32,
    /// The planes that limit the sphere.
    pub limits: Limits,
    /// The size of the surroundings relative to that of the random rooms.
    scale: f64,
    /// The accepted bias, as a share of decay times.
    pub accepted_bias: f64,
    /// The errors of figures from the larger sphere; `None` for the listener's own sphere.
    pub errors: Option<CommonErrors>,
    /// Radius in metres of the inner sphere in which the same waves are counted; `None` if the two are not compared.
    pub inner_m: Option<f32>,
    /// Whether the figures are those of the inner sphere, because the larger one is biased.
    pub is_narrowed: bool,
}

/// Radius of the inner sphere as a share of the radius of the sphere of late arrivals. A bias that grows with the
/// square of the radius differs by three quarters between the two. The noise in the inner sphere is twice as large.
const INNER: f32 = 0.5;

/// Minimum order of exact paths for the larger sphere. With a lower order, early echoes count as late, and their energy
/// varies over the sphere: next to a source on the floor, G with `--order 0` was 0.67 dB off.
pub(in crate::response) const LEAST_ORDER: u32 = 3;

impl LateSphere {
    /// The sphere of a pair's listener, after exact paths of up to `order` reflections, for figures of the requested
    /// accuracy.
    pub fn of(pair: Pair, order: u32, accuracy: Option<&Accuracy>) -> LateSphere {
        let (scene, own_m) = (pair.scene, pair.listener.radius);
        if order < LEAST_ORDER {
            return LateSphere::own(pair.listener);
        }
        let scale = scale(pair);
        let accepted_bias = accepted_bias(accuracy);
        let most_m = match casts_shadows(scene) {
            true => radius_in_shadows_m(accepted_bias),
            false => f64::from(RADIUS_M),
        };
        let reach = Reach::of(pair, (scale * most_m) as f32);
        if reach.radius_m <= own_m {
            return LateSphere::own(pair.listener);
        }
        LateSphere {
            radius_m: reach.radius_m,
            limits: reach.limits,
            scale,
            accepted_bias,
            errors: Some(errors(scene, reach.radius_m, scale)),
            inner_m: gathers(scene).then(|| own_m.max(INNER * reach.radius_m)),
            is_narrowed: false,
        }
    }

    /// The sphere for responses with these settings. Without figures the inner sphere is left out.
    pub fn for_settings(pair: Pair, order: u32, settings: &ResponseSettings) -> LateSphere {
        let sphere = LateSphere::of(pair, order, settings.accuracy.as_ref());
        LateSphere {
            inner_m: sphere.inner_m.filter(|_| !settings.omits_figures),
            ..sphere
        }
    }

    /// The sphere that takes the place of this one if it is biased: the inner sphere, whose arrivals are known, or else the
    /// listener's own sphere. An inner sphere as small as the listener's own has no errors either.
    pub fn narrower(&self, pair: Pair) -> LateSphere {
        match self.inner_m {
            Some(inner_m) if !self.is_narrowed => LateSphere {
                errors: (inner_m > pair.listener.radius)
                    .then(|| errors(pair.scene, inner_m, self.scale)),
                is_narrowed: true,
                ..*self
            },
            _ => LateSphere::own(pair.listener),
        }
    }

    /// Radius in metres of the sphere whose arrivals the figures are computed from.
    pub fn counted_m(&self) -> f32 {
        self.inner_m
            .filter(|_| self.is_narrowed)
            .unwrap_or(self.radius_m)
    }

    /// The bias of the counted sphere's figures relative to the difference between the two spheres. With the bias
    /// b(r) = k r^g of the counted sphere r and the other one s it is b(r) / |b(s) − b(r)|; 0 for the listener's own.
    pub fn bias_of_difference(&self) -> f64 {
        let (Some(inner_m), Some(_)) = (self.inner_m, self.errors) else {
            return 0.0;
        };
        let [counted, other] = match self.is_narrowed {
            true => [inner_m, self.radius_m],
            false => [self.radius_m, inner_m],
        };
        let ratio = f64::from(other / counted).powf(GROWTH_OF_ERRORS);
        1.0 / (ratio - 1.0).abs()
    }

    /// The listener's own sphere.
    pub fn own(listener: &Listener) -> LateSphere {
        LateSphere {
            radius_m: listener.radius,
            limits: NO_LIMITS,
            scale: 1.0,
            accepted_bias: USUAL_BIAS,
            errors: None,
            inner_m: None,
            is_narrowed: false,
        }
    }

    /// The detector of a listener's late arrivals.
    pub fn detector(&self, listener: &Listener) -> Detector {
        Detector {
            position: listener.position,
            radius: self.radius_m,
            inner_radius: self.inner_m,
            limits: self.limits,
        }
    }
}

/// The accepted bias for figures of the requested accuracy.
fn accepted_bias(accuracy: Option<&Accuracy>) -> f64 {
    accuracy.map_or(USUAL_BIAS, |accuracy| SHARE_OF_ACCURACY * accuracy.share)
}

/// Radius in metres if an object is in the room, before scaling: the one with the accepted bias.
fn radius_in_shadows_m(accepted_bias: f64) -> f64 {
    let share = (accepted_bias / ERRORS_IN_SHADOWS.decay_share).powf(GROWTH_OF_ERRORS.recip());
    f64::from(RADIUS_M) * share.min(1.0)
}

/// The size of the surroundings of a pair's listener relative to that of the random rooms, at least 1.
fn scale(pair: Pair) -> f64 {
    reach::mean_distance_m(pair).map_or(1.0, |distance_m| (distance_m / MEAN_DISTANCE_M).max(1.0))
}

/// The errors of figures from the mean over a sphere.
fn errors(scene: &Scene, radius_m: f32, scale: f64) -> CommonErrors {
    // The radius relative to the one for which the errors are stated.
    let share = f64::from(radius_m) / (scale * f64::from(RADIUS_M));
    let errors = match casts_shadows(scene) {
        true => ERRORS_IN_SHADOWS.scaled(share.powf(GROWTH_OF_ERRORS)),
        false => ERRORS,
    };
    match scene.scatters() {
        true => CommonErrors {
            clarity_db: errors
                .clarity_db
                .hypot(SCATTERED_CLARITY_DB * share.powi(2)),
            // A time, which scales as lengths do.
            centre_s: errors
                .centre_s
                .hypot(SCATTERED_CENTRE_S * share.powi(2) * scale),
            ..errors
        },
        false => errors,
    }
}

/// Whether there is an object in the room.
pub(in crate::response) fn casts_shadows(scene: &Scene) -> bool {
    scene.surfaces.iter().any(|surface| {
        let node = &surface.shape.node;
        !matches!(node, Node::Room(_) | Node::Plane(_) | Node::HalfSpace(_))
    })
}

/// Whether a surface focuses sound.
fn gathers(scene: &Scene) -> bool {
    let mut surfaces = scene.surfaces.iter();
    surfaces.any(|surface| surface.shape.gathers_sound())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Room, Sphere};
    use crate::{Listener, Source, Surface};
    use glam::Vec3;

    fn scene(surfaces: Vec<Surface>, listener: Vec3) -> Scene {
        let listener = Listener::at(listener, 0.3);
        Scene::new("late", surfaces, Source::at(Vec3::Y), listener)
    }

    fn room() -> Surface {
        Surface::new(Room {
            size: Vec3::new(8.0, 3.0, 5.0),
        })
    }

    /// Protects the sphere from reaching into other rooms and foci, and from being smaller than the listener.
    #[test]
    fn the_sphere_is_large_where_nothing_is_near() {
        let wall = Surface::new(Cuboid {
            size: Vec3::new(0.1, 3.0, 5.0),
        });
        let hollow = Surface::new(crate::Shape::from(Sphere { radius: 2.5 }).complement());
        let size = Vec3::new(8.0, 3.0, 5.0);
        let hollow_box = Surface::new(crate::Shape::from(Cuboid { size }).complement());
        let radius = |surfaces, listener| {
            let scene = scene(surfaces, listener);
            LateSphere::of(scene.only_pair().unwrap(), 3, None).radius_m
        };
        assert_eq!(radius(vec![room()], Vec3::ZERO), RADIUS_M);
        assert!((radius(vec![room()], Vec3::X * 3.6) - 0.8).abs() < 1e-5);
        assert_eq!(radius(vec![room()], Vec3::X * 3.9), 0.3);
        let usual = radius_in_shadows_m(USUAL_BIAS) as f32;
        assert_eq!(radius(vec![room(), wall], Vec3::X * 0.45), usual);
        assert_eq!(radius(vec![hollow], Vec3::ZERO), usual);
        assert_eq!(radius(vec![hollow_box.clone()], Vec3::ZERO), usual);
        assert!((radius(vec![hollow_box], Vec3::X * 3.6) - 0.4).abs() < 1e-5);
    }

    /// Protects figures behind obstacles: the sphere is smaller there, and its errors are reported. For the listener's
    /// own sphere these errors are 0.
    #[test]
    fn shadows_make_the_sphere_smaller() {
        let ball = Surface::new(Sphere { radius: 0.5 }).at(Vec3::X * 3.0);
        let mut scene = scene(vec![room(), ball], Vec3::ZERO);
        let of = |scene: &Scene| {
            let sphere = LateSphere::of(scene.only_pair().unwrap(), 3, None);
            (sphere.radius_m, sphere.errors.map(|e| e.decay_share))
        };
        let (radius_m, error) = of(&scene);
        assert!((radius_m - 0.5).abs() < 1e-3, "{radius_m}");
        assert!(error.is_some_and(|error| (error - USUAL_BIAS).abs() < 1e-6));
        scene.listeners[0].radius = 0.6;
        assert_eq!(of(&scene), (0.6, None));
        scene.surfaces.truncate(1);
        assert_eq!(of(&scene), (RADIUS_M, Some(0.003)));
        assert_eq!(
            LateSphere::of(scene.only_pair().unwrap(), 2, None).radius_m,
            0.6
        );
    }

    /// Protects noise in halls, and figures from more bias than the accuracy allows: the radius grows with the room and
    /// with the accuracy, and the errors depend on their ratio.
    #[test]
    fn the_sphere_grows_with_the_room_and_the_accuracy() {
        let ball = |size: f32| Surface::new(Sphere { radius: 0.1 * size }).at(Vec3::X * size);
        let of = |size: f32, accuracy: Option<f64>| {
            let room = Surface::new(Room {
                size: size * Vec3::new(4.0, 3.0, 3.0),
            });
            let scene = scene(vec![room, ball(size)], Vec3::ZERO);
            let accuracy = accuracy.map(Accuracy::new);
            LateSphere::of(scene.only_pair().unwrap(), 3, accuracy.as_ref())
        };
        let errors = |sphere: &LateSphere| sphere.errors.map(|errors| errors.decay_share);
        let [small, large] = [2.0, 8.0].map(|size| of(size, None));
        assert!(
            (large.radius_m / small.radius_m - 4.0).abs() < 1e-3,
            "{small:?} {large:?}"
        );
        assert!((errors(&small).unwrap() / errors(&large).unwrap() - 1.0).abs() < 1e-3);
        // No smaller than in the rooms in which it was tried.
        assert!((of(0.7, None).radius_m - 0.5).abs() < 1e-3);
        for share in [0.005, 0.02] {
            let error = errors(&of(2.0, Some(share))).unwrap();
            assert!((error - 0.5 * share).abs() < 1e-5, "{error}");
        }
        assert_eq!(of(0.7, Some(0.05)).radius_m, RADIUS_M);
    }

    /// Protects figures near foci: the inner sphere takes the place of a biased sphere without other waves, and after it
    /// the listener's own sphere. A bias that grows with the stated power of the radius is estimated exactly.
    #[test]
    fn narrower_spheres_take_the_place_of_biased_ones() {
        let hollow = Surface::new(crate::Shape::from(Sphere { radius: 4.0 }).complement());
        let scene = scene(vec![hollow], Vec3::ZERO);
        let pair = scene.only_pair().unwrap();
        let wide = LateSphere::of(pair, 3, Some(&Accuracy::new(0.04)));
        let inner = wide.narrower(pair);
        assert!(
            inner.is_narrowed && inner.inner_m == wide.inner_m,
            "{inner:?}"
        );
        assert_eq!(inner.detector(pair.listener), wide.detector(pair.listener));
        assert!((inner.counted_m() / wide.counted_m() - 0.5).abs() < 1e-6);
        let error = |sphere: &LateSphere| sphere.errors.unwrap().decay_share;
        assert!(error(&inner) < 0.4 * error(&wide));
        let own = inner.narrower(pair);
        assert!(own.counted_m() == 0.3 && own.errors.is_none());
        // An inner sphere that is the listener's own is counted without other waves, and is not biased.
        let small = Surface::new(crate::Shape::from(Sphere { radius: 2.5 }).complement());
        let small = self::scene(vec![small], Vec3::ZERO);
        let pair = small.only_pair().unwrap();
        let usual = LateSphere::of(pair, 3, None);
        let as_own = usual.narrower(pair);
        assert!(usual.radius_m > 0.3 && as_own.is_narrowed, "{usual:?}");
        assert_eq!(
            (as_own.counted_m(), as_own.bias_of_difference()),
            (0.3, 0.0)
        );
        assert!(as_own.errors.is_none());
        let bias = |radius_m: f32| f64::from(radius_m).powf(GROWTH_OF_ERRORS);
        let difference = bias(wide.counted_m()) - bias(inner.counted_m());
        let estimate = inner.bias_of_difference() * difference;
        assert!((estimate / bias(inner.counted_m()) - 1.0).abs() < 1e-5);
    }
}

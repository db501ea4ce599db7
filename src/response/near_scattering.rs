//! Sound scattered within the maximum number of reflections of exact paths.
//!
//! Next to a scattering wall that is close to a source, the energy density changes within a few decimetres, and its
//! mean over the sphere of late arrivals (`late_sphere.rs`) differs from that at the listener: with source and listener
//! half a metre from a corner whose walls scatter 0.9, G was 0.5 dB too low in a sphere of 0.8 m. The listener's own
//! sphere has no such bias, but more noise. So this part is counted in both spheres, and averaged with the weights that
//! minimise the mean square error. The remaining bias is an error of the figures.

use super::late_sphere::LateSphere;
use crate::acoustics::Echogram;
use crate::bands::Bands;
use crate::scene::{Scene, WALL_COUNT};

/// The relative bias of a mean over a sphere of radius R, over (R / h)², where h is the distance of the source's
/// nearest image. The mean of 1/r² over a small sphere is higher than at its centre by R² / 5 h². In a corner there are
/// three images and their reflections; the factor is doubled for these.
const BIAS: f64 = 0.4;

/// The same arrivals in two spheres.
pub(super) struct NearScattering {
    /// Arrivals in the listener's own sphere.
    pub own: Echogram,
    /// Arrivals in the sphere of late arrivals.
    pub wide: Echogram,
    /// The assumed bias of `wide`, as a share of its energy.
    bias: f64,
}

impl NearScattering {
    /// Empty echograms with the bins of `like`.
    pub fn new(scene: &Scene, late: &LateSphere, like: &Echogram) -> NearScattering {
        let square = f64::from(late.radius_m).powi(2) / nearest_image_m2(scene);
        let is_wider = late.radius_m > scene.listener.radius;
        NearScattering {
            own: like.without_arrivals(),
            wide: like.without_arrivals(),
            // At most all of the energy, even with source and listener at one place on a wall.
            bias: if is_wider {
                (BIAS * square).min(1.0)
            } else {
                0.0
            },
        }
    }

    /// Adds the weighted mean of the two to `echogram`, and its possible bias to `bias`.
    pub fn add_to(&self, echogram: &mut Echogram, bias: &mut Echogram) {
        let weights: Bands = std::array::from_fn(|band| self.weight_of_wide(band));
        echogram.add_scaled(&self.own, &weights.map(|weight| 1.0 - weight));
        echogram.add_scaled(&self.wide, &weights);
        bias.add_scaled(&self.wide, &weights.map(|weight| weight * self.bias));
    }

    /// The weight of the larger sphere, 0 … 1, that minimises the mean square error: the relative variance of a sum of
    /// n arrivals is 1/n.
    fn weight_of_wide(&self, band: usize) -> f64 {
        let (own, wide) = (
            self.own.effective_arrivals(band, 0.0),
            self.wide.effective_arrivals(band, 0.0),
        );
        if wide == 0.0 {
            return 0.0;
        }
        // The weight from variances 1/own and 1/wide + bias², without division by 0.
        1.0 / (1.0 + own * (1.0 / wide + self.bias.powi(2)))
    }
}

/// The squared distance in m² from the listener to the nearest image of the source in a scattering surface, from
/// distances only: for a plane, (distance between both)² + 4 · (distance of the source) · (distance of the listener). ∞
/// without scattering.
fn nearest_image_m2(scene: &Scene) -> f64 {
    let (source, listener) = (scene.source.position, scene.listener.position);
    let apart = f64::from(source.distance_squared(listener));
    let image = |index: usize| {
        let surface = &scene.surfaces[index];
        let from_surface = |place| f64::from(surface.distance(place).max(0.0));
        apart + 4.0 * from_surface(source) * from_surface(listener)
    };
    let all = 0..scene.surfaces.len();
    let images = all.filter(|index| scatters(scene, *index)).map(image);
    images.fold(f64::INFINITY, f64::min)
}

/// Whether the material of a surface (counted from 0), or of one of its walls, scatters.
fn scatters(scene: &Scene, surface: usize) -> bool {
    let walls = std::iter::once(None).chain((0..WALL_COUNT).map(Some));
    let mut materials = walls.filter_map(|wall| scene.material(surface, wall));
    materials.any(|material| material.scattering.iter().any(|share| *share > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;
    use crate::scene::shape::Room;
    use crate::{Listener, Source, Surface};
    use glam::{DVec3, Vec3};

    fn corner(scattering: f64) -> Scene {
        let mut room = Surface::new(Room {
            size: Vec3::new(8.0, 3.0, 5.0),
        });
        room.material = Some("m".to_owned());
        let source = Source::at(Vec3::new(-3.9, 0.0, 0.0));
        let listener = Listener::at(Vec3::new(-3.6, 0.0, 0.4), 0.1);
        let mut scene = Scene::new("corner", vec![room], source, listener);
        let material = Material {
            absorption: [0.5; 8],
            scattering: [scattering; 8],
        };
        scene.materials.insert("m".to_owned(), material);
        scene
    }

    fn with_arrivals(count: usize) -> Echogram {
        let mut echogram = Echogram::new(1e-3, 4).expect("a good bin");
        for arrival in 0..count {
            echogram
                .add(arrival % 4, 0.01, &[1.0 / count as f64; 8], DVec3::X)
                .unwrap();
        }
        echogram
    }

    /// Protects the distance of the source's image in a wall: 0.1 m and 0.4 m from it, 0.3 m and 0.4 m apart.
    #[test]
    fn the_nearest_image_is_that_of_the_source_in_its_wall() {
        let square = nearest_image_m2(&corner(0.5));
        assert!((square - (0.5 * 0.5 + 0.4 * 0.4)).abs() < 1e-5, "{square}");
        assert_eq!(nearest_image_m2(&corner(0.0)), f64::INFINITY);
    }

    /// Protects figures next to scattering walls: the larger sphere gets no weight if its bias is above the noise of
    /// the listener's own sphere, and almost all weight without bias.
    #[test]
    fn the_larger_sphere_counts_as_its_bias_allows() {
        let of = |bias: f64| {
            let near = NearScattering {
                own: with_arrivals(100),
                wide: with_arrivals(10_000),
                bias,
            };
            let mut sums = [0, 1].map(|_| Echogram::new(1e-3, 4).expect("a good bin"));
            let [echogram, biased] = &mut sums;
            near.add_to(echogram, biased);
            assert!((echogram.total()[3] - 1.0).abs() < 1e-12);
            (near.weight_of_wide(3), biased.total()[3])
        };
        let (near, far) = (of(1.0), of(0.001));
        assert!(near.0 < 0.01 && far.0 > 0.98, "{near:?} {far:?}");
        // The remaining bias is below half the noise of the listener's own sphere.
        for bias in [0.01, 0.1, 1.0] {
            assert!(of(bias).1 <= 0.05, "{bias}");
        }
    }
}

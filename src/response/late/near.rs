//! Near scattering surfaces: sound scattered within the maximum number of reflections of exact paths.
//!
//! Next to a scattering wall that is close to a source, the energy density changes within a few decimetres, and its
//! mean over the sphere of late arrivals differs from its value at the listener. With source and listener half a metre
//! from a corner whose walls scatter 0.9, G was 0.5 dB too low in a sphere of 0.8 m. The listener's own sphere has no
//! such bias, but more noise. This sound is therefore counted in both spheres, and averaged with the weights that
//! minimise the mean square error. The remaining bias counts as an error of the figures.

use crate::bands::{BAND_COUNT, Bands};
use crate::response::Echogram;
use crate::scene::{Pair, Scene};

/// The relative bias of a mean over a sphere of radius R, in units of (R / h)², where h is the distance of the source's
/// nearest image. The mean of 1/r² over a small sphere is higher than its value at the centre by R² / 5 h². A corner
/// has three such images and the images of these images, so the factor is doubled.
const BIAS: f64 = 0.4;

/// Sound scattered after few reflections, in the listener's own sphere.
#[derive(Clone)]
pub(super) struct NearScattering {
    /// Arrivals in the listener's own sphere.
    pub own: Echogram,
    /// Radius in metres of the listener's own sphere.
    own_m: f32,
    /// The squared distance in m² from the listener to the source's nearest image.
    image_m2: f64,
}

impl NearScattering {
    /// An empty echogram with the bins of `like`.
    pub fn new(pair: Pair, like: &Echogram) -> NearScattering {
        NearScattering {
            own: like.without_arrivals(),
            own_m: pair.listener.radius,
            image_m2: nearest_image_m2(pair),
        }
    }

    /// The assumed bias of the same sound in a sphere of this radius, as a share of its energy.
    fn bias(&self, radius_m: f32) -> f64 {
        match radius_m > self.own_m {
            // At most the whole energy, even with source and listener at the same point on a wall.
            true => (BIAS * f64::from(radius_m).powi(2) / self.image_m2).min(1.0),
            false => 0.0,
        }
    }

    /// Adds the two parts of the weighted mean of this sound and `wide`, the same sound in a sphere of `radius_m` metres,
    /// to the two `sums`, and the possible bias of `wide` to `bias`.
    pub fn add_to(
        &self,
        (wide, radius_m): (&Echogram, f32),
        sums: [&mut Echogram; 2],
        bias: &mut Echogram,
    ) {
        let of_wide = self.bias(radius_m);
        let weights: Bands = std::array::from_fn(|band| self.weight_of(wide, of_wide, band));
        let [own_part, wide_part] = sums;
        own_part.add_scaled(&self.own, &weights.map(|weight| 1.0 - weight));
        wide_part.add_scaled(wide, &weights);
        bias.add_scaled(wide, &weights.map(|weight| weight * of_wide));
    }

    /// The weight of the larger sphere, 0 … 1, that minimises the mean square error: the relative variance of a sum of
    /// n arrivals is 1/n.
    fn weight_of(&self, wide: &Echogram, bias: f64, band: usize) -> f64 {
        let (own, wide) = (
            self.own.effective_arrivals(band, 0.0),
            wide.effective_arrivals(band, 0.0),
        );
        if wide == 0.0 {
            return 0.0;
        }
        // Computes the weight from the variances 1/own and 1/wide + bias², without a division by 0.
        1.0 / (1.0 + own * (1.0 / wide + bias.powi(2)))
    }
}

/// The squared distance in m² from the listener to the nearest image of the source in a scattering surface; ∞ without
/// scattering surfaces. It is computed as for a plane: d² + 4 s l, with the distance d between source and listener, the
/// distance s of the source from the surface, and the distance l of the listener from the surface.
fn nearest_image_m2(pair: Pair) -> f64 {
    let scene = pair.scene;
    let (source, listener) = (pair.source.position, pair.listener.position);
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
    let walls = std::iter::once(None).chain((0..scene.surfaces[surface].part_count()).map(Some));
    let mut materials = walls.filter_map(|wall| scene.material(surface, wall));
    materials.any(|material| material.scatters(0..BAND_COUNT))
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
            ..Material::MIRROR
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

    /// Protects the distance of the source's image in a wall, with source and listener 0.1 m and 0.4 m from the wall,
    /// and 0.3 m and 0.4 m apart.
    #[test]
    fn the_nearest_image_is_that_of_the_source_in_its_wall() {
        let square = nearest_image_m2(corner(0.5).only_pair().unwrap());
        assert!((square - (0.5 * 0.5 + 0.4 * 0.4)).abs() < 1e-5, "{square}");
        assert_eq!(
            nearest_image_m2(corner(0.0).only_pair().unwrap()),
            f64::INFINITY
        );
    }

    /// Protects figures next to scattering walls: the larger sphere gets no weight if its bias exceeds the noise of the
    /// listener's own sphere, and gets almost all weight without bias.
    #[test]
    fn the_larger_sphere_counts_as_its_bias_allows() {
        let of = |bias: f64| {
            let near = NearScattering {
                own: with_arrivals(100),
                own_m: 0.3,
                image_m2: BIAS / bias,
            };
            let wide = with_arrivals(10_000);
            let mut sums = [0, 1, 2].map(|_| Echogram::new(1e-3, 4).expect("a good bin"));
            let [own_part, wide_part, biased] = &mut sums;
            near.add_to((&wide, 1.0), [own_part, wide_part], biased);
            assert!((own_part.total()[3] + wide_part.total()[3] - 1.0).abs() < 1e-12);
            (near.weight_of(&wide, bias, 3), biased.total()[3])
        };
        let (near, far) = (of(1.0), of(0.001));
        assert!(near.0 < 0.01 && far.0 > 0.98, "{near:?} {far:?}");
        // The remaining bias is below half the noise of the listener's own sphere.
        for bias in [0.01, 0.1, 1.0] {
            assert!(of(bias).1 <= 0.05, "{bias}");
        }
    }
}

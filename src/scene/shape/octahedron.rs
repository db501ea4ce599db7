//! A regular octahedron: the example in `docs/architecture.md`, compiled for tests only.

use super::part::part;
use super::{Bounds3, Part, Properties, Shape};
use glam::DVec3;

part! {
    /// A regular octahedron.
    Octahedron {
        /// Distance of the vertices from the centre, in metres.
        radius: f32 as Radius,
    }
}

impl Part for Octahedron {
    /// The value is the distance to the plane of the nearest face, which is a lower bound of the distance near edges.
    fn properties(&self, _: &[Shape]) -> Properties {
        let half_size = DVec3::splat(self.radius.into());
        Properties {
            convex: true,
            ..Properties::bound(Bounds3::centred(half_size))
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        (p.abs().element_sum() - f64::from(self.radius)) / 3f64.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::ExactScene;
    use crate::gl::{Context, ContextOptions};
    use crate::{Profile, Scene, Settings, Tracer};

    const SCENE: &str = "Scene(
        surfaces: [
            Surface(shape: Octahedron(radius: 1.5), position: (0, 0, -3)),
            Surface(shape: Difference(from: Octahedron(radius: 2), cut: [Sphere(radius: 1.2)]),
                position: (4, 0, 0)),
        ],
        source: Source(position: (0, 0, 0)),
        listener: Listener(position: (0, 4, 0), radius: 0.5),
    )";

    /// Protects the procedure for adding a shape: two files, a line in the list and two lines in `mod.rs`. The added
    /// shape can be named in scene files, evaluated on the CPU, and traced in every profile. The test compares the
    /// traces with the reference, which uses only the value of the shape.
    #[test]
    fn a_shape_of_two_files_and_a_line_is_traced() {
        let scene = Scene::from_ron(SCENE, "octahedra").unwrap();
        let exact = ExactScene::new(&scene).unwrap();
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut tracer = Tracer::new(&context).unwrap();
        for profile in [Profile::Hybrid, Profile::March] {
            let settings = Settings::new(profile).with_waves(4096).with_iterations(1);
            let (_, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
            let start = scene.sources[0].position.as_dvec3();
            let (mut met, mut differ) = ([0; 2], 0);
            for wave in &waves {
                let hit = exact.closest_hit(start, wave.start_direction.as_dvec3());
                let object = hit.map_or(-1.0, |hit| hit.object as f32);
                match (wave.status == object, object) {
                    (false, _) => differ += 1,
                    (true, 1.0) => met[0] += 1,
                    (true, 2.0) => met[1] += 1,
                    _ => (),
                }
            }
            assert!(met.iter().all(|&met| met > 100), "{profile}: {met:?}");
            // Hits at an edge depend on rounding.
            assert!(differ <= 2, "{profile}: {differ} of {} waves", waves.len());
        }
    }
}

//! Materials, in scenes with and without a base.

use super::Target;
use super::scratch::with_file;
use echomarch::Scene;

const TOKENS: &[&str] = &[
    "Material",
    "absorption",
    "scattering",
    "reduction",
    "thickness",
    "density",
    "coincidence",
    "materials",
    "material",
    "walls",
    "floor",
    "ceiling",
    "left",
    "right",
    "front",
    "back",
    "brick",
    "curtain",
    "mat",
    "own",
    "Surface",
    "Room",
    "true",
    "None",
    "Some",
    "{",
    "}",
    "[",
    "]",
];

const CORPUS: [&str; 3] = [
    "Scene(surfaces: [Surface(shape: Room(size: (9, 4, 7)), material: \"brick\", walls: (floor: \"mat\", back: \
     \"own\"))], materials: {\"mat\": Material(absorption: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], scattering: 0.1), \
     \"own\": Material(absorption: 0.25, scattering: [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])}, source: \
     Source(position: (-3, 0, 1)), listener: Listener(position: (3, 0, 1), radius: 0.5))",
    "Scene(surfaces: [Surface(shape: Room(size: (9, 4, 7)), material: \"own\")], materials: {\"brick\": \
     Material(absorption: 1, density: 1800, coincidence: 20), \"own\": Material(reduction: 35, thickness: 0.1)}, source: Source(position: (-3, 0, 1)), \
     listener: Listener(position: (3, 0, 1), radius: 0.5))",
    "Scene(base: \"corner\", materials: {\"brick\": Material(absorption: 0.5, scattering: 0.99)})",
];

/// Returns the target for materials.
pub fn target() -> Target {
    Target {
        name: "materials",
        corpus: CORPUS.map(|text| text.as_bytes().to_vec()).to_vec(),
        tokens: TOKENS,
        one,
    }
}

/// Reads a scene with materials. Accepted coefficients must be from 0 to 1.
pub fn one(data: &[u8]) {
    with_file("scene.ron", data, |path| match Scene::from_file(path) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(scene) => {
            assert!(scene.validate().is_ok());
            for material in scene.materials.values() {
                let shares = material.absorption.iter().chain(&material.scattering);
                assert!(shares.into_iter().all(|share| (0.0..=1.0).contains(share)));
            }
        }
    });
}

//! Scenes with a base. Each input is read as the base of two other scenes in the same folder.

use super::Target;
use super::scratch::with_file;
use echomarch::Scene;
use std::path::Path;

const TOKENS: &[&str] = &[
    "Scene",
    "base",
    "base.ron",
    "scene.ron",
    "above.ron",
    "corner",
    "../base.ron",
    "/dev/zero",
    ".",
    "name",
    "values",
    "Value",
    "Keys",
    "surfaces",
    "Surface",
    "Sphere",
    "Room",
    "Field",
    "file",
    "HeightField",
    "Grid",
    "cell",
    "image",
    "materials",
    "material",
    "Material",
    "air",
    "Air",
    "source",
    "sources",
    "listener",
    "listeners",
    "Source",
    "Listener",
    "position",
    "path",
    "Key",
    "time",
    "radius",
    "level_db",
    "size",
    "turn",
];

const CORPUS: [&str; 4] = [
    "Scene(surfaces: [Surface(shape: Sphere(radius: Value(\"size\", 1)), rotation: (0, Value(\"turn\", 30), 0))], \
     source: Source(position: (9, 9, 9)), listener: Listener(position: (-9, 9, 9), radius: 1))",
    "Scene(base: \"corner\", values: [Value(\"size\", 2)], materials: {\"mat\": Material(absorption: 0.3)}, \
     sources: [Source(name: \"a\", position: (1, 0, 0)), Source(name: \"b\", level_db: -6)])",
    "Scene(base: \"scene.ron\", values: [Value(\"turn\", 60)])",
    "Scene(surfaces: [Surface(shape: Field(file: \"f.glsl\", lipschitz: 1, size: (3, 3, 3)), material: \"mat\")], \
     materials: {\"mat\": Material(absorption: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], scattering: 0.1)}, \
     source: Source(path: [Key(time: 0, position: (5, 0, 0)), Key(time: 2, position: (5, 1, 0))]), \
     listener: Listener(position: (-5, 0, 0), yaw: 30, radius: 1))",
];

/// Returns the target for scenes with a base.
pub fn target() -> Target {
    Target {
        name: "base_scene",
        corpus: CORPUS.map(|text| text.as_bytes().to_vec()).to_vec(),
        tokens: TOKENS,
        one,
    }
}

/// Reads the scenes that are based on the file.
pub fn one(data: &[u8]) {
    let field = b"float field(vec3 p) { return length(p) - 1.0; }";
    with_file("f.glsl", field, |_| ());
    let scene = b"Scene(base: \"base.ron\", values: [Value(\"size\", 2)], source: Source(position: (4, 4, 4)))";
    with_file("scene.ron", scene, |_| ());
    let above =
        b"Scene(base: \"scene.ron\", listener: Listener(position: (4, -4, 4), radius: 0.5))";
    with_file("above.ron", above, |_| ());
    with_file("base.ron", data, |path| {
        for name in ["base.ron", "scene.ron", "above.ron"] {
            read(&path.with_file_name(name));
        }
    });
}

fn read(path: &Path) {
    match Scene::from_file(path) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(scene) => {
            assert!(scene.validate().is_ok());
            let _ = scene.warnings();
            drop(ron::to_string(&scene));
        }
    }
}

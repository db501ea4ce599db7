//! Scene files: reading, and the computations before drawing.

use super::Target;
use super::scratch::with_file;
use echomarch::Scene;

const TOKENS: &[&str] = &[
    "Plane",
    "Box",
    "Room",
    "Sphere",
    "Cylinder",
    "HalfSpace",
    "RoundedBox",
    "Capsule",
    "Torus",
    "Cone",
    "Prism",
    "Ellipsoid",
    "Paraboloid",
    "Hyperboloid",
    "Quadric",
    "Union",
    "Intersection",
    "Difference",
    "Complement",
    "Shell",
    "SmoothUnion",
    "Offset",
    "Translate",
    "Rotate",
    "Scale",
    "Mirror",
    "Repeat",
    "Elongate",
    "Twist",
    "Bend",
    "Morph",
    "Keys",
    "Value",
    "HeightField",
    "Grid",
    "Field",
    "name",
    "base",
    "values",
    "base.ron",
    "small.ron",
    "scene.ron",
    "corner",
    "surfaces",
    "source",
    "listener",
    "path",
    "time",
    "position",
    "rotation",
    "turns",
    "radius",
    "size",
    "height",
    "axis",
    "count",
    "period",
    "lipschitz",
    "bend",
    "materials",
    "Material",
    "absorption",
    "scattering",
    "material",
    "walls",
    "floor",
    "back",
    "brick",
    "mat",
    "air",
    "Air",
    "temperature",
    "humidity",
    "pressure",
    "sources",
    "listeners",
    "level_db",
    "directivity",
    "FirstOrder",
    "Balloon",
    "true",
    "X",
];

/// Examples of all shapes and operators.
const SHAPES: &[&str] = &[
    "HalfSpace(normal: (0, 1, 0), offset: -1)",
    "RoundedBox(size: (2, 2, 2), rounding: 0.2)",
    "Cylinder(radius: 1, height: 2, axis: (1, 2, 3))",
    "Capsule(radius: 1, height: 2)",
    "Torus(ring: 2, tube: 0.5)",
    "Cone(radius: 1, height: 2)",
    "Prism(corners: [(0, 0), (1, 0), (0.5, Keys([(0, 1), (2, 2)]))], depth: 1)",
    "Ellipsoid(radii: (1, 2, 3))",
    "Paraboloid(focal_length: 1)",
    "Hyperboloid(waist: 1, rise: 1, sheets: 2)",
    "Quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -1))",
    "SmoothUnion(of: [Sphere(radius: 1), Box(size: (1, 2, 3))], radius: 0.3)",
    "Difference(from: Room(size: (9, 9, 9)), cut: [Sphere(radius: 2), Plane])",
    "Intersection(of: [Complement(of: Sphere(radius: 1)), Sphere(radius: 2)])",
    "Shell(of: Sphere(radius: 2), thickness: Value(\"shell\", 0.2))",
    "Offset(of: Box(size: (1, 1, 1)), by: 0.1)",
    "Translate(of: Rotate(of: Torus(ring: 2, tube: 1), by: (0, 90, 45)), by: (1, 2, 3))",
    "Scale(of: Mirror(of: Sphere(radius: 1), axes: \"xz\"), by: 2)",
    "Repeat(of: Sphere(radius: 1), period: (4, 0, 4), count: (3, 0, 0))",
    "Elongate(of: Torus(ring: 2, tube: 1), by: (1, 0, 0))",
    "Twist(of: Box(size: (1, 4, 1)), rate: 20)",
    "Bend(of: Box(size: (4, 1, 1)), rate: 10, lipschitz: 3)",
    "Morph(from: Sphere(radius: 1), to: Box(size: (1, 1, 1)), amount: Keys([(0, 0), (1, 1)]))",
];

/// A base in the folder of the file that is read.
const BASE: &str = "Scene(surfaces: [Surface(shape: Sphere(radius: Value(\"size\", 1)), rotation: \
                    (0, Value(\"turn\", 30), 0))], source: Source(position: (9, 9, 9)), listener: \
                    Listener(position: (-9, 9, 9), radius: 1))";

/// A scene with all settings of materials, air, sources and listeners.
const SOUND: &str = "Scene(surfaces: [Surface(shape: Room(size: (9, 4, 7)), material: \"brick\", walls: \
                     (floor: \"mat\", back: \"curtain\")), Surface(shape: Sphere(radius: 1), material: \
                     \"mat\")], materials: {\"mat\": Material(absorption: [0.1, 0.2, 0.3, 0.4, 0.5, \
                     0.6, 0.7, 0.8], scattering: 0.1)}, air: Air(temperature: 10, humidity: 70, pressure: \
                     99), sources: [Source(name: \"a\", position: (3, 0, 0), level_db: -6, yaw: 30, \
                     directivity: FirstOrder(0.5)), Source(directivity: Cardioid, path: \
                     [Key(time: 0, position: (0, 1, 3)), Key(time: 3, position: (0, 1, 2))])], listeners: \
                     [Listener(name: \"b\", position: (0, 0, 3), radius: 0.1), Listener(radius: 0.2, \
                     position: (0, 1, 3))])";

/// Files whose base is a file in the same folder, a built-in scene, or the file itself.
const SMALL: [&str; 4] = [
    "Scene(base: \"base.ron\", name: \"small\", source: Source(position: (1, 2, 3)), listener: \
     Listener(position: (4, 5, 6), yaw: 30, pitch: 5, radius: 2), values: [Value(\"size\", 2), \
     Value(\"turn\", 60)])",
    "Scene(base: \"corner\", listener: Listener(path: [Key(time: 0, position: (9, 9, 9))]))",
    "Scene(base: \"scene.ron\", values: [])",
    "Scene(base: \"base.ron\", materials: {\"brick\": Material(absorption: 0.5)}, air: \
     Air(humidity: 20), sources: [Source(level_db: 3), Source(name: \"b\")], listener: \
     Listener(name: \"c\"))",
];

fn corpus() -> Vec<Vec<u8>> {
    let built_in = Scene::BUILTIN_NAMES
        .iter()
        .filter_map(|name| Scene::builtin_text(name));
    let made = SHAPES.iter().map(|shape| {
        format!(
            "Scene(name: \"made\", surfaces: [Surface(name: \"one\", shape: {shape}, position: \
             (0, Keys([(0, 1), (1, 2), (3, 0)]), 0), rotation: (0, Value(\"turn\", 30), 0))], \
             source: Source(path: [Key(time: 0, position: (9, 9, 9)), Key(time: 2, position: \
             (9, 8, 9))]), listener: Listener(position: (-9, 9, 9), yaw: 30, radius: 1))"
        )
    });
    built_in
        .map(str::to_owned)
        .chain(made)
        .chain(SMALL.map(str::to_owned))
        .chain([SOUND.to_owned()])
        .map(String::into_bytes)
        .collect()
}

/// Returns the target for scene files.
pub fn target() -> Target {
    Target {
        name: "scene",
        corpus: corpus(),
        tokens: TOKENS,
        one,
    }
}

/// Reads a scene file, and another file that is based on it. Writes the scene, selects pairs, sets named values, and
/// computes states at several times, warnings and distances.
pub fn one(data: &[u8]) {
    with_file("base.ron", BASE.as_bytes(), |_| ());
    let small = b"Scene(base: \"scene.ron\", source: Source(position: (1, 2, 3)))";
    with_file("small.ron", small, |_| ());
    with_file("scene.ron", data, |path| {
        let small = Scene::from_file(&path.with_file_name("small.ron"));
        if let Err(error) = small {
            drop(error.to_string());
        }
        let mut scene = match Scene::from_file(path) {
            Ok(scene) => scene,
            Err(error) => return drop(error.to_string()),
        };
        drop(ron::to_string(&scene));
        let losses = scene.air_attenuation();
        assert!(losses.iter().all(|m| m.is_finite()) && scene.speed_of_sound() > 0.0);
        for source in 0..scene.sources.len() {
            scene.pair(source, scene.listeners.len() - 1).unwrap();
        }
        for name in scene.value_names() {
            let _ = scene.set_value(&name, 0.5);
        }
        for seconds in [0.0, 0.5 * scene.duration(), 1e9] {
            let posed = scene.at(seconds);
            if posed.validate().is_ok() {
                let _ = posed.warnings();
                let pair = posed.pair(0, 0).unwrap();
                let _ = pair.distance(echomarch::glam::Vec3::splat(0.25));
            }
        }
    });
}

//! Materials, air, sources and listeners in scene files.

use crate::common::Random;
use echomarch::scene::shape::{Room, Sphere};
use echomarch::scene::{Air, Directivity, Key, Material, Path, Transmission};
use echomarch::{Listener, Scene, Source, Surface};
use glam::Vec3;

/// A scene with all settings of materials, air, sources and listeners.
const HALL: &str = r#"Scene(
    surfaces: [
        Surface(shape: Room(size: (9, 4, 7)), material: "brick", walls: (floor: "mat", back: "curtain")),
        Surface(shape: Sphere(radius: 1), position: (1, 0, 2), material: "mat"),
        Surface(shape: Sphere(radius: 0.5), position: (-3, 0, 0)),
    ],
    materials: {
        "mat": Material(absorption: 0.03, scattering: [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1]),
        "brick": Material(absorption: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]),
    },
    air: Air(temperature: 10, humidity: 70),
    sources: [
        Source(name: "flute", position: (3, 0, 0), level_db: -6),
        Source(path: [Key(time: 0, position: (0, 1, 0)), Key(time: 3, position: (0, 1, 2), yaw: 90)],
            directivity: FirstOrder(0.3)),
    ],
    listeners: [
        Listener(name: "row 1", position: (0, 0, 3), radius: 0.1, yaw: 30),
        Listener(name: "row 2", position: (2, 0, 3), radius: 0.2),
    ],
)"#;

fn read(text: &str) -> Scene {
    Scene::from_ron(text, "text").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Protects the settings of the sound in a file: each field sets its number.
#[test]
fn everything_that_is_said_is_in_the_scene() {
    let scene = read(HALL);
    let mat = Material {
        scattering: [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1.0],
        ..Material::absorbing(0.03)
    };
    let brick = Material {
        absorption: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8],
        ..Material::MIRROR
    };
    let wall = |name| Room::WALL_NAMES.iter().position(|known| *known == name);
    assert_eq!(scene.material(0, None), Some(brick));
    assert_eq!(scene.material(0, wall("left")), Some(brick));
    assert_eq!(scene.material(0, wall("floor")), Some(mat));
    let curtain = Material::builtin("curtain").copied();
    assert_eq!(scene.material(0, wall("back")), curtain);
    assert_eq!(scene.material(1, None), Some(mat));
    assert_eq!(scene.material(2, None), None);
    let air = Air {
        temperature: 10.0,
        humidity: 70.0,
        pressure: 101.325,
    };
    assert_eq!(scene.air, Some(air));
    let sources: Vec<&Source> = scene.sources.iter().collect();
    assert_eq!(sources[0].name.as_deref(), Some("flute"));
    assert_eq!((sources[0].position.x, sources[0].level_db), (3.0, -6.0));
    assert_eq!(
        (sources[1].name.as_deref(), sources[1].level_db),
        (None, 0.0)
    );
    assert_eq!((sources[1].position, scene.duration()), (Vec3::Y, 3.0));
    let directed = Directivity::first_order(0.3);
    assert_eq!(
        [&sources[0].directivity, &sources[1].directivity],
        [&Directivity::Omnidirectional, &directed]
    );
    assert_eq!(scene.at(1.5).sources[1].yaw, 45f32.to_radians());
    let radii: Vec<f32> = scene
        .listeners
        .iter()
        .map(|listener| listener.radius)
        .collect();
    assert_eq!(radii, [0.1, 0.2]);
    assert_eq!(scene.listeners[0].yaw, 30f32.to_radians());
}

/// Protects the two notations: a list of one source or listener is equivalent to a single source or listener.
#[test]
fn a_list_of_one_is_the_short_form() {
    let short = "Scene(surfaces: [Surface(shape: Plane)], source: Source(position: (0, 1, 0)), \
                 listener: Listener(position: (0, 2, 0), radius: 0.5))";
    let long = short
        .replace(
            "source: Source(position: (0, 1, 0))",
            "sources: [(position: (0, 1, 0))]",
        )
        .replace(
            "listener: Listener(position: (0, 2, 0), radius: 0.5)",
            "listeners: [(position: (0, 2, 0), radius: 0.5)]",
        );
    assert_eq!(read(short), read(&long));
    assert_eq!(read(short).air, None);
    assert!(!read(short).has_materials());
}

/// Protects the authors of scenes: an error states the line, the column and the mistake.
#[test]
fn bad_sound_is_refused_at_its_place() {
    let cases = [
        // Coefficients.
        (
            "absorption: 0.03",
            "absorption: 1.5",
            "8:37: an absorption must be 0 to 1, not 1.5",
        ),
        (
            "absorption: 0.03",
            "absorption: -1",
            "8:38: an absorption must be 0 to 1, not -1",
        ),
        (
            "0.5, 0.6, 1]",
            "0.5, NaN, 1]",
            "8:84: a scattering must be 0 to 1, not NaN",
        ),
        (
            "0.7, 0.8]",
            "0.7]",
            "9:73: an absorption is one number or eight",
        ),
        (
            "0.7, 0.8]",
            "0.7, 0.8, 0.9]",
            "9:83: an absorption is one number or eight",
        ),
        (
            "absorption: 0.03",
            "absorption: \"much\"",
            "8:38: Expected an absorption as a number",
        ),
        (
            "scattering",
            "scatering",
            "8:43: there is no field `scatering` in `Material`",
        ),
        // Names.
        (
            "material: \"mat\"",
            "material: \"matt\"",
            "4:74: there is no material \"matt\"; did you mean mat?",
        ),
        (
            "floor: \"mat\"",
            "floor: \"carpt\"",
            "3:81: there is no material \"carpt\"; did you mean carpet?",
        ),
        (
            "back: \"curtain\"",
            "back: \"gold\"",
            "3:94: there is no material \"gold\"; there are brick, mat, audience, carpet",
        ),
        (
            "floor: ",
            "flor: ",
            "3:74: there is no field `flor` in `Walls`",
        ),
        (
            "(1, 0, 2), material: \"mat\"",
            "(1, 0, 2), walls: (front: \"mat\")",
            "4:79: only the walls of a Room or of Rooms have materials of their own",
        ),
        (
            "\"brick\": Material",
            "\"mat\": Material",
            "9:10: the material \"mat\" is defined twice",
        ),
        (
            "\"mat\": Material",
            "\"\": Material",
            "8:10: a material needs a name",
        ),
        // Air.
        (
            "temperature: 10",
            "temperature: 60",
            "11:27: the air's temperature must be -20 to 50 °C, not 60",
        ),
        (
            "humidity: 70",
            "humidity: 101",
            "11:41: the air's humidity must be 0 to 100 %, not 101",
        ),
        (
            "humidity: 70",
            "pressure: 20",
            "11:41: the air's pressure must be 50 to 200 kPa, not 20",
        ),
        // Sources and listeners.
        (
            "level_db: -6",
            "level_db: 200",
            "13:62: a level in decibels must be -120 to 120, not 200",
        ),
        (
            "\"row 2\"",
            "\"row 1\"",
            "19:67: two of the listeners are called \"row 1\"",
        ),
        (
            "air: Air",
            "source: Source(), air: Air",
            "12:14: a scene has source or sources, not both",
        ),
        (
            "air: Air",
            "listener: (radius: 1), air: Air",
            "17:16: a scene has listener or listeners, not both",
        ),
    ];
    for (text, with, told) in cases {
        let spoilt = HALL.replacen(text, with, 1);
        assert_ne!(spoilt, HALL, "{text}");
        let said = Scene::from_ron(&spoilt, "text")
            .expect_err(with)
            .to_string();
        assert!(said.starts_with(&format!("text:{told}")), "{with}: {said}");
        assert!(!said.contains('\n'), "{said}");
    }
}

/// Protects authors who mistype a directivity: the error states the line and the problem.
#[test]
fn bad_directivities_have_a_line() {
    for (directivity, told) in [
        (
            "FirstOrder(1.5)",
            "an omnidirectional share must be 0 to 1, not 1.5",
        ),
        (
            "FirstOrder([0.5, 0.5])",
            "an omnidirectional share is one number or eight (octave bands 63 Hz to 8 kHz), not 2",
        ),
        ("Cardoid", "Cardoid"),
        ("Balloon(path: \"a.sofa\")", "path"),
    ] {
        let spoilt = HALL.replacen("FirstOrder(0.3)", directivity, 1);
        assert_ne!(spoilt, HALL);
        let said = Scene::from_ron(&spoilt, "text").expect_err(directivity);
        let said = said.to_string();
        assert!(
            said.starts_with("text:15:") && said.contains(told),
            "{said}"
        );
        assert!(!said.contains('\n'), "{said}");
    }
}

/// Protects authors who omit the source or the listener: the error states what is missing, and its notation.
#[test]
fn a_scene_needs_a_source_and_a_listener() {
    let surfaces = "surfaces: [Surface(shape: Plane)]";
    let cases = [
        (
            "listener: Listener(radius: 1)",
            "a scene needs source: Source(…), or several as sources: [Source(…), …]",
        ),
        (
            "source: Source()",
            "a scene needs listener: Listener(…), or several as listeners: [Listener(…), …]",
        ),
        (
            "sources: [], listener: Listener(radius: 1)",
            "sources need at least one",
        ),
    ];
    for (one, told) in cases {
        let text = format!("Scene({surfaces},\n{one})\n// The end.");
        let said = Scene::from_ron(&text, "text").unwrap_err().to_string();
        assert!(
            said.starts_with("text:2:") && said.ends_with(told),
            "{said}"
        );
    }
}

/// Protects from a file that occupies the program for very long, because every pair of source and listener is checked.
#[test]
fn a_scene_has_so_many_sources_and_listeners_at_the_most() {
    let read = |count: usize| {
        let sources = "Source(),".repeat(count);
        let listeners = "(radius: 1, position: (5, 0, 0)),".repeat(count);
        let text = format!(
            "Scene(surfaces: [Surface(shape: Plane)],\nsources: [{sources}],\nlisteners: [{listeners}])"
        );
        Scene::from_ron(&text, "text").map_err(|error| error.to_string())
    };
    assert_eq!(read(256).unwrap().listeners.len(), 256);
    let said = read(257).unwrap_err();
    assert!(said.starts_with("text:2:"), "{said}");
    assert!(said.ends_with("a scene has at most 256 sources"), "{said}");
}

/// Protects the rule of a base for the sound: the settings in the file replace those of the base, and all others come
/// from the base.
#[test]
fn sound_of_a_base_stays_unless_it_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("hall.ron"), HALL).unwrap();
    let hall = Scene::from_file(&path("hall.ron")).unwrap();
    let changed = |said: &str| {
        let text = format!("Scene(base: \"hall.ron\",\n{said})");
        std::fs::write(path("small.ron"), text).unwrap();
        let small = Scene::from_file(&path("small.ron"));
        small.map_err(|error| error.to_string().replace(path("").to_str().unwrap(), ""))
    };
    assert_eq!(changed("").unwrap(), hall);

    let mut expected = hall.clone();
    expected
        .materials
        .insert("mat".into(), Material::absorbing(0.5));
    expected.air = Some(Air {
        humidity: 20.0,
        ..hall.air.unwrap()
    });
    expected.sources[0].level_db = 3.0;
    expected.listeners[0].name = Some("seat".into());
    let said = "materials: {\"mat\": Material(absorption: 0.5)}, air: Air(humidity: 20), \
                source: Source(level_db: 3), listener: Listener(name: \"seat\")";
    assert_eq!(changed(said).unwrap(), expected);

    let alone = changed("sources: [Source(position: (0, 1, 0))]").unwrap();
    assert_eq!(alone.sources.len(), 1);
    assert_eq!(
        (alone.sources[0].position, &alone.sources[0].name),
        (Vec3::Y, &None)
    );
    assert_eq!(alone.listeners.len(), 2);

    for (said, told) in [
        (
            "listener: Listener(name: \"row 2\")",
            "small.ron:2:11: two of the listeners are called \"row 2\"",
        ),
        (
            "source: Source(level_db: 3), sources: [Source()]",
            "small.ron:2:39: a scene has source or sources, not both",
        ),
        (
            "materials: {\"mat\": Material(absorption: 5)}",
            "small.ron:2:41: an absorption must be",
        ),
        (
            "sources: [Source(name: \"a\"), Source(name: \"a\")]",
            "small.ron:2:",
        ),
    ] {
        let said = changed(said).unwrap_err();
        assert!(said.starts_with(told), "{said}");
    }
}

/// Draws a number from 0 to 1 with three decimals, which every format reproduces exactly.
fn share(random: &mut Random) -> f64 {
    (1000.0 * random.unit()).round() / 1000.0
}

/// Draws a random scene with materials, air, sources and listeners.
fn drawn(random: &mut Random) -> Scene {
    let shares = |random: &mut Random| match random.unit() < 0.3 {
        true => [share(random); 8],
        false => std::array::from_fn(|_| share(random)),
    };
    let transmission = |random: &mut Random| match random.unit() {
        kind if kind < 0.3 => None,
        kind if kind < 0.6 => Some(Transmission::of_density(1.0 + 9e3 * share(random))),
        _ => Some(Transmission::reduced_by(shares(random), 0.1)),
    };
    let mut names: Vec<String> = Material::BUILTIN
        .iter()
        .map(|m| m.name.to_owned())
        .collect();
    let mut materials = std::collections::BTreeMap::new();
    for index in 0..(4.0 * random.unit()) as u32 {
        let name = format!("own \"{index}\" ünlike");
        let material = Material {
            absorption: shares(random),
            scattering: shares(random),
            transmission: transmission(random),
        };
        names.push(name.clone());
        materials.insert(name, material);
    }
    let name = |random: &mut Random| {
        let drawn = (names.len() as f64 * random.unit()) as usize;
        (random.unit() < 0.6).then(|| names[drawn].clone())
    };
    let mut room = Surface::new(Room {
        size: Vec3::splat(90.0),
    });
    room.material = name(random);
    room.walls = std::array::from_fn(|_| name(random));
    let mut ball = Surface::new(Sphere { radius: 1.0 });
    ball.material = name(random);
    let place = |random: &mut Random| (9.0 * random.unit() * random.direction()).as_vec3();
    let path = |random: &mut Random| {
        let key = |index: i32, random: &mut Random| Key {
            time: f64::from(index) + (500.0 * random.unit()).round() / 1024.0,
            position: place(random),
            yaw: (9.0 * random.unit()) as f32,
            pitch: random.unit() as f32,
        };
        let count = (3.0 * random.unit()) as i32;
        Path::new((0..count).map(|index| key(index, random)).collect()).unwrap()
    };
    let source = |index: i32, random: &mut Random| {
        let mut source = Source::at(place(random));
        source.name = (random.unit() < 0.5).then(|| format!("source {index}"));
        source.level_db = (240.0 * random.unit() - 120.0) as f32;
        source.yaw = (9.0 * random.unit()) as f32;
        source.pitch = random.unit() as f32;
        source.directivity = match random.unit() < 0.5 {
            true => Directivity::first_order(share(random)),
            false => Directivity::Omnidirectional,
        };
        source.path = path(random);
        source
    };
    let listener = |index: i32, random: &mut Random| {
        let mut listener = Listener::at(place(random), 0.1 + random.unit() as f32);
        listener.name = (random.unit() < 0.5).then(|| format!("listener {index}"));
        listener.yaw = (9.0 * random.unit()) as f32;
        listener.pitch = random.unit() as f32;
        listener.path = path(random);
        listener
    };
    let mut scene = Scene::new(
        "drawn",
        vec![room, ball],
        source(0, random),
        listener(0, random),
    );
    scene.materials = materials;
    scene.air = (random.unit() < 0.5).then(|| Air {
        temperature: -share(random),
        humidity: share(random),
        pressure: 100.0 + (1024.0 * random.unit()).round() / 1024.0,
    });
    let count = |random: &mut Random| 1 + (3.0 * random.unit()) as i32;
    let sources = (1..count(random)).map(|i| source(i, random));
    scene.sources.extend(sources);
    let listeners = (1..count(random)).map(|i| listener(i, random));
    scene.listeners.extend(listeners);
    scene
}

/// Returns the scene with all angles set to 0. Files store angles in degrees, so that only angles are not bit-identical
/// after reading.
fn without_angles(mut scene: Scene) -> Scene {
    for listener in &mut scene.listeners {
        (listener.yaw, listener.pitch) = (0.0, 0.0);
        let keys = listener.path.keys().iter().map(|key| Key {
            yaw: 0.0,
            pitch: 0.0,
            ..*key
        });
        listener.path = Path::new(keys.collect()).unwrap();
    }
    for source in &mut scene.sources {
        (source.yaw, source.pitch) = (0.0, 0.0);
        let keys = source.path.keys().iter().map(|key| Key {
            yaw: 0.0,
            pitch: 0.0,
            ..*key
        });
        source.path = Path::new(keys.collect()).unwrap();
    }
    scene
}

/// Protects saved scenes: random scenes that are written in RON and in JSON are read without changes.
#[test]
fn a_scene_is_read_as_it_was_written() {
    for seed in 0..200 {
        let scene = drawn(&mut Random(seed));
        let ron = ron::to_string(&scene).unwrap();
        let json = serde_json::to_string(&scene).unwrap();
        let from_json: Scene =
            serde_json::from_str(&json).unwrap_or_else(|e| panic!("{e}\n{json}"));
        for read in [read(&ron), from_json] {
            // The difference is at most one rounding error of the conversion to degrees. All angles are at most 9.
            let pairs = read.listeners.iter().zip(&scene.listeners);
            let turned = pairs.map(|(a, b)| (a.yaw - b.yaw).abs().max((a.pitch - b.pitch).abs()));
            assert!(
                turned.fold(0.0, f32::max) <= 9.0 * f32::EPSILON,
                "seed {seed}"
            );
            let same = without_angles(read) == without_angles(scene.clone());
            assert!(same, "seed {seed}: {ron}");
        }
    }
}

/// The scattering of all bands of two materials: one of the scene, and a built-in one.
fn scatterings(scene: &Scene) -> [f64; 2] {
    ["own", "brick"].map(|name| {
        let material = scene.material_named(name);
        let material = material.unwrap_or_else(|| panic!("{name}"));
        assert_eq!(material.scattering, [material.scattering[0]; 8], "{name}");
        material.scattering[0]
    })
}

/// Protects the scattering of a scene: built-in materials and materials that state none have it, a stated one is kept,
/// also 0, and a scene based on another replaces it in the whole chain.
#[test]
fn the_scattering_of_a_scene_is_that_of_materials_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |fields: &str, own: &str| {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Plane, material: \"own\")], materials: {{\"own\": Material({own})}},
            {fields} source: Source(position: (0, 1, 0)),
            listener: Listener(position: (5, 2, 0), radius: 1))"
        );
        std::fs::write(folder.path().join("base.ron"), &text).unwrap();
        read(&text)
    };
    let based = |text: &str| Scene::from_ron_in(text, "based", folder.path());
    assert_eq!(scatterings(&scene("", "absorption: 0.2")), [0.0, 0.0]);
    for (own, expected) in [
        ("absorption: 0.2", [0.1, 0.3, 0.4]),
        ("base: \"glass\"", [0.1, 0.3, 0.4]),
        ("scattering: 0", [0.0; 3]),
        ("scattering: 0.25", [0.25; 3]),
    ] {
        let written = scene("scattering: 0.1,", own);
        assert_eq!(scatterings(&written), [expected[0], 0.1], "{own}");
        let again = read(&ron::to_string(&written).unwrap());
        assert_eq!(scatterings(&again), scatterings(&written), "{own}");
        let louder = "Scene(base: \"base.ron\", scattering: 0.3)";
        std::fs::write(folder.path().join("louder.ron"), louder).unwrap();
        let rough = based(louder).unwrap();
        assert_eq!(scatterings(&rough), [expected[1], 0.3], "{own}");
        let kept = based("Scene(base: \"louder.ron\")").unwrap();
        assert_eq!(scatterings(&kept), [expected[1], 0.3], "{own}");
        let rougher = based("Scene(base: \"louder.ron\", scattering: 0.4)").unwrap();
        assert_eq!(scatterings(&rougher), [expected[2], 0.4], "{own}");
        let added = "Scene(base: \"louder.ron\", materials: {\"own\": Material(absorption: 0.9)})";
        assert_eq!(scatterings(&based(added).unwrap()), [0.3, 0.3]);
    }
    let built_in = based("Scene(base: \"glasshouse\", scattering: 0.2)").unwrap();
    assert_eq!(built_in.scattering, [0.2; 8]);
    let brick = built_in.material_named("brick").unwrap();
    assert_eq!(brick.scattering, [0.2; 8]);
}

/// Protects the messages for wrong scatterings of a scene, in a file and in Rust.
#[test]
fn a_wrong_scattering_of_a_scene_is_refused() {
    let corner = |scattering: &str| {
        let text = format!("Scene(base: \"corner\", scattering: {scattering})");
        Scene::from_ron(&text, "text").unwrap_err().to_string()
    };
    for (scattering, why) in [
        ("1.5", "a scattering must be 0 to 1, not 1.5"),
        ("[0.1, 0.2]", "a scattering is one number or eight"),
        ("\"much\"", "a scattering as a number from 0 to 1"),
    ] {
        let refused = corner(scattering);
        assert!(refused.contains(why), "{refused}");
    }
    let mut scene = Scene::builtin("corner").unwrap();
    scene.scattering[7] = -0.1;
    let refused = scene.check().unwrap_err().to_string();
    assert!(
        refused.contains("the scattering of the scene must be 0 to 1, not -0.1"),
        "{refused}"
    );
}

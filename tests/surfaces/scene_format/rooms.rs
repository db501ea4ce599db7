//! Rooms in scene files: their notation, their materials and warnings.

use echomarch::Scene;
use echomarch::scene::{Material, Warning};

/// Two rooms with a doorway. `more` stands after the shape, and `between` in place of the doorway.
fn flat(between: &str, more: &str) -> String {
    format!(
        r#"Scene(
            surfaces: [Surface(
                shape: Rooms(of: [
                    (name: "kitchen", from: (0, 0, 0), to: (4, 2.6, 3)),
                    {between}
                    (name: "hall", from: (4.2, 0, 0), to: (6, 2.6, 7)),
                ]),
                material: "plaster",
                {more}
            )],
            source: Source(position: (1, 1, 1)),
            listener: Listener(position: (5, 1, 5), radius: 0.2),
        )"#
    )
}

const DOOR: &str = "(from: (4, 0, 1), to: (4.2, 2.1, 1.9)),";

fn read(text: &str) -> Scene {
    Scene::from_ron(text, "text").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Protects saved scenes: rooms are written as they are read.
#[test]
fn rooms_are_written_as_they_are_read() {
    let scene = read(&flat(
        DOOR,
        r#"faces: {"hall": "marble"}, walls: (floor: "carpet")"#,
    ));
    let text = ron::to_string(&scene).expect("a valid scene");
    assert_eq!(read(&text), scene);
    assert_eq!(scene.files(), [""; 0].map(std::path::PathBuf::from));
    assert_eq!(scene.warnings(), vec![]);
}

/// Protects the materials of rooms: that of a wall of a box precedes that of the box, that of the same wall of all boxes,
/// and that of the surface.
#[test]
fn boxes_and_their_walls_have_materials() {
    let more = r#"faces: {"hall": "marble", "hall/floor": "carpet"}, walls: (floor: "wood-floor")"#;
    let scene = read(&flat(DOOR, more));
    let surface = &scene.surfaces[0];
    let of = |name: &str| {
        let part = (0..18).find(|part| surface.part_name(*part) == Some(name));
        scene.material(0, Some(part.expect("a wall")))
    };
    for (wall, material) in [
        ("hall/floor", "carpet"),
        ("hall/left", "marble"),
        ("kitchen/floor", "wood-floor"),
        ("kitchen/back", "plaster"),
        ("2/floor", "wood-floor"),
        ("2/ceiling", "plaster"),
    ] {
        assert_eq!(of(wall), Material::builtin(material).copied(), "{wall}");
    }
}

/// Protects users from silent mistakes in rooms: an unknown box, a wall without faces, and corners in the wrong order are
/// refused.
#[test]
fn mistakes_in_rooms_are_refused() {
    let swapped = "(from: (4.2, 0, 1), to: (4, 2.1, 1.9)),";
    for (between, more, said) in [
        (DOOR, r#"faces: {"hal": "marble"}"#, "did you mean hall?"),
        (
            DOOR,
            r#"faces: {"2/left": "marble"}"#,
            "the wall \"2/left\" of the rooms is open to other boxes",
        ),
        (DOOR, r#"faces: {"hall": "marbel"}"#, "did you mean marble?"),
        (swapped, "", "with `from` less than `to` along each axis"),
        ("(from: (4, 0, 1)),", "", "`to`"),
        (
            "(name: \"hall\", from: (4, 0, 1), to: (4.2, 2, 2)),",
            "",
            "must be different",
        ),
    ] {
        let text = flat(between, more);
        let refused = Scene::from_ron(&text, "text").expect_err(&text).to_string();
        assert!(refused.contains(said), "{refused}");
    }
}

/// Protects users from rooms that they expect to be joined: a gap between boxes is a wall, and a warning names the box
/// behind it.
#[test]
fn rooms_without_a_doorway_are_told() {
    let warnings = read(&flat("", "")).warnings();
    let [Warning::RoomsApart { rooms, .. }] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    assert_eq!(rooms, &["hall"]);
    let said = warnings[0].to_string();
    assert!(said.contains("hall has no way to the first box"), "{said}");
}

/// Protects readers of untrusted files from memory: the boxes of all Rooms of a scene are limited together.
#[test]
fn many_large_rooms_are_refused() {
    let boxes: String = (0..42)
        .map(|x| format!("(from: ({x}, 0, 0), to: ({}, 1, 1)),", x + 1))
        .collect();
    let surface = format!("Surface(shape: Rooms(of: [{boxes}])),");
    let text = format!(
        "Scene(surfaces: [{}], source: Source(position: (0.5, 0.5, 0.5)), \
         listener: Listener(position: (3, 0.5, 0.5), radius: 0.1))",
        surface.repeat(8)
    );
    let refused = Scene::from_ron(&text, "text")
        .expect_err("too many")
        .to_string();
    assert!(refused.contains("too many boxes"), "{refused}");
}

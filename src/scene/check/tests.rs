//! Scenes that are rejected, and scenes with warnings.

use super::*;
use crate::scene::shape::{AirBox, Cuboid, Grid, Plane, Room, Rooms, Shape, Sphere};
use crate::scene::{Air, Key, Node, SampledField, Warning};
use glam::{Quat, UVec3};
use std::sync::Arc;

fn room() -> Scene {
    Scene::new(
        "test",
        vec![Surface::new(Node::Room(Room {
            size: Vec3::splat(10.0),
        }))],
        Source::at(Vec3::X * 3.0),
        Listener::at(Vec3::ZERO, 1.0),
    )
}

/// Protects shaders from invalid numbers: the scene is rejected.
#[test]
fn bad_numbers_are_refused() {
    assert!(room().validate().is_ok());
    let spoil: [fn(&mut Scene); 7] = [
        |s| s.surfaces.clear(),
        |s| {
            let size = Vec3::new(1.0, 0.0, 1.0);
            s.surfaces[0].shape = Node::Cuboid(Cuboid { size }).into();
        },
        |s| s.surfaces[0].shape = Node::Sphere(Sphere { radius: f32::NAN }).into(),
        |s| s.surfaces[0].position.x = f32::INFINITY,
        |s| s.sources[0].position.y = f32::NAN,
        |s| s.listeners[0].radius = 0.0,
        |s| s.listeners[0].yaw = f32::INFINITY,
    ];
    for (index, spoil) in spoil.iter().enumerate() {
        let mut scene = room();
        spoil(&mut scene);
        assert!(scene.validate().is_err(), "case {index}");
    }
}

fn hall() -> Scene {
    let room = Surface::new(Room {
        size: Vec3::splat(9.0),
    });
    let (source, listener) = (Source::at(Vec3::X), Listener::at(Vec3::Y, 0.3));
    let mut scene = Scene::new("hall", vec![room.with_material("own")], source, listener);
    let own = Material::absorbing(0.5);
    scene.materials.insert("own".into(), own);
    scene.sources.push(Source::at(Vec3::Z));
    scene.listeners.push(Listener::at(-Vec3::Z, 0.3));
    scene.air = Some(Air::default());
    scene
}

/// Protects the names in messages: a single source or listener has no number, one of several has a number.
#[test]
fn one_of_several_is_called_by_its_number() {
    let mut scene = hall();
    scene.listeners[1].name = Some("seat".to_owned());
    let labels = |scene: &Scene| [scene.source_label(0), scene.listener_label(0)];
    assert_eq!(labels(&scene), ["source 1", "listener 1"]);
    assert_eq!(scene.listener_label(1), "listener 2 (seat)");
    scene.sources.pop();
    scene.listeners.pop();
    assert_eq!(labels(&scene), ["the source", "the listener"]);
}

/// Protects the meaning of numbers: no name may equal the number of an unnamed source or listener.
#[test]
fn no_name_is_the_number_of_another() {
    let named = |first: Option<&str>, second: Option<&str>| {
        let mut scene = hall();
        scene.sources[0].name = first.map(str::to_owned);
        scene.sources[1].name = second.map(str::to_owned);
        scene.validate().map_err(|refused| refused.to_string())
    };
    for (first, second) in [(Some("2"), None), (None, Some("1"))] {
        let told = named(first, second).unwrap_err();
        assert!(told.contains("one of the sources is called"), "{told}");
    }
    for (first, second) in [
        (Some("1"), None),
        (Some("2"), Some("1")),
        (Some("3"), None),
        (None, Some("flute")),
    ] {
        assert_eq!(named(first, second), Ok(()), "{first:?}, {second:?}");
    }
}

/// Protects the names in messages about invalid coefficients, air and sources.
#[test]
fn bad_sound_is_refused_by_its_name() {
    hall().validate().unwrap();
    type Spoil = fn(&mut Scene);
    let cases: [(Spoil, &str); 18] = [
        (
            |s| s.sources = vec![Source::at(Vec3::Z); 257],
            "the number of its sources must be at most 256, not 257",
        ),
        (
            |s| s.sources[1].position.x = f32::NAN,
            "source 2's position must be finite",
        ),
        (
            |s| s.sources[0].level_db = 121.0,
            "source 1's level in decibels must be -120 to 120, not 121",
        ),
        (
            |s| s.listeners[1].radius = 0.0,
            "listener 2's radius in metres must be greater than 0",
        ),
        (
            |s| {
                s.air = Some(Air {
                    temperature: 60.0,
                    ..Air::default()
                })
            },
            "the air's temperature in degrees Celsius must be -20 to 50, not 60",
        ),
        (
            |s| {
                s.air = Some(Air {
                    humidity: f64::NAN,
                    ..Air::default()
                })
            },
            "the air's humidity in per cent must be 0 to 100, not NaN",
        ),
        (
            |s| {
                s.air = Some(Air {
                    pressure: 0.0,
                    ..Air::default()
                })
            },
            "the air's pressure in kilopascals must be 50 to 200, not 0",
        ),
        (
            |s| {
                s.materials.insert("own".into(), Material::absorbing(1.5));
            },
            "the absorption of the material \"own\" must be 0 to 1, not 1.5",
        ),
        (
            |s| {
                let scatters = Material::MIRROR.scattering_by(f64::NAN);
                s.materials.insert("own".into(), scatters);
            },
            "the scattering of the material \"own\" must be 0 to 1, not NaN",
        ),
        (
            |s| {
                let mut shares = [0.25_f32; 8];
                shares[6] = -0.5;
                s.materials
                    .insert("own".into(), Material::absorbing(shares));
            },
            "the absorption of the material \"own\" must be 0 to 1, not -0.5",
        ),
        (
            |s| {
                let stated = Transmission::reduced_by(201.0, 0.1);
                let bad = Material::MIRROR.transmitting(stated);
                s.materials.insert("own".into(), bad);
            },
            "the reduction in decibels of the material \"own\" must be 0 to 200, not 201",
        ),
        (
            |s| {
                let stated = Transmission::reduced_by(35.0, 0.0);
                let bad = Material::MIRROR.transmitting(stated);
                s.materials.insert("own".into(), bad);
            },
            "the thickness in metres of the material \"own\" must be 0.00001 to 100, not 0",
        ),
        (
            |s| {
                let weightless = Transmission::of_density(f64::NAN);
                let bad = Material::MIRROR.transmitting(weightless);
                s.materials.insert("own".into(), bad);
            },
            "the density in kg/m³ of the material \"own\" must be 1 to 25000, not NaN",
        ),
        (
            |s| {
                let stiff = Transmission::Mass {
                    density: 1800.0,
                    coincidence: Some(-20.0),
                };
                let bad = Material::MIRROR.transmitting(stiff);
                s.materials.insert("own".into(), bad);
            },
            "the coincidence in m·Hz of the material \"own\" must be 1 to 1000, not -20",
        ),
        (
            |s| s.surfaces[0].material = Some("carpt".into()),
            "surface 1 (Room): there is no material \"carpt\"; did you mean carpet?",
        ),
        (
            |s| s.surfaces[0].walls[5] = Some("owm".into()),
            "there is no material \"owm\"; did you mean own?",
        ),
        (
            |s| {
                s.surfaces[0].shape = Sphere { radius: 20.0 }.into();
                s.surfaces[0].walls[2] = Some("own".into());
            },
            "surface 1 (Sphere): only the walls of a Room or of Rooms have materials of their own",
        ),
        (
            |s| {
                s.sources[0].name = Some("flute".into());
                s.sources[1].name = Some("flute".into());
            },
            "scene \"hall\": two of the sources are called \"flute\"",
        ),
    ];
    for (spoil, says) in cases {
        let mut scene = hall();
        spoil(&mut scene);
        let told = scene.validate().unwrap_err().to_string();
        assert!(told.contains(says), "{told}");
    }
}

/// Protects users from scenes with several rooms, in which the space outside each room is solid. The warning names both
/// rooms and the correct notation.
#[test]
fn rooms_that_fill_each_other_are_told() {
    let mut scene = room();
    scene
        .surfaces
        .push(scene.surfaces[0].clone().named("annexe"));
    let warnings = scene.warnings();
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    let said = warning.to_string();
    assert!(said.starts_with("surface 1 (Room), surface 2 (annexe) fill each other"));
    assert!(said.contains("as one surface, Rooms(of: [(from: (x, y, z)"));
}

/// Protects decays from surfaces that unintentionally reflect all sound: the warning names each surface and wall. A
/// scene without any material has no such warning.
#[test]
fn what_has_no_material_is_told() {
    let mut scene = room();
    assert_eq!(scene.warnings(), vec![]);
    let floored = scene.surfaces[0].clone().with_wall_material(2, "carpet");
    scene.surfaces[0] = floored.expect("a floor");
    let said = scene.warnings()[0].to_string();
    let expected = "1/left, 1/right, 1/ceiling, 1/front, 1/back have no material";
    assert!(said.starts_with(expected), "{said}");
    scene.surfaces[0] = scene.surfaces[0].clone().with_material("plaster");
    assert_eq!(scene.warnings(), vec![]);
    scene
        .surfaces
        .push(Surface::new(Sphere { radius: 0.1 }).at(Vec3::splat(4.0)));
    let said = scene.warnings()[0].to_string();
    assert!(
        said.starts_with("surface 2 (Sphere) has no material"),
        "{said}"
    );
}

/// Protects lengths in millimetres from being taken as metres. Shapes without an end are not rooms.
#[test]
fn rooms_in_millimetres_are_warned_of() {
    let told = |shape: Shape| {
        let (source, listener) = (Source::at(Vec3::ZERO), Listener::at(Vec3::ONE, 0.3));
        let warnings = Scene::new("s", vec![Surface::new(shape)], source, listener).warnings();
        let large = |warning: &Warning| matches!(warning, Warning::LargeRoom { .. });
        let large: Vec<Warning> = warnings.into_iter().filter(large).collect();
        large.first().map(ToString::to_string)
    };
    let room = |size: [f32; 3]| Shape::from(Room { size: size.into() });
    let hollow = |radius| Shape::from(Sphere { radius }).complement();
    let rooms = |to: [f32; 3]| {
        let only = AirBox {
            name: String::new(),
            from: Vec3::ZERO,
            to: to.into(),
        };
        Shape::from(Rooms::new([only]).unwrap())
    };
    assert_eq!(
        told(room([8e3, 3e3, 5e3])).unwrap(),
        "surface 1 (Room): it is 8000 m long: if its unit is not the metre, state its lengths in metres"
    );
    assert!(told(rooms([8e3, 3e3, 5e3])).is_some() && told(hollow(501.0)).is_some());
    // Centimetres.
    assert!(told(room([800.0, 250.0, 500.0])).is_some() && told(hollow(101.0)).is_some());
    assert_eq!(told(room([1e3, 3.0, 5.0])), None);
    assert_eq!(told(rooms([8.0, 3.0, 5.0])), None);
    assert_eq!(told(hollow(99.0)), None);
    assert_eq!(told(Shape::from(Plane)), None);
}

/// Protects humidities in per cent from being stated as shares, and densities in kg/m³ from g/cm³.
#[test]
fn odd_units_are_warned_of() {
    let told = |humidity: f64, density: f64| {
        let (source, listener) = (Source::at(Vec3::ZERO), Listener::at(Vec3::ONE, 0.3));
        let mut surface = Surface::new(Room {
            size: Vec3::splat(9.0),
        });
        surface.material = Some("concrete".to_owned());
        let mut scene = Scene::new("s", vec![surface], source, listener);
        let concrete = Material::absorbing(0.02).transmitting(Transmission::of_density(density));
        scene.materials.insert("concrete".to_owned(), concrete);
        scene.air = Some(Air {
            humidity,
            ..Air::default()
        });
        let warnings = scene.warnings();
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        told(0.55, 2.4),
        [
            "the air's humidity is 0.55 %: if it is a share, state it in per cent (55)",
            "the density of the material \"concrete\" is 2.4 kg/m³, less than that of most foams: if it is in g/cm³, multiply it by 1000"
        ]
    );
    assert!(told(50.0, 2400.0).is_empty() && told(0.0, 9.0).is_empty());
}

/// Protects the warnings: they name the surface, and the scene is not rejected.
#[test]
fn odd_places_are_warned_of() {
    let mut scene = room();
    assert_eq!(scene.warnings(), vec![]);
    scene.sources[0].position.x = 6.0;
    assert!(matches!(&scene.warnings()[..],
        [Warning::SourceInsideSurface { surface, depth, .. }] if surface == "the solid around surface 1 (Room)" && *depth == 1.0));
    // Inside both solids no wave arrives, so only the solid is reported.
    scene.listeners[0].position.x = 5.5;
    assert_eq!(scene.warnings().len(), 2);
    scene.listeners[0].position.x = 0.0;
    scene.sources[0].position.x = 0.5;
    assert!(matches!(
        scene.warnings()[..],
        [Warning::SourceInsideListener { .. }]
    ));
    assert!(scene.validate().is_ok());
}

/// Protects users from a grid with an inverted sign, or without a surface.
#[test]
fn a_grid_without_a_surface_is_warned_of() {
    let warned = |values: Vec<f32>| {
        let field = SampledField::new("far.npy", UVec3::splat(2), 1.0, values).unwrap();
        let grid = Surface::new(Grid {
            field: Arc::new(field),
        });
        let (source, listener) = (Source::at(Vec3::X * 9.0), Listener::at(Vec3::Y * 9.0, 0.3));
        let warnings = Scene::new("grid", vec![grid], source, listener).warnings();
        let texts = warnings.iter().map(ToString::to_string);
        texts.collect::<Vec<String>>()
    };
    for (value, side) in [(1.0, "air"), (-1.0, "solid"), (0.0, "solid")] {
        let warnings = warned(vec![value; 8]);
        let told = format!("far.npy is all {side}");
        let is_told = warnings.iter().filter(|warning| warning.contains(&told));
        assert_eq!(is_told.count(), 1, "{warnings:?}");
    }
    assert!(warned([[1.0; 4], [-1.0; 4]].concat()).is_empty());
}

/// The warnings about a room of 10 m with this further surface.
fn told_of(more: Surface) -> Vec<String> {
    let mut scene = room();
    scene.surfaces.push(more);
    let warnings = scene.warnings();
    warnings.iter().map(ToString::to_string).collect()
}

fn cuboid(size: impl Into<Vec3>, position: impl Into<Vec3>) -> Surface {
    let (size, position) = (size.into(), position.into());
    Surface::new(Cuboid { size }).at(position)
}

/// Protects users from furniture that was placed outside the room. What reaches into the air, or moves, is not reported.
#[test]
fn surfaces_outside_the_room_are_warned_of() {
    let told = |x: f32| told_of(cuboid([1.0, 2.0, 1.0], [x, 0.0, -4.0]));
    assert_eq!(
        told(8.0),
        [
            "surface 2 (Box) lies wholly in the solid around surface 1 (Room), and has no effect: move it into the air"
        ]
    );
    assert_eq!(
        (told(5.7).len(), told(5.4).len(), told(-1.0).len()),
        (1, 0, 0)
    );
    let mut door = cuboid([1.0, 2.0, 1.0], [8.0, 0.0, -4.0]);
    door.drivers.push(crate::scene::Driver {
        parameter: "position.x".to_owned(),
        motion: Motion::Keys(vec![(0.0, 8.0), (1.0, 4.0)]),
    });
    assert!(told_of(door).is_empty());
    let mut scene = room();
    scene.surfaces = vec![Surface::new(Plane), cuboid([1.0; 3], [0.0, -3.0, 0.0])];
    assert!(
        scene.warnings()[0]
            .to_string()
            .contains("lies wholly in surface 1 (Plane)")
    );
}

/// Protects users from furniture that was placed a little above the floor. Doors, what stands on something, and feet of a
/// usual height are not reported.
#[test]
fn hovering_furniture_is_warned_of() {
    let told = |gap: f32| told_of(cuboid([1.0; 3], [3.0, gap - 4.5, -3.0]));
    assert_eq!(
        told(0.02),
        [
            "surface 2 (Box) is 0.02 m above the floor of surface 1 (Room): if it should stand there, move it down by 0.02 m"
        ]
    );
    assert!(
        [0.0, -0.01, 0.0005, 0.05]
            .into_iter()
            .all(|gap| told(gap).is_empty())
    );
    let mut door = cuboid([0.9, 2.0, 0.04], [3.0, -3.98, -3.0]);
    assert!(told_of(door.clone()).is_empty());
    door.rotation = Quat::from_rotation_y(0.8);
    assert!(told_of(door).is_empty());
    let mut scene = room();
    scene
        .surfaces
        .push(cuboid([2.0, 0.02, 2.0], [3.0, -4.99, -3.0]));
    scene.surfaces.push(cuboid([1.0; 3], [3.0, -4.48, -3.0]));
    assert_eq!(scene.warnings(), vec![]);
}

/// Protects users from a room whose air and solid are exchanged, such as a field with a reversed sign.
#[test]
fn a_room_that_is_solid_is_warned_of() {
    let mut scene = room();
    scene.surfaces = vec![cuboid([10.0; 3], Vec3::ZERO)];
    let is_reversed = |scene: &Scene| {
        let warnings = scene.warnings();
        warnings.contains(&Warning::AllInSolid {
            surface: "surface 1 (Box)".to_owned(),
            is_half_space: false,
        })
    };
    assert!(is_reversed(&scene));
    scene.listeners[0].position.x = 6.0;
    assert!(!is_reversed(&scene));
    let mut outside = room();
    (
        outside.sources[0].position.x,
        outside.listeners[0].position.x,
    ) = (7.0, 8.0);
    assert!(
        outside
            .warnings()
            .iter()
            .all(|warning| !matches!(warning, Warning::AllInSolid { .. }))
    );
}

/// Protects users from misspelled numbers and values: the message names the similar one.
#[test]
fn a_misspelled_number_or_value_is_suggested() {
    let ball = Surface::new(Sphere { radius: 1.0 });
    let mut scene = hall();
    let driven = ball.driven("position.x", Motion::Named("door".to_owned()));
    scene.surfaces.push(driven);
    let refused = scene
        .set_value("dor", 1.0)
        .expect_err("an error")
        .to_string();
    assert!(
        refused.ends_with("it has: door; did you mean door?"),
        "{refused}"
    );
    scene.surfaces[1].drivers[0].parameter = "positon.x".to_owned();
    let refused = scene.check().expect_err("an error").to_string();
    assert!(refused.ends_with("; did you mean position.x?"), "{refused}");
    let refused = hall()
        .set_value("door", 1.0)
        .expect_err("an error")
        .to_string();
    assert!(refused.ends_with("; it has none"), "{refused}");
}

/// Protects users whose sources and listeners are below the ground from advice for rooms, and the other way round.
#[test]
fn advice_for_a_ground_differs_from_that_for_a_room() {
    let advice = |shape: &str| {
        let text = format!(
            "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: (0, -2, 0)), \
             listener: Listener(position: (1, -2, 0), radius: 0.1))"
        );
        let scene = Scene::from_ron(&text, "test").expect("a scene");
        let warnings = scene.warnings().into_iter();
        let texts: Vec<String> = warnings.map(|warning| warning.to_string()).collect();
        let mut all_in_solid = texts.iter().filter(|text| text.starts_with("all sources"));
        all_in_solid.next().expect("a warning").clone()
    };
    for ground in [
        "Plane",
        "HalfSpace(normal: (0.1, 1, 0))",
        "Translate(of: HalfSpace(normal: (0, -1, 0)), by: (0, -9, 0))",
        "Translate(of: Plane, by: (0, 1, 0))",
    ] {
        let told = advice(ground);
        assert!(told.contains("move them to the side of its air"), "{told}");
        assert!(!told.contains("exchange"), "{told}");
    }
    for closed in [
        "Box(size: (9, 9, 9))",
        "Scale(of: Sphere(radius: 4), by: 2)",
    ] {
        let told = advice(closed);
        assert!(told.contains("hollow it out"), "{told}");
        assert!(told.contains("exchange its air and its solid"), "{told}");
    }
}

/// Protects angles in degrees from radians, times in seconds from milliseconds, and radii in metres from centimetres.
#[test]
fn odd_units_of_places_are_warned_of() {
    let told = |change: &dyn Fn(&mut Scene)| {
        let mut scene = room();
        change(&mut scene);
        let warnings = scene.warnings();
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for (yaw, degrees) in [
        ("1.5708", "90"),
        ("-3.14", "-180"),
        ("0.785", "45"),
        ("6.283", "360"),
    ] {
        let stated: f32 = yaw.parse().expect("a number");
        assert_eq!(
            told(&|scene| scene.listeners[0].yaw = stated.to_radians()),
            [format!(
                "the yaw of the listener is {yaw}°: if it is in radians, state it in degrees ({degrees})"
            )]
        );
    }
    for yaw in [0.0f32, 1.5, 1.6, 5.5, 3.0, 45.0, 90.0, 0.7, 7.069] {
        let told = told(&|scene| scene.sources[0].yaw = yaw.to_radians());
        assert!(told.is_empty(), "{told:?}");
    }
    let path = |times: [f64; 2], yaws: [f32; 2]| {
        let key = |at: usize| Key {
            time: times[at],
            position: Vec3::new(3.0, 0.0, at as f32),
            yaw: yaws[at].to_radians(),
            pitch: 0.0,
        };
        Path::new(vec![key(0), key(1)]).expect("times that increase")
    };
    let walked = |times, yaws| told(&|scene| scene.sources[0].path = path(times, yaws));
    assert_eq!(
        walked([0.0, 4000.0], [0.0; 2]),
        [
            "the path of the source takes 4000 s, and is slower than 1 cm/s: if its times are in milliseconds, state them in seconds"
        ]
    );
    assert!(walked([0.0, 90.0], [0.0, 90.0]).is_empty());
    assert_eq!(walked([0.0, 4.0], [0.0, 1.571]).len(), 1);
    assert!(walked([0.0, 4.0], [20.0, 1.571]).is_empty());
    let told =
        told(&|scene| (scene.listeners[0].radius, scene.sources[0].position.x) = (30.0, 4.0));
    let expected = "the radius of the listener is 30 m, and the shortest edge of a room 10 m: radii are in metres, and 0.3 is a good value for rooms";
    assert!(told.contains(&expected.to_owned()), "{told:?}");
}

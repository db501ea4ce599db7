//! The extension without an engine.

use echomarch::Error;
use echomarch::glam::Vec3;
use echomarch::simulator::{Pose, SimulatorSettings, Update};
use echomarch_godot::{Acoustics, pose};
use std::error::Error as StdError;
use std::sync::Arc;
use std::time::{Duration, Instant};

const RATE_HZ: u32 = 44_100;

/// Frames of a block, at 60 pictures per second.
const FRAMES: usize = RATE_HZ as usize / 60;

/// Time that a test waits for what is heard.
const LIMIT: Duration = Duration::from_secs(60);

const ROOM: &str = "Surface(shape: Room(size: (8, 3, 6)), material: \"door\")";

/// The numbers of nodes.
const HALL: i64 = -9_223_372_000_000;
const WALL: i64 = 25;
const DOG: i64 = 26;
const CAT: i64 = 27;

fn acoustics() -> Result<Acoustics, Error> {
    let settings = SimulatorSettings::default().with_seconds(0.3, 0.3);
    let materials = "\"door\": Material(absorption: 0.2)";
    let mut acoustics = Acoustics::start(settings, materials, RATE_HZ)?;
    acoustics.surface(HALL, ROOM, false, Pose::default())?;
    acoustics.listener(Pose::at([-1.0, 0.0, 0.0]))?;
    Ok(acoustics)
}

/// One picture of a game whose source plays a tone: the loudest samples on both sides.
fn picture(acoustics: &mut Acoustics, time: &mut f32) -> [f32; 2] {
    let wanted = FRAMES - acoustics.waiting(DOG).unwrap_or(FRAMES);
    let tone = std::iter::repeat_with(|| {
        *time += 0.06;
        time.sin()
    });
    assert_eq!(acoustics.push(DOG, tone.take(wanted)), wanted);
    acoustics.commit();
    let mut stereo = [0.0; 2 * FRAMES];
    acoustics.play(&mut stereo);
    std::thread::sleep(Duration::from_millis(2));
    let frames = stereo.as_chunks::<2>().0.iter();
    frames.fold([0.0; 2], |most: [f32; 2], frame| {
        assert!(frame.iter().all(|sample| sample.is_finite()), "{frame:?}");
        [0, 1].map(|side| most[side].max(frame[side].abs()))
    })
}

/// Plays pictures until what is heard is as expected.
fn play_until(acoustics: &mut Acoustics, is_it: impl Fn(Option<&Arc<Update>>, [f32; 2]) -> bool) {
    let (began, mut time) = (Instant::now(), 0.0);
    loop {
        let loudest = picture(acoustics, &mut time);
        let heard = acoustics.heard(DOG);
        if is_it(heard.as_ref(), loudest) {
            return;
        }
        let state = acoustics.state();
        assert!(began.elapsed() < LIMIT, "{heard:?} {loudest:?} {state:?}");
    }
}

/// Protects games: a source is heard from where its node is; a wall hides it, also when it comes, changes and goes; and a
/// removed source is silent.
#[test]
fn nodes_are_heard_where_they_are() -> Result<(), Error> {
    let mut acoustics = acoustics()?;
    acoustics.source(DOG, "Source(level_db: 6)", Pose::at([1.0, 0.0, 0.0]))?;
    play_until(&mut acoustics, |heard, [left, right]| {
        heard.is_some_and(|heard| heard.traces > 0 && heard.direct.is_in_sight)
            && right > 0.3
            && right > left
    });
    // Another text replaces the source; its sound goes on.
    acoustics.source(DOG, "Source()", Pose::at([-3.0, 0.0, 0.0]))?;
    play_until(&mut acoustics, |_, [left, right]| {
        left > 0.1 && left > right
    });
    let wall = |size: &str| format!("Surface(shape: Box(size: {size}), material: \"brick\")");
    let between = Pose::at([-2.0, 0.0, 0.0]);
    acoustics.surface(WALL, &wall("(0.2, 3, 3)"), true, between)?;
    play_until(&mut acoustics, |heard, _| {
        heard.is_some_and(|heard| !heard.direct.is_in_sight)
    });
    acoustics.surface(
        WALL,
        &wall("(0.2, 0.3, 0.3)"),
        true,
        Pose::at([-2.0, 1.0, 0.0]),
    )?;
    play_until(&mut acoustics, |heard, _| {
        heard.is_some_and(|heard| heard.direct.is_in_sight)
    });
    acoustics.surface(WALL, &wall("(0.2, 0.3, 0.3)"), true, between)?;
    play_until(&mut acoustics, |heard, _| {
        heard.is_some_and(|heard| !heard.direct.is_in_sight)
    });
    acoustics.remove(WALL);
    play_until(&mut acoustics, |heard, _| {
        heard.is_some_and(|heard| heard.direct.is_in_sight)
    });
    acoustics.remove(DOG);
    play_until(&mut acoustics, |heard, loudest| {
        heard.is_none() && loudest == [0.0; 2]
    });
    assert_eq!(acoustics.push(DOG, [1.0]), 0);
    Ok(())
}

/// Protects games with a fault in a text: it is reported once, and the rest is heard.
#[test]
fn a_fault_is_reported_once() -> Result<(), Error> {
    let mut acoustics = acoustics()?;
    acoustics.source(DOG, "Source()", Pose::at([1.0, 0.0, 0.0]))?;
    let bad = "Surface(shape: Box(size: (1, 2, 3)), material: \"brik\")";
    let told = acoustics.surface(WALL, bad, false, Pose::default());
    let told = told.expect_err("an unknown material").to_string();
    assert!(told.contains("brik"), "{told}");
    acoustics.surface(WALL, bad, false, Pose::default())?;
    for empty in ["", " "] {
        acoustics
            .surface(CAT, empty, false, Pose::default())
            .expect_err("no surface");
        acoustics
            .source(CAT, empty, Pose::default())
            .expect_err("no source");
    }
    let flat = pose([[1.0, 0.0, 0.0]; 3], [0.0; 3]);
    acoustics
        .source(DOG, "Source()", flat)
        .expect_err("no turn");
    acoustics.source(DOG, "Source()", Pose::at([1.0, 0.0, 0.0]))?;
    play_until(&mut acoustics, |_, [_, right]| right > 0.1);
    // At most a second waits.
    let silence = std::iter::repeat_n(0.0, 2 * RATE_HZ as usize);
    assert!(acoustics.push(DOG, silence) <= RATE_HZ as usize);
    assert_eq!(acoustics.waiting(DOG), Some(RATE_HZ as usize));
    Acoustics::start(SimulatorSettings::default(), "\"door\":", RATE_HZ).expect_err("half a text");
    Ok(())
}

/// Protects directions: the axes of Godot's transforms are those of poses, whatever their scale. Godot's node that is
/// turned by 90° about y to the left has the basis below, by columns.
#[test]
fn transforms_are_poses() {
    let turned = [[0.0, 0.0, -2.0], [0.0, 3.0, 0.0], [4.0, 0.0, 0.0]];
    let place = pose(turned, [1.0, 2.0, 3.0]);
    assert_eq!(place.position, Vec3::new(1.0, 2.0, 3.0));
    assert!(place.forward().distance(Vec3::NEG_X) < 1e-6, "{place:?}");
    assert!(place.up().distance(Vec3::Y) < 1e-6, "{place:?}");
    let mirrored = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    assert!(pose(mirrored, [0.0; 3]).forward().distance(Vec3::NEG_Z) < 1e-6);
}

/// Protects the example project: its surfaces are texts of the scene format.
#[test]
fn the_surfaces_of_the_example_are_right() -> Result<(), Error> {
    let mut acoustics = acoustics()?;
    let scene = include_str!("../example/main.tscn").lines();
    let texts = scene.filter_map(|line| line.strip_prefix("surface = \"")?.strip_suffix('"'));
    let mut count = 0;
    for (text, node) in texts.zip(WALL..) {
        acoustics.surface(node, &text.replace("\\\"", "\""), false, Pose::default())?;
        count += 1;
    }
    assert_eq!(count, 2);
    Ok(())
}

/// Protects the example project: the library exports the symbol that it names.
#[test]
fn the_library_has_its_entry() -> Result<(), Box<dyn StdError>> {
    let text = include_str!("../example/echomarch.gdextension");
    let line = text.lines().find(|line| line.starts_with("entry_symbol"));
    let symbol = line
        .and_then(|line| line.split('"').nth(1))
        .ok_or("no symbol")?;
    let name = libloading::library_filename("echomarch_godot");
    let folder = std::env::current_exe()?;
    let file = folder.with_file_name(name);
    // SAFETY: the library's constructors only register its classes.
    let library = unsafe { libloading::Library::new(&file) }?;
    // SAFETY: the symbol is not called.
    unsafe { library.get::<unsafe extern "C" fn()>(symbol.as_bytes()) }?;
    Ok(())
}

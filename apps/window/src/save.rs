//! Saves the current state of a scene as a scene file and as a command line.
//!
//! The file names the opened scene as its base and contains the differences from it: the current positions of the
//! source and the listener, and the named values.

use echomarch::internals::file_output::{OutputError, write_inside, write_whole};
use echomarch::scene::{BasedScene, Listener, Path as KeyPath, Scene, SceneError};
use echomarch::tracer::{Algorithm, Directions, Settings, ThesisOptions};
use echomarch_walk::World;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Maximum number of file names that are tried.
const NAMES_AT_MOST: u32 = 9999;

/// Maximum change of an angle, in radians, caused by storing it in rounded degrees. The value is one rounding of `f32`
/// at ten turns.
const ROUNDING: f32 = 1e-5;

/// The reason why a scene could not be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// Either the file that was opened or the text to be written does not describe the scene that is played.
    #[error("cannot save the scene: its text does not give the same scene when it is read")]
    Differs,
    /// Either the file that was opened or the text to be written is not a valid scene.
    #[error("cannot save the scene: {0}")]
    NotAScene(#[from] SceneError),
    /// All file names are taken.
    #[error("cannot save the scene: {}-1.ron and all names after it are taken", .0.display())]
    NoName(PathBuf),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] OutputError),
}

/// Saves a scene in its current state. `chosen` is the destination; if it is `None`, the next free name `NAME-1.ron`
/// beside the opened file is used. A source or listener moved by hand loses its path. All others keep their paths.
///
/// Before the text is written, it is parsed as a file of the destination folder. The parsed scene must have its source
/// and listener at their current positions, and the base must be unchanged since it was opened.
///
/// # Errors
/// [`SaveError`]. No file is created after an error.
pub fn save(
    world: &World,
    settings: &Settings,
    chosen: Option<&Path>,
) -> Result<PathBuf, SaveError> {
    let path = match chosen {
        Some(path) => path.to_owned(),
        None => {
            let stem = stem(&world.base.name);
            let folder = folder_of(Path::new(&world.name));
            free_file(folder, &stem, "ron").ok_or_else(|| SaveError::NoName(stem.into()))?
        }
    };
    let folder = folder_of(&path);
    let expected = expected(world)?;
    let mut file = BasedScene::of(&world.name, folder)?;
    if world.source.is_some() {
        file.put_source(&expected)?;
    }
    if world.walker.is_some() {
        file.put_listener(&expected);
    }
    for (name, value) in &world.values {
        file.set_value(name, *value);
    }
    let text = file.text(&format!("Heard with{}", trace_options(settings)));
    let read = Scene::from_ron_in(&text, "the scene to be saved", folder)?;
    if !stands_as(&read, &expected) {
        return Err(SaveError::Differs);
    }
    let write = |out: &mut dyn std::io::Write| out.write_all(text.as_bytes());
    match chosen {
        Some(_) => write_whole(&path, write)?,
        None => write_inside(&path, write)?,
    }
    Ok(path)
}

/// Reads the opened scene again, and applies its named values and the positions of the moved source and listener.
fn expected(world: &World) -> Result<Scene, SaveError> {
    let mut scene = Scene::load(&world.name)?;
    for (name, value) in &world.values {
        scene.set_value(name, *value)?;
    }
    // The base's surfaces must be unchanged, including the contents of the files that they name.
    if scene.surfaces != world.base.surfaces {
        return Err(SaveError::Differs);
    }
    if let (Some(position), Some(source)) = (world.source, scene.sources.first_mut()) {
        source.position = position;
        source.path = KeyPath::default();
    }
    if let (Some(walker), Some(listener)) = (&world.walker, scene.listeners.first_mut()) {
        walker.place(listener);
        listener.path = KeyPath::default();
    }
    Ok(scene)
}

/// Whether two scenes are equal in everything except their surfaces. Angles may differ by the rounding of degrees.
fn stands_as(read: &Scene, expected: &Scene) -> bool {
    let listeners = || read.listeners.iter().zip(&expected.listeners);
    read.name == expected.name
        && read.materials == expected.materials
        && read.air == expected.air
        && read.sources == expected.sources
        && read.listeners.len() == expected.listeners.len()
        && listeners().all(|(read, expected)| is_heard_as(read, expected))
}

/// Whether two listeners are equal. Angles may differ by the rounding of degrees.
fn is_heard_as(read: &Listener, expected: &Listener) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() <= ROUNDING * a.abs().max(1.0);
    let mut turned = expected.clone();
    (turned.yaw, turned.pitch) = (read.yaw, read.pitch);
    turned == *read && near(read.yaw, expected.yaw) && near(read.pitch, expected.pitch)
}

/// The folder of a file. A bare file name belongs to the current folder.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// The first free name `STEM-1.ENDING`, `STEM-2.ENDING`, … in a folder.
pub fn free_file(folder: &Path, stem: &str, ending: &str) -> Option<PathBuf> {
    (1..NAMES_AT_MOST)
        .map(|number| folder.join(format!("{stem}-{number}.{ending}")))
        // A dangling symbolic link also occupies its name.
        .find(|path| std::fs::symlink_metadata(path).is_err())
}

/// Converts a scene's name to the stem of a file name.
fn stem(scene: &str) -> String {
    scene
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        })
        .collect()
}

/// Returns the `trace` call that reproduces the frame traced by the window, with the given named values. If the scene
/// has paths, the call contains the time on these paths.
pub fn trace_call(
    scene: &str,
    seconds: Option<f64>,
    values: &[(String, f32)],
    settings: &Settings,
) -> String {
    let mut call = format!("echomarch trace {}", quoted(scene));
    if let Some(seconds) = seconds {
        // Writing to a string never fails.
        let _ = write!(call, " --time {seconds}");
    }
    for (name, value) in values {
        let _ = write!(call, " --set {}", quoted(&format!("{name}={value}")));
    }
    call + &trace_options(settings)
}

/// Returns the command-line options for these settings, each preceded by a space.
fn trace_options(settings: &Settings) -> String {
    let usual = Settings::new(settings.profile());
    let mut call = format!(
        " --profile {} --waves {} --iterations {}",
        settings.profile(),
        settings.waves,
        settings.iterations
    );
    let mut add = |option: &str, value: &dyn std::fmt::Display| {
        let _ = write!(call, " --{option} {value}");
    };
    if settings.seed != usual.seed {
        add("seed", &settings.seed);
    }
    if settings.directions != Directions::Random {
        add("directions", &settings.directions);
    }
    if let Algorithm::Thesis(thesis) = &settings.algorithm
        && thesis.min_distance != ThesisOptions::default().min_distance
    {
        add("min-distance", &thesis.min_distance);
    }
    if settings.max_distance != usual.max_distance {
        add("max-distance", &settings.max_distance);
    }
    if settings.iterations_per_pass != usual.iterations_per_pass {
        add("iterations-per-pass", &settings.iterations_per_pass);
    }
    if settings.sum_on_gpu {
        call += " --sum-on-gpu";
    }
    call
}

/// Quotes a word for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-/+=".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::scene::Scene;
    use echomarch_walk::Walker;
    use glam::Vec3;

    /// A world whose source and listener were moved by hand.
    fn moved(name: &str) -> World {
        let mut world = World::load(name).unwrap();
        world.source = Some(Vec3::new(1.5, -0.25, 1e-3));
        world.walker = Some(Walker {
            position: Vec3::new(-3.0, 0.5, 4.0),
            yaw: 0.5,
            pitch: -0.25,
        });
        world
    }

    fn write(path: &Path, text: &str) -> String {
        std::fs::write(path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// A ball whose field is in a file beside the scene, with two named values.
    const NAMED: &str = r#"Scene(
        surfaces: [
            Surface(shape: Field(file: "ball.glsl", lipschitz: 1, size: (3, 3, 3))),
            Surface(shape: Sphere(radius: Value("a", 1)), position: (9, 0, 0)),
            Surface(shape: Box(size: (1, 2, Value("a", 1))), rotation: (0, Value("b \" c", 30), 0)),
        ],
        source: Source(position: (0, 0, -5), path: [Key(time: 0, position: (0, 0, -5)), Key(time: 2, position: (0, 1, -5))]),
        listener: Listener(position: (0, 0, 5), radius: 1))"#;

    fn named(folder: &Path) -> String {
        write(
            &folder.join("ball.glsl"),
            "float field(vec3 p) { return length(p) - 1.0; }",
        );
        write(&folder.join("mine.ron"), NAMED)
    }

    /// Protects every built-in scene: saved with new positions, it is the same scene with these positions and without
    /// the paths of the moved objects. Objects that were not moved by hand keep their paths.
    #[test]
    fn places_are_replaced_and_all_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        for name in Scene::BUILTIN_NAMES {
            let expected = Scene::builtin(name).unwrap();
            let path = folder.path().join(format!("{name}.ron"));
            let world = moved(name);
            save(&world, &Settings::default(), Some(&path)).unwrap();
            let read = Scene::from_file(&path).unwrap();
            assert_eq!(read.surfaces, expected.surfaces);
            assert_eq!(read.sources, [echomarch::Source::at(world.source.unwrap())]);
            assert!(read.listeners[0].path.is_empty());
            assert_eq!(read.listeners[0].position, world.walker.unwrap().position);
            assert!((read.listeners[0].yaw - 0.5).abs() < 1e-6);
            assert!((read.listeners[0].pitch + 0.25).abs() < 1e-6);
            assert_eq!(read.listeners[0].radius, expected.listeners[0].radius);
            let world = World::load(name).unwrap();
            save(&world, &Settings::default(), Some(&path)).unwrap();
            assert_eq!(Scene::from_file(&path).unwrap(), expected);
        }
    }

    /// Protects the size of the file, which must not grow with the scene, and shows its content.
    #[test]
    fn the_file_says_what_differs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("saved.ron");
        let mut world = moved("corner");
        world.walker = None;
        save(&world, &Settings::default(), Some(&path)).unwrap();
        let expected = "// Heard with --profile hybrid --waves 65536 --iterations 8\nScene(\n    base: \"corner\",\n    \
                        source: Source(position: (1.5, -0.25, 0.001)),\n)\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
    }

    /// Protects named values, which are saved in the units of the scene file. Also protects against chains of saved
    /// files: a scene saved twice still has the original file as its base, and keeps earlier changes.
    #[test]
    fn values_and_earlier_changes_stay() {
        let folder = tempfile::tempdir().unwrap();
        let origin = named(folder.path());
        let mut world = World::load(&origin).unwrap();
        world.set("a", 2.5).unwrap();
        world.set("b \" c", -60.0).unwrap();
        let first = save(&world, &Settings::default(), None).unwrap();
        assert_eq!(first, folder.path().join("mine-1.ron"));
        let read = Scene::from_file(&first).unwrap();
        assert_eq!(read.surfaces, world.base.surfaces);
        assert_eq!(read.sources, world.base.sources);
        assert_eq!(read.name, "mine");

        let mut world = moved(first.to_str().unwrap());
        world.source = None;
        world.set("a", 0.5).unwrap();
        let second = save(&world, &Settings::default(), None).unwrap();
        let text = std::fs::read_to_string(&second).unwrap();
        assert!(text.contains("base: \"mine.ron\""), "{text}");
        let read = Scene::from_file(&second).unwrap();
        assert_eq!(read.surfaces, world.base.surfaces);
        assert_eq!(read.sources, world.base.sources);
        assert_eq!(read.listeners[0].position, world.walker.unwrap().position);

        let third = save(
            &World::load(second.to_str().unwrap()).unwrap(),
            &Settings::default(),
            None,
        );
        assert_eq!(Scene::from_file(&third.unwrap()).unwrap(), read);
    }

    /// A hall with every acoustic property that a scene can have.
    const HEARD: &str = r#"Scene(
        surfaces: [Surface(shape: Room(size: (20, 9, 20)), material: "brick", walls: (floor: "mat"))],
        materials: {"mat": Material(absorption: 0.3)},
        air: Air(temperature: 10),
        sources: [Source(name: "flute", level_db: -3, position: (0, 0, -5)), Source(name: "horn")],
        listeners: [Listener(name: "a", radius: 1, position: (0, 0, 5)), Listener(radius: 0.5, yaw: 33)])"#;

    /// Protects everything that was not moved by hand: further sources and listeners, names, levels, materials and air.
    /// These properties may come from the base or from an intermediate file.
    #[test]
    fn sound_is_saved_as_it_is_heard() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("hall.ron"), HEARD);
        let between = [
            "",
            "materials: {\"brick\": Material(absorption: 0.5)}, air: Air(humidity: 90)",
            "source: Source(name: \"oboe\", level_db: 6), listener: Listener(name: \"b\")",
            "sources: [Source(name: \"x \\\" y\", level_db: 0.1), Source(position: (1, 2, 3))]",
            "source: Source(yaw: 33.3, directivity: Cardioid)",
            "source: Source(directivity: FirstOrder(0.3), \
                path: [Key(time: 0, position: (1, 1, 1), yaw: 33.3, pitch: -7.7)])",
            "sources: [Source(yaw: 33.3, pitch: -7.7, directivity: Figure8), Source(position: (1, 2, 3))]",
            "listeners: [Listener(radius: 0.1, pitch: 7), Listener(radius: 2, yaw: 0.3, name: \"b\")]",
        ];
        for said in between {
            let text = format!("Scene(base: \"hall.ron\", {said})");
            let origin = write(&folder.path().join("small.ron"), &text);
            let world = moved(&origin);
            let path = folder.path().join("saved.ron");
            save(&world, &Settings::default(), Some(&path)).unwrap();
            let read = Scene::from_file(&path).unwrap();
            assert!(stands_as(&read, &expected(&world).unwrap()), "{said}");
            assert_eq!(read.sources[0].position, world.source.unwrap());
            let opened = &world.base;
            assert_eq!(read.sources[0].name, opened.sources[0].name, "{said}");
            assert_eq!(
                read.sources[0].level_db, opened.sources[0].level_db,
                "{said}"
            );
            assert_eq!(read.sources[0].directivity, opened.sources[0].directivity);
            assert_eq!(read.listeners[0].name, opened.listeners[0].name, "{said}");
            assert_eq!(read.sources[1..], opened.sources[1..], "{said}");
            assert_eq!(read.listeners[1..], opened.listeners[1..], "{said}");
            assert_eq!((&read.materials, read.air), (&opened.materials, opened.air));
            assert_eq!(read.surfaces, opened.surfaces);
        }
    }

    /// Protects users from a saved file that describes another scene than the one played.
    #[test]
    fn a_file_that_would_differ_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let origin = named(folder.path());
        let path = folder.path().join("saved.ron");
        let world = World::load(&origin).unwrap();
        write(Path::new(&origin), &NAMED.replace("(9, 0, 0)", "(8, 0, 0)"));
        let refused = save(&world, &Settings::default(), Some(&path));
        assert!(matches!(refused, Err(SaveError::Differs)) && !path.exists());
        std::fs::remove_file(&origin).unwrap();
        let refused = save(&world, &Settings::default(), Some(&path));
        assert!(matches!(refused, Err(SaveError::NotAScene(_))) && !path.exists());
    }

    /// Protects scenes that name files: the files are found beside the base, whatever folder the saved file is in.
    #[test]
    fn a_scene_that_names_files_is_saved_anywhere() {
        let folder = tempfile::tempdir().unwrap();
        let origin = named(folder.path());
        let elsewhere = folder.path().join("else").join("where");
        std::fs::create_dir_all(&elsewhere).unwrap();
        let path = elsewhere.join("x.ron");
        save(&moved(&origin), &Settings::default(), Some(&path)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("base: \"../../mine.ron\""), "{text}");
        let read = Scene::from_file(&path).unwrap();
        assert_eq!(read.surfaces.len(), 3);
        assert_eq!(read.user_fields().count(), 1);
        // A file with the name of a built-in scene is still treated as a file.
        let odd = folder.path().join("corner");
        std::fs::copy(&origin, &odd).unwrap();
        let saved = save(
            &World::load(odd.to_str().unwrap()).unwrap(),
            &Settings::default(),
            None,
        );
        let text = std::fs::read_to_string(saved.unwrap()).unwrap();
        assert!(text.contains("base: \"./corner\""), "{text}");
    }

    /// Protects the command line: characters that a shell would interpret are quoted, and options with default values
    /// are omitted.
    #[test]
    fn the_call_says_what_is_not_usual() {
        let usual = trace_call("corner", None, &[], &Settings::default());
        let expected = "echomarch trace corner --profile hybrid --waves 65536 --iterations 8";
        assert_eq!(usual, expected);
        let fine = ThesisOptions::default().with_min_distance(0.01);
        let settings = Settings::new(fine).with_seed(3).with_sum_on_gpu(true);
        let values = [("the door".to_owned(), 60.5), ("gap".to_owned(), -2.0)];
        let call = trace_call("my room's.ron", Some(2.5), &values, &settings);
        let expected = r"echomarch trace 'my room'\''s.ron' --time 2.5 --set 'the door=60.5' --set gap=-2 --profile thesis";
        assert!(call.starts_with(expected), "{call}");
        assert!(
            call.ends_with(" --seed 3 --min-distance 0.01 --sum-on-gpu"),
            "{call}"
        );
    }
}

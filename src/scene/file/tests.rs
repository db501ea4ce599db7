//! Tests of files with a base, of messages about incorrect notation, and of changing files.

#[cfg(feature = "sofa")]
use crate::scene::BasedScene;
use crate::scene::{Path as KeyPath, Scene, SceneError, SceneWatch, Source};
#[cfg(feature = "sofa")]
use crate::test_common::sofa::SofaFile;
use glam::Vec3;
use std::path::PathBuf;

const HALL: &str = r#"Scene(
    surfaces: [
        Surface(shape: Room(size: (20, 6, 20))),
        Surface(name: "door", shape: Box(size: (Value("width", 2), 3, 1)), rotation: (0, Value("door", 30), 0)),
    ],
    source: Source(path: [Key(time: 0, position: (0, 0, -6)), Key(time: 2, position: (1, 0, -6))]),
    listener: Listener(position: (0, 0, 6), radius: 1, yaw: 10, pitch: 5, path: [Key(time: 1, position: (0, 0, 5))]),
)"#;

/// A folder with `hall.ron`. Tests write other files into it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("hall.ron", HALL);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Reads a scene file `small.ron` with this text.
    fn read(&self, text: &str) -> Result<Scene, SceneError> {
        self.write("small.ron", text);
        Scene::from_file(&self.path("small.ron"))
    }

    /// The error's message, without the folder.
    fn refused(&self, text: &str) -> String {
        let said = self.read(text).unwrap_err().to_string();
        said.replace(&format!("{}/", self.0.path().display()), "")
    }
}

/// Protects the rule of a base: the fields in the file replace those of the base, and all others come from the base.
#[test]
fn only_what_is_named_differs_from_the_base() {
    let folder = Folder::new();
    let hall = Scene::from_file(&folder.path("hall.ron")).unwrap();
    assert_eq!(folder.read(r#"Scene(base: "hall.ron")"#).unwrap(), hall);
    assert_eq!(hall.name, "hall");

    let mut expected = hall.clone();
    expected.name = "small".into();
    expected.sources[0] = Source::at(Vec3::Y);
    expected.set_value("door", 60.0).unwrap();
    let text = r#"// The order of fields does not matter.
        (values: [Value("door", 60)], source: (position: (0, 1, 0)), name: "small", base: "hall.ron")"#;
    assert_eq!(folder.read(text).unwrap(), expected);

    // A position without a path removes the listener's path; a radius does not move the listener.
    let listener = |said: &str| {
        let text = format!(r#"Scene(base: "hall.ron", listener: Listener({said}))"#);
        folder.read(&text).unwrap().listeners.remove(0)
    };
    let mut turned = hall.listeners[0].clone();
    turned.yaw = 0.5f32.to_degrees().to_radians();
    turned.path = KeyPath::default();
    let read = listener(&format!("yaw: {}", 0.5f32.to_degrees()));
    assert_eq!(read, turned);
    let mut wide = hall.listeners[0].clone();
    wide.radius = 2.5;
    assert_eq!(listener("radius: 2.5"), wide);
    let walks = listener("path: [Key(time: 0, position: (3, 0, 0), yaw: 90)]");
    assert_eq!(walks.position, Vec3::new(3.0, 0.0, 0.0));
    assert_eq!((walks.yaw, walks.pitch), (90f32.to_radians(), 0.0));
}

/// Protects the lookup of a base: a built-in scene first, then a file in the folder of the file that names the base. An
/// embedded text cannot name files.
#[test]
fn a_base_is_a_built_in_scene_or_a_file_beside() {
    let folder = Folder::new();
    let corner = Scene::builtin("corner").unwrap();
    folder.write("corner", HALL);
    folder.write("in/deep.ron", r#"Scene(base: "../hall.ron")"#);
    assert_eq!(folder.read(r#"Scene(base: "corner")"#).unwrap(), corner);
    let hall = folder.read(r#"Scene(base: "in/deep.ron")"#).unwrap();
    assert_eq!(hall.surfaces.len(), 2);
    let file = folder.read(r#"Scene(base: "./corner")"#).unwrap();
    assert_eq!(file.surfaces, hall.surfaces);
    let text = r#"Scene(base: "menger", listener: Listener(radius: 0.5))"#;
    let menger = Scene::from_ron(text, "text").unwrap();
    assert_eq!(menger.user_fields().count(), 1);
    assert_eq!(menger.listeners[0].radius, 0.5);
}

/// Protects the position of an error: the message states the file, and the line in that file.
#[test]
fn errors_point_at_their_own_file_and_line() {
    let folder = Folder::new();
    folder.write("broken.ron", "Scene(\n  surfaces: [],\n  sorce: 1)");
    folder.write(
        "empty.ron",
        &HALL.replace("surfaces: [", "surfaces: [], old: ["),
    );
    folder.write(
        "none.ron",
        "Scene(surfaces: [], source: Source(), listener: Listener(radius: 1))",
    );
    for (text, told) in [
        (
            "Scene(\n  base: \"hall.ron\",\n  listner: Listener(yaw: 3))",
            "small.ron:3:3: there is no field `listner`",
        ),
        (
            "Scene(base: \"hall.ron\",\n listener: Listener(radius: -1))",
            "small.ron:2:29: a radius in metres",
        ),
        (
            "Scene(base: \"hall.ron\", surfaces: [])",
            "small.ron:1:25: there is no field `surfaces`",
        ),
        (
            "Scene(surfaces: [], base: \"hall.ron\")",
            "small.ron:1:7: there is no field `surfaces`",
        ),
        (
            "Scene(name: \"a\", source: Source(position: (0, 1, 0)))",
            "small.ron:1:53: `surfaces` is missing",
        ),
        (
            "Scene(\n\n  base:  \"gone.ron\")",
            "small.ron:3:10: cannot read the base gone.ron: No such file",
        ),
        (
            "Scene(base: \"cornr\")",
            "small.ron:1:13: there is no scene \"cornr\"",
        ),
        ("Scene(base: 3)", "small.ron:1:13: "),
        (
            "Scene(base: \"broken.ron\")",
            "broken.ron:3:3: there is no field `sorce`",
        ),
        (
            "Scene(base: \"empty.ron\")",
            "empty.ron:2:19: there is no field `old`",
        ),
        (
            "Scene(base: \"none.ron\")",
            "scene \"none\" has no surfaces",
        ),
        (
            "Scene(base: \"hall.ron\", values: [\n Value(\"door\", 1),\n Value(\"dor\", 1)])",
            "small.ron:3:2: scene \"hall\" has no value named \"dor\"",
        ),
        (
            "Scene(base: \"hall.ron\", values: [Value(\"door\", 1), Value(\"door\", 2)])",
            "small.ron:1:52: the value \"door\" is set twice",
        ),
        (
            "Scene(base: \"hall.ron\", values: [Value(\"door\", 1e99)])",
            "small.ron:1:34: a value must be finite",
        ),
        (
            "Scene(base: \"hall.ron\",\n values: [Value(\"width\", -2)])",
            "small.ron:2:11: scene \"hall\"",
        ),
    ] {
        let said = folder.refused(text);
        assert!(said.starts_with(told), "{text}: {said}");
    }
}

/// Protects against endless and long chains: cycles are reported, also through symbolic links, and so are chains of
/// nine bases.
#[test]
fn chains_of_bases_have_an_end() {
    let folder = Folder::new();
    let based_on = |base: &str| format!("Scene(base: \"{base}\")");
    assert_eq!(
        folder.refused(&based_on("small.ron")),
        "small.ron:1:13: the base small.ron is itself based on this scene"
    );
    folder.write("other.ron", &based_on("small.ron"));
    assert_eq!(
        folder.refused(&based_on("other.ron")),
        "other.ron:1:13: the base small.ron is itself based on this scene"
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("small.ron", folder.path("link.ron")).unwrap();
        let said = folder.refused(&based_on("link.ron"));
        assert!(said.ends_with("the base link.ron is itself based on this scene"));
        std::fs::hard_link(folder.path("small.ron"), folder.path("hard.ron")).unwrap();
        let said = folder.refused(&based_on("hard.ron"));
        assert!(said.contains("based on"), "{said}");
        std::os::unix::fs::symlink("/dev/zero", folder.path("zero.ron")).unwrap();
        let said = folder.refused(&based_on("zero.ron"));
        assert!(
            said.ends_with("it is a device, not a regular file"),
            "{said}"
        );
    }
    folder.write("1.ron", &based_on("hall.ron"));
    for number in 2..=8 {
        let text = based_on(&format!("{}.ron", number - 1));
        folder.write(&format!("{number}.ron"), &text);
    }
    assert!(folder.read(&based_on("7.ron")).is_ok());
    assert_eq!(
        folder.refused(&based_on("8.ron")),
        "1.ron:1:13: a chain of bases has at most 8 scenes"
    );
}

/// Protects a running program: a base is never overwritten, and its changes are noticed.
#[test]
fn a_base_is_watched_and_never_replaced() {
    let folder = Folder::new();
    let text = r#"Scene(base: "hall.ron", name: "small")"#;
    folder.write("small.ron", text);
    let path = folder.path("small.ron");
    let (mut watch, first) = SceneWatch::open(path.to_str().unwrap()).unwrap();
    assert_eq!(watch.files().count(), 2);
    assert!(crate::file_input::is_input(&folder.path("hall.ron")));
    let mut settled = || (0..3).find_map(|_| watch.poll());
    folder.write("hall.ron", &HALL.replace("radius: 1,", "radius: 1.5,"));
    assert_eq!(settled().unwrap().unwrap().listeners[0].radius, 1.5);
    folder.write("hall.ron", "Scene(");
    assert!(settled().unwrap().is_err());
    folder.write("hall.ron", HALL);
    assert_eq!(settled().unwrap().unwrap(), first);
}

/// Protects saved scenes with a measured directivity: its file is found from another folder, for one source and for a
/// list of sources.
#[cfg(feature = "sofa")]
#[test]
fn a_saved_directivity_is_found_from_another_folder() {
    let folder = Folder::new();
    let measured = [([0.0, 0.0], vec![2.0]), ([90.0, 0.0], vec![1.0])];
    let horn = SofaFile::directivity(&[500.0], &measured).bytes();
    std::fs::write(folder.path("horn.sofa"), horn).unwrap();
    let elsewhere = folder.path("else/where");
    std::fs::create_dir_all(&elsewhere).unwrap();
    let horn = "yaw: 33.3, directivity: Balloon(file: \"horn.sofa\")";
    for said in [
        format!("source: Source({horn})"),
        format!("sources: [Source(name: \"a\", {horn}), Source(position: (0, 0, 1))]"),
    ] {
        let text = format!("Scene(base: \"hall.ron\", {said})");
        let mut expected = folder.read(&text).unwrap();
        (expected.sources[0].position, expected.sources[0].path) = (Vec3::ONE, KeyPath::default());
        let origin = folder.path("small.ron");
        let mut file = BasedScene::of(origin.to_str().unwrap(), &elsewhere).unwrap();
        file.put_source(&expected).unwrap();
        let saved = Scene::from_ron_in(&file.text("saved"), "saved", &elsewhere).unwrap();
        assert_eq!(saved.sources, expected.sources, "{said}");
    }
}

fn told(shape: &str) -> String {
    let text = format!(
        "Scene(surfaces: [\n Surface(shape: {shape})], source: Source(position: (0, 0, 0)), \
         listener: Listener(position: (5, 0, 0), radius: 1))"
    );
    Scene::from_ron(&text, "scene").unwrap_err().to_string()
}

/// Protects the line and column of a wrong material of faces.
#[test]
fn materials_of_faces_are_refused_at_their_place() {
    let rooms = "Rooms(of: [(name: \"hall\", from: (0, 0, 0), to: (9, 3, 9))])";
    for (shape, faces, sentence) in [
        (
            rooms,
            "\n\"hal\": \"carpet\"",
            "scene:3:8: the rooms have no box",
        ),
        (
            rooms,
            "\"hall/floor\": \"carpet\",\n \"hall\": \"carpt\"",
            "scene:3:10: there is no material \"carpt\"; did you mean carpet?",
        ),
        (
            "Plane",
            "\n\"a\": \"carpet\"",
            "scene:3:6: only the faces of a Mesh",
        ),
    ] {
        let said = told(&format!("{shape}, faces: {{{faces}}}"));
        assert!(said.starts_with(sentence), "{said}");
    }
}

/// Protects the message about a shape in an incorrect form: it states the correct form.
#[test]
fn a_shape_is_told_by_its_name_and_how_it_is_written() {
    for (shape, sentence) in [
        ("Sphere(1)", "Sphere is written Sphere(radius: …)"),
        ("Sphere", "Sphere is written Sphere(radius: …)"),
        ("Box(1, 2, 3)", "Box is written Box(size: …)"),
        ("Torus[1]", "Torus is written Torus(ring: …, tube: …)"),
        (
            "Translate(of: Sphere(1), by: (0, 0, 0))",
            "Sphere is written Sphere(radius: …)",
        ),
        ("Union[Plane]", "Union is written Union(of: …)"),
        ("Union", "Union is written Union(of: …)"),
        ("Plane(1)", "Plane is written Plane, without parentheses"),
    ] {
        let said = told(shape);
        assert!(said.contains(sentence), "{shape}: {said}");
        assert!(said.starts_with("scene:2:"), "{shape}: {said}");
    }
}

/// Protects the message about a material, air or a source in an incorrect form: it states the correct form.
#[test]
fn sound_is_told_how_it_is_written() {
    for (said, sentence) in [
        (
            "materials: {\"a\": Material(0.5)}",
            "Material is written Material(absorption: …, scattering: …, reduction: …, thickness: …, \
             density: …, coincidence: …, base: …)",
        ),
        (
            "air: Air(20)",
            "Air is written Air(temperature: …, humidity: …, pressure: …)",
        ),
        (
            "sources: [Source(1)]",
            "Source is written Source(name: …, level_db: …, position: …, yaw: …, pitch: …, directivity: …, path: …)",
        ),
    ] {
        let text = format!("Scene(surfaces: [],\n {said})");
        let said = Scene::from_ron(&text, "scene").unwrap_err().to_string();
        assert!(said.starts_with("scene:2:"), "{said}");
        assert!(said.ends_with(sentence), "{said}");
    }
}

/// Protects the suggestion for a mistyped shape: the most similar name. If no name is similar, all names are listed.
#[test]
fn the_nearest_shape_is_suggested() {
    for (shape, nearest) in [
        ("Tours(ring: 1, tube: 2)", "Torus"),
        ("sphere(radius: 1)", "Sphere"),
        ("Elipsoid(radii: (1, 1, 1))", "Ellipsoid"),
        ("SmoothUnoin(of: [], radius: 1)", "SmoothUnion"),
    ] {
        let said = told(shape);
        assert!(said.contains(&format!("did you mean {nearest}?")), "{said}");
        assert!(
            !said.contains("enum") && !said.contains("variant"),
            "{said}"
        );
    }
    let said = told("Teapot");
    assert!(
        said.contains("there are Plane, ") && said.contains("Scale"),
        "{said}"
    );
}

/// Protects other errors from misleading hints about the notation.
#[test]
fn what_is_no_error_of_a_shape_is_told_as_it_was() {
    for shape in ["Plane position: (0, 0, 0)", "Sphere(radius: one)"] {
        assert!(!told(shape).contains("is written"), "{}", told(shape));
    }
}

const SCENE: &str = "Scene(surfaces: [Surface(shape: Plane)],
    source: Source(position: (0, 1, 0)), listener: Listener(position: (0, 2, 5), radius: 1))";

/// The first result of the next three polls.
fn settled(watch: &mut SceneWatch) -> Option<Result<Scene, SceneError>> {
    (0..3).find_map(|_| watch.poll())
}

/// Protects a running program from incomplete and invalid files: each change and each error is reported once.
#[test]
fn each_change_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.ron");
    std::fs::write(&file, SCENE).unwrap();
    let (mut watch, first) = SceneWatch::open(file.to_str().unwrap()).unwrap();
    assert!(settled(&mut watch).is_none());
    std::fs::write(&file, SCENE.replace("radius: 1", "radius: 1.5")).unwrap();
    assert!(watch.poll().is_none(), "it may still be written");
    let second = settled(&mut watch).unwrap().unwrap();
    assert!(second != first && settled(&mut watch).is_none());
    std::fs::write(&file, "Scene(").unwrap();
    assert!(settled(&mut watch).unwrap().is_err());
    std::fs::write(folder.path().join("other"), "").unwrap();
    assert!(settled(&mut watch).is_none());
    std::fs::remove_file(&file).unwrap();
    assert!(settled(&mut watch).unwrap().is_err());
    std::fs::write(&file, SCENE).unwrap();
    assert_eq!(settled(&mut watch).unwrap().unwrap(), first);
}

//! Files that a scene names.

use super::text;
use echomarch::Scene;
use echomarch::scene::shape::{Grid, HeightField, User};
use echomarch::scene::{HeightImage, Node, UserField};
use glam::{UVec2, UVec3, Vec3};
use std::path::Path;
use std::sync::Arc;

/// Protects scenes that name files. The files are found in the folder of the scene, regardless of the program's current
/// folder. The error for a missing or corrupt file contains its name.
#[test]
fn files_lie_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let read = |surface: &str| {
        write("scene.ron", text(surface).as_bytes());
        Scene::from_file(&folder.path().join("scene.ron"))
    };
    write(
        "ball.glsl",
        b"float field(vec3 p) { return length(p) - 1.0; }",
    );
    let image = image::GrayImage::from_fn(2, 3, |x, y| image::Luma([(100 * x + 20 * y) as u8]));
    image.save(folder.path().join("hills.png")).unwrap();

    const FIELD: &str = "Field(file: \"ball.glsl\", lipschitz: 1.5, size: (3, 3, 3))";
    let scene = read(&format!("shape: Union(of: [{FIELD}, {FIELD}])")).unwrap();
    let field = &scene.surfaces[0].shape;
    let Node::User(User { field: user }) = &field.children[0].node else {
        panic!("{field:?}");
    };
    let text = "float field(vec3 p) { return length(p) - 1.0; }".to_owned();
    let path = folder.path().join("ball.glsl");
    assert_eq!(**user, UserField::new(path, text, Vec3::splat(3.0), 1.5));
    let Node::User(User { field: second }) = &field.children[1].node else {
        panic!("{field:?}");
    };
    assert!(Arc::ptr_eq(user, second), "the same file is read twice");

    let bent = read(&format!(
        "shape: {}",
        FIELD.replace("1.5,", "1.5, bend: 0.25,")
    ))
    .unwrap();
    let Node::User(stated) = &bent.surfaces[0].shape.node else {
        panic!("{:?}", bent.surfaces[0]);
    };
    assert_eq!(stated.field.bend, Some(0.25));
    assert_eq!(stated.bend(), Some(0.25 / 1.5));
    assert!(*stated.field != **user);
    let below = read(&format!(
        "shape: {}",
        FIELD.replace("1.5,", "1.5, bend: -1,")
    ));
    let below = below.unwrap_err().to_string();
    assert!(
        below.contains("a bend must be finite and at least 0 per metre, not -1"),
        "{below}"
    );
    let written = ron::to_string(&bent).unwrap();
    let again = Scene::from_ron(&written, "written").unwrap();
    assert_eq!(again.surfaces[0].shape, bent.surfaces[0].shape, "{written}");

    let scene = read("shape: HeightField(image: \"hills.png\", size: (8, 2, 8))").unwrap();
    let Node::HeightField(HeightField { image, size }) = &scene.surfaces[0].shape.node else {
        panic!("{:?}", scene.surfaces[0]);
    };
    assert_eq!(*size, Vec3::new(8.0, 2.0, 8.0));
    let heights = [0u8, 100, 20, 120, 40, 140].map(|h| f32::from(h) / 255.0);
    let name = folder.path().join("hills.png").display().to_string();
    let expected = HeightImage::new(&name, UVec2::new(2, 3), heights.to_vec()).unwrap();
    assert_eq!(image.size(), expected.size());
    for (read, expected) in image.heights().iter().zip(expected.heights()) {
        assert!((read - expected).abs() < 1e-4);
    }

    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }\n";
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.bytes());
    npy.extend((0..12).flat_map(|n| (n as f32 - 6.0).to_le_bytes()));
    write("ball.npy", &npy);
    let scene = read("shape: Grid(file: \"ball.npy\", cell: 0.5)").unwrap();
    let Node::Grid(Grid { field }) = &scene.surfaces[0].shape.node else {
        panic!("{:?}", scene.surfaces[0]);
    };
    assert_eq!((field.size(), field.cell()), (UVec3::new(2, 2, 3), 0.5));
    assert_eq!(field.values()[11], 5.0);
    let written = ron::to_string(&scene).unwrap();
    let again = Scene::from_ron(&written, "written").unwrap();
    assert_eq!(
        again.surfaces[0].shape, scene.surfaces[0].shape,
        "{written}"
    );

    write("hills.txt", b"no image");
    let refused = [
        (
            "Field(file: \"none.glsl\", lipschitz: 1, size: (1, 1, 1))",
            "none.glsl: No such file",
        ),
        (
            "HeightField(image: \"none.png\", size: (1, 1, 1))",
            "none.png: No such file",
        ),
        (
            "HeightField(image: \"hills.txt\", size: (1, 1, 1))",
            "hills.txt: ",
        ),
        (
            "Grid(file: \"none.npy\", cell: 0.1)",
            "none.npy: No such file",
        ),
        (
            "Grid(file: \"hills.txt\", cell: 0.1)",
            "it is not a NumPy file",
        ),
        ("Grid(file: \"ball.npy\", cell: 0)", "its cell must be"),
        (
            "Field(file: \".\", lipschitz: 1, size: (1, 1, 1))",
            "directory",
        ),
    ];
    for (shape, says) in refused {
        let sentence = read(&format!("shape: {shape}")).unwrap_err().to_string();
        let origin = folder.path().join("scene.ron").display().to_string();
        assert!(sentence.starts_with(&format!("{origin}:")), "{sentence}");
        assert!(
            sentence.contains(says) && !sentence.contains('\n'),
            "{sentence}"
        );
    }
}

/// Protects programs that create a scene from text. The files are then found relative to the current folder.
#[test]
fn text_finds_files_from_the_current_folder() {
    let field = "shape: Field(file: \"none.glsl\", lipschitz: 1, size: (1, 1, 1))";
    // The position of a shape after one in the older notation is that in the text as it was.
    let after = format!("shape: Union([Plane])), Surface({field}");
    for (surface, place) in [(field, "2:31"), (&after, "2:63")] {
        let error = Scene::from_ron(&text(surface), "text");
        let sentence = error.unwrap_err().to_string();
        assert!(
            sentence.starts_with(&format!("text:{place}: cannot read the field none.glsl: ")),
            "{sentence}"
        );
    }
    assert!(!Path::new("none.glsl").exists());
}

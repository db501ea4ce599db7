//! Malicious or faulty meshes: each is refused in one sentence with exit code 2, or imported with a warning that holds.

use crate::common::cli::{argument, echomarch, stderr};
use std::path::Path;
use std::process::Output;

/// A closed box of 2 m about the origin, with faces that point outwards.
const BOX: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";

fn import(folder: &Path, name: &str, content: &[u8]) -> Output {
    let file = folder.join(name);
    std::fs::write(&file, content).expect("a temporary file");
    let scene = folder.join("out.ron");
    let arguments = ["import", argument(&file), "-o", argument(&scene)];
    echomarch(&arguments)
}

/// Refuses a file in one sentence that contains `why`.
fn assert_refused(name: &str, content: &[u8], why: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = import(folder.path(), name, content);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{why}: {told}");
    assert_eq!(told.trim_end().lines().count(), 1, "{told}");
    assert!(told.contains(why), "{told}");
    assert!(!folder.path().join("out.ron").exists());
}

/// Imports a file, and checks that a warning contains `why`.
fn assert_warned(content: &str, why: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = import(folder.path(), "mesh.obj", content.as_bytes());
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    assert!(told.contains(why), "{why}: {told}");
}

/// Protects users from meshes that cannot be traced: the sentence names the line or the number of the fault.
#[test]
fn faulty_texts_are_refused() {
    for (text, why) in [
        ("", "it has no triangles"),
        ("v 1 2 x\n", "line 1: \"x\" is not a number"),
        ("v 1 2\n", "line 1: a vertex has three coordinates"),
        (
            "v 0 0 0\nf 1 2 3\n",
            "line 2: the face refers to vertex 2, but there are 1 before it",
        ),
        (
            "v 0 0 0\nf 1 1\n",
            "line 2: a face has at least 3 corners, not 2",
        ),
        (
            "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n",
            "vertex 3 has a coordinate that is not finite",
        ),
        (
            "v 0 0 0\nv 1 0 0\nv 1e300 1 0\nf 1 2 3\n",
            "vertex 3 has a coordinate that is not finite",
        ),
        (
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
            "it has no triangles",
        ),
    ] {
        assert_refused("mesh.obj", text.as_bytes(), why);
    }
    assert_refused(
        "mesh.stl",
        BOX.as_bytes(),
        "a mesh file ends in .obj, .glb or .gltf",
    );
}

/// Protects users from silent defects: each warning states the number and the first place.
#[test]
fn defects_are_warned_of() {
    let open = BOX.replace("f 5 6 8 7\n", "");
    assert_warned(
        &open,
        "4 edges have faces on one side only: the mesh is not closed",
    );
    let turned = BOX.replace("f 5 6 8 7", "f 7 8 6 5");
    assert_warned(&turned, "2 triangles were reversed");
    let large: String = BOX.replace('1', "3000").replace("f 3000", "f 1");
    let numbers = |line: &str| line.starts_with('v');
    let large: String = large
        .lines()
        .zip(BOX.lines())
        .map(|(large, own)| if numbers(own) { large } else { own }.to_owned() + "\n")
        .collect();
    assert_warned(
        &large,
        "it is 6000.0000 m long: if its unit is not the metre",
    );
}

/// A `.gltf` text with one triangle whose positions are in this buffer.
fn gltf(uri: &str, length: u64, nodes: &str) -> String {
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scene\": 0, \"scenes\": [{{\"nodes\": [0]}}], \"nodes\": [{nodes}],\
         \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}}}]}}],\
         \"buffers\": [{{\"uri\": \"{uri}\", \"byteLength\": {length}}}],\
         \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 36}}],\
         \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\",\
         \"min\": [0, 0, 0], \"max\": [1, 1, 1]}}]}}"
    )
}

/// Protects the machine from glTF files that have no end, name other files, or state sizes that they do not have.
#[test]
fn malicious_gltf_is_refused() {
    const NODE: &str = "{\"mesh\": 0}";
    let data =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    for (text, why) in [
        (
            gltf("../secret.bin", 36, NODE),
            "is not a file in the folder of the mesh",
        ),
        (
            gltf("/etc/passwd", 36, NODE),
            "is not a file in the folder of the mesh",
        ),
        (
            gltf("https://example.org/a.bin", 36, NODE),
            "is not a file in the folder of the mesh",
        ),
        (gltf("missing.bin", 36, NODE), "No such file"),
        (
            gltf(data, 99_999_999_999, NODE),
            "more than 536870912 bytes, the limit",
        ),
        (
            gltf(data, 1_000, NODE),
            "a buffer has 36 bytes instead of 1000",
        ),
        (
            gltf("data:;base64,####", 36, NODE),
            "a buffer's data are not base64",
        ),
        (
            gltf(data, 36, "{\"mesh\": 0, \"children\": [0]}"),
            "nested more than 64 deep",
        ),
        (
            gltf(data, 36, NODE).replace("\"count\": 3", "\"count\": 4000000000"),
            "limit",
        ),
        (
            gltf(data, 36, NODE).replace("\"count\": 3", "\"count\": 300"),
            "exceeds its view",
        ),
        ("{\"asset\"".to_owned(), "it is not valid glTF"),
    ] {
        assert_refused("mesh.gltf", text.as_bytes(), why);
    }
    let mut huge = b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON".to_vec();
    huge.extend([b' '; 64]);
    assert_refused("mesh.glb", &huge, "it is not valid glTF");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = import(folder.path(), "mesh.gltf", gltf(data, 36, NODE).as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("3 edges have faces on one side only"));
}

/// Protects the way from a mesh to a scene: the written scene is read again, has a material for each group, and no
/// wave leaves its closed room.
#[test]
fn an_imported_room_is_traced() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let room = BOX
        .replace("f 1 5", "usemtl \"odd\" name\nf 1 5")
        .replace("f 5 6", "usemtl carpet\nf 5 6");
    let file = folder.path().join("room.obj");
    std::fs::write(&file, room).expect("a temporary file");
    let scene = folder.path().join("room.ron");
    let arguments = [
        "import",
        argument(&file),
        "-o",
        argument(&scene),
        "--inside",
        "air",
    ];
    let output = echomarch(&arguments);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for line in [
        "volume V      8.000 m³, air inside",
        "surface S     24.000 m²",
        "carpet",
    ] {
        assert!(told.contains(line), "{told}");
    }
    let trace = [
        "trace",
        argument(&scene),
        "--json",
        "--waves",
        "4096",
        "--iterations",
        "50",
    ];
    let output = echomarch(&trace);
    let frame: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(frame["dead"], 0, "{frame}");
    assert_eq!(
        stderr(&output).matches("warning").count(),
        0,
        "{}",
        stderr(&output)
    );
}

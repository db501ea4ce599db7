//! Libraries named libEGL that lack EGL functions, and those that list no devices.
#![cfg(target_os = "linux")]

use crate::common::cli::{argument, command, json, stderr};
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// The C source of a libEGL that forwards calls to the real one.
const FORWARD: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/program/strange_egl/forward.c"
);

/// A folder with a libEGL compiled from that C source.
fn library(source: &Path, definitions: &[String]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let made = Command::new("cc")
        .args(["-shared", "-fPIC", "-o"])
        .arg(folder.path().join("libEGL.so.1"))
        .args(definitions)
        .arg(source)
        .arg("-ldl")
        .status()
        .expect("cc is missing: install the Debian package gcc");
    assert!(made.success());
    folder
}

/// Traces one frame with the program, which finds that library first.
fn trace(folder: &TempDir, arguments: &[&str]) -> Output {
    command()
        .args(["trace", "corner", "--waves", "1024", "--json"])
        .args(arguments)
        .env("LD_LIBRARY_PATH", folder.path())
        // The platform of Mesa's default display without a window system.
        .env("EGL_PLATFORM", "surfaceless")
        .output()
        .unwrap()
}

/// Protects users whose system finds an incomplete libEGL first, such as those shipped with browsers: the program
/// prints one sentence and does not crash. The API that needs no EGL works.
#[test]
fn a_libegl_without_functions_is_told() {
    for text in [
        "",
        "void *eglGetProcAddress(const char *name) { return 0; }",
    ] {
        let sources = tempfile::tempdir().unwrap();
        let source = sources.path().join("stub.c");
        std::fs::write(&source, text).unwrap();
        let folder = library(&source, &[]);
        let output = trace(&folder, &[]);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(
            told.contains("the first libEGL that is found is incomplete"),
            "{told}"
        );
        assert!(told.contains("has no egl"), "{told}");
        assert!(!told.contains("panicked"), "{told}");
        let output = trace(&folder, &["--gl", "osmesa"]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
}

/// Path of the real libEGL of this machine.
fn real_library() -> String {
    let known = Command::new("/sbin/ldconfig").arg("-p").output().unwrap();
    let known = String::from_utf8(known.stdout).unwrap();
    let line = known.lines().find(|line| line.contains("libEGL.so.1 "));
    let (_, path) = line.unwrap().split_once("=> ").unwrap();
    path.trim().to_owned()
}

/// Protects drivers that list no devices: the program uses the surfaceless platform, or else the default display, with
/// a surface if the driver needs one. The traced frame is the same.
#[test]
fn contexts_are_made_without_a_list_of_devices() {
    let arguments = ["trace", "corner", "--waves", "1024"];
    let expected = json(&arguments);
    let surfaceless = "EGL_EXT_platform_base EGL_MESA_platform_surfaceless";
    for (client, display) in [
        (surfaceless, "EGL_KHR_surfaceless_context"),
        ("", "EGL_KHR_surfaceless_context"),
        ("", "EGL_KHR_create_context"),
    ] {
        let define = |name: &str, text: &str| format!("-D{name}=\"{text}\"");
        let definitions = [
            define("REAL", &real_library()),
            define("CLIENT", client),
            define("DISPLAY", display),
        ];
        let folder = library(argument(Path::new(FORWARD)).as_ref(), &definitions);
        for api in ["gl", "gles"] {
            let output = trace(&folder, &["--gl", api]);
            assert!(output.status.success(), "{api}: {}", stderr(&output));
            let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            for part in ["renderer", "listener_hits", "pan"] {
                assert_eq!(
                    found[part], expected[part],
                    "{api}, {client:?}, {display:?}"
                );
            }
        }
    }
}

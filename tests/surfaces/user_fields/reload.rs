//! Scenes that are reloaded when the files of their fields change.

use super::settings;
use crate::common::field_files::{BALL, SCENE, write};
use crate::common::for_each_api;
use echomarch::tracer::Reloading;
use echomarch::{Error, Profile, Settings, Tracer};

/// Polls the files and returns the first change.
fn settle(
    reloading: &mut Reloading,
    tracer: &mut Tracer,
    settings: &Settings,
) -> Result<bool, Error> {
    for _ in 0..3 {
        match reloading.poll(tracer, settings) {
            Ok(false) => (),
            change => return change,
        }
    }
    Ok(false)
}

/// Protects a running program from all invalid states of the files: the last valid scene remains until the next valid
/// scene.
#[test]
fn a_scene_follows_its_files() {
    for_each_api(|context| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.ron");
        std::fs::write(&file, SCENE).unwrap();
        write(folder.path(), BALL);
        let settings = settings(Profile::Hybrid);
        let mut tracer = Tracer::new(context).unwrap();
        let mut reloading =
            Reloading::open(file.to_str().unwrap(), &mut tracer, &settings).unwrap();
        assert_eq!(reloading.files().count(), 2);
        let first = reloading.scene().clone();
        let broken = [
            ("float field(vec3 p) { return foo; }", "my.glsl:1: "),
            (
                "float field(vec3 p) { return 3.0 * length(p) - 1.0; }",
                "state at least 3.0",
            ),
            (
                "float field(vec3 p) { return sqrt(-1.0 - abs(p.x)); }",
                "finite",
            ),
            ("", "there is no `float field(vec3 p)`"),
        ];
        for (text, what) in broken {
            write(folder.path(), text);
            let change = settle(&mut reloading, &mut tracer, &settings);
            let error = change.expect_err(text);
            assert!(error.to_string().contains(what), "{error}");
            assert!(error.to_string().contains("my.glsl"), "{error}");
            let again = settle(&mut reloading, &mut tracer, &settings);
            assert!(matches!(again, Ok(false)), "{again:?}");
            assert_eq!(*reloading.scene(), first);
            tracer.frame(reloading.scene(), &settings).unwrap();
        }
        std::fs::remove_file(folder.path().join("my.glsl")).unwrap();
        let change = settle(&mut reloading, &mut tracer, &settings);
        assert!(change.is_err(), "{change:?}");
        write(
            folder.path(),
            "float field(vec3 p) { return length(p) - 0.5; }",
        );
        let compiled = tracer.programs_compiled();
        let change = settle(&mut reloading, &mut tracer, &settings);
        assert!(matches!(change, Ok(true)), "{change:?}");
        assert!(*reloading.scene() != first);
        // The program is compiled before the first frame that needs it.
        assert_eq!(tracer.programs_compiled(), compiled + 1);
        tracer.frame(reloading.scene(), &settings).unwrap();
        assert_eq!(tracer.programs_compiled(), compiled + 1);
    });
}

//! Tests of the page docs/shadertoy.md: its examples are identical to the files, and they run.

use crate::common::for_each_api;
use echomarch::{Profile, Scene, Settings, Tracer};
use std::path::Path;

const EXAMPLES: [&str; 3] = ["mandelbulb", "terrain", "gyroid"];

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(path).unwrap()
}

/// Protects readers of the page: the texts on the page are identical to those in the files.
#[test]
fn the_page_shows_the_files() {
    let page = read("docs/shadertoy.md");
    for name in EXAMPLES {
        for (language, ending) in [("glsl", "glsl"), ("ron", "ron")] {
            let text = read(&format!("examples/scenes/{name}.{ending}"));
            let block = format!("```{language}\n{text}```\n");
            assert!(page.contains(&block), "{name}.{ending} differs");
        }
    }
}

/// Protects the examples of the page. The checks accept each example, and waves reach the listener beside it or through
/// it. No march reaches the step limit.
#[test]
fn the_examples_of_the_page_run() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for name in EXAMPLES {
            let file = format!("examples/scenes/{name}.ron");
            let scene =
                Scene::from_file(Path::new(env!("CARGO_MANIFEST_DIR")).join(file).as_path());
            let scene = scene.unwrap();
            let settings = Settings::new(Profile::Hybrid);
            let settings = settings.with_waves(1024).with_iterations(4);
            let frame = tracer.frame(&scene, &settings);
            let counts = frame
                .unwrap_or_else(|error| panic!("{name}: {error}"))
                .counts;
            assert!(counts.listener_hits > 0, "{name}: {counts:?}");
            assert_eq!(counts.not_finite, 0, "{name}: {counts:?}");
        }
    });
}

//! The thesis' algorithm on the GPU against the same algorithm on the CPU.

use echomarch::gpu::{Api, Context, ContextOptions};
use echomarch::reference::march32;
use echomarch::{Scene, Settings, Tracer};

#[test]
fn probe() {
    let context = Context::headless(&ContextOptions {
        api: Api::Gl,
        gpu: None,
    })
    .unwrap();
    let mut tracer = Tracer::new(&context).unwrap();
    for name in ["corner", "obstacles"] {
        let scene = Scene::builtin(name).unwrap();
        for iterations in [4, 8] {
            let settings = Settings::thesis().with_iterations(iterations);
            let (frame, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
            let t = std::time::Instant::now();
            let starts: Vec<_> = waves.iter().map(|w| w.start_direction).collect();
            let cpu = march32::march(&scene, &settings, &starts);
            let same = waves
                .iter()
                .zip(&cpu)
                .filter(|(g, c)| g.status == c.status && g.position.distance(c.position) < 1e-3)
                .count();
            let exact = waves
                .iter()
                .zip(&cpu)
                .filter(|(g, c)| g.status == c.status && g.position == c.position)
                .count();
            let dirs = (0..settings.waves)
                .filter(|&w| march32::start_direction(w, 1) == starts[w as usize])
                .count();
            println!(
                "{name} {iterations} {:?} {:?} {same} exact {exact} dirs {dirs} cpu {:?}",
                frame.counts,
                frame.milliseconds,
                t.elapsed()
            );
            let big = settings.with_waves(1 << 20);
            let frame = tracer.frame(&scene, &big).unwrap();
            println!(
                "  {:?} {:?} {}",
                frame.counts,
                frame.milliseconds,
                frame.panning.pan()
            );
        }
    }
}

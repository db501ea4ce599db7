use echomarch::gpu::{Context, ContextOptions};
use echomarch::reference::ExactScene;
use echomarch::{Scene, Settings, Tracer};
fn main() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    let mut tracer = Tracer::new(&context).unwrap();
    for name in ["corner", "obstacles", "shoebox", "open-field", "open-pillars"] {
        let scene = Scene::builtin(name).unwrap();
        let exact = ExactScene::new(&scene).unwrap();
        for settings in [Settings::thesis(), Settings{min_distance:0.001, ..Settings::thesis()}, Settings::march(), Settings{min_distance:0.3, ..Settings::march()}, Settings{min_distance:0.01, ..Settings::march()},Settings{min_distance:1e9, max_distance:2e9,..Settings::march()}, Settings::hybrid(), Settings{iterations_per_pass:8,..Settings::hybrid()}] {
            let settings = settings.with_waves(262_144);
            let (frame, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
            let starts: Vec<_> = waves.iter().map(|w| w.start_direction).collect();
            let truth = exact.trace_all(scene.source.position.as_dvec3(), &starts, settings.iterations);
            let differ = waves.iter().zip(&truth).filter(|(w, t)| w.status as i32 != t.status).count();
            let mut errors: Vec<f64> = waves.iter().zip(&truth).filter(|(_,t)| t.status >= 0).map(|(w, t)| w.position.as_dvec3().distance(t.point)).collect();
            errors.sort_by(f64::total_cmp);
            let q = |p: f64| errors[((errors.len() - 1) as f64 * p) as usize];
            let hits = truth.iter().filter(|t| t.status == 0).count();
            let mut ms = vec![];
            for _ in 0..3 { ms.push(tracer.frame(&scene, &settings).unwrap().milliseconds.march); }
            ms.sort_by(f64::total_cmp);
            let ev = if settings.profile != echomarch::Profile::Hybrid { tracer.frame(&scene, &Settings{count_evaluations:true,..settings.clone()}).unwrap().counts.evaluations as f64 / (262144.0*8.0) } else {0.0};
            println!("{name:12} {} min {} per {}: differ {differ} hits {} exact {hits} dead {} zero {} guard {} median {:.2e} p99 {:.2e} max {:.2e} march ms {:.1} evals {ev:.2} pan {:.4}", settings.profile, settings.min_distance, settings.iterations_per_pass, frame.counts.listener_hits, frame.counts.dead, frame.counts.zero_length_passes, frame.counts.guard_hits, q(0.5), q(0.99), q(1.0), ms[1], frame.panning.pan());
        }
    }
}

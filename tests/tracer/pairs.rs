//! Tests of scenes with several sources and listeners: each pair is traced, heard and drawn as if it were alone.

use crate::common::tracer;
use echomarch::audio::Sound;
use echomarch::error::Error;
use echomarch::geometry::ExactScene;
use echomarch::offline::{FullSettings, Timing, render_full};
use echomarch::response::{Response, ResponseSettings};
use echomarch::scene::shape::Cuboid;
use echomarch::scene::{Material, SceneError};
use echomarch::tracer::ArrivalSettings;
use echomarch::{Listener, Profile, Scene, Settings, Source, Surface, Tracer};
use glam::Vec3;

/// A room with walls and pillars, two sources and two listeners.
fn furnished() -> Scene {
    let mut scene = Scene::builtin("obstacles").unwrap();
    let mut second = Source::at(Vec3::new(-1.0, 0.5, 2.0));
    second.level_db = -3.0;
    scene.sources.push(second.named("second"));
    let mut other = Listener::at(Vec3::new(-1.5, 0.3, -3.0), 1.0);
    other.yaw = 0.7;
    scene.listeners.push(other);
    scene.surfaces[0].material = Some("brick".to_owned());
    scene
}

/// The scene with only one of its sources and one of its listeners.
fn alone(scene: &Scene, source: usize, listener: usize) -> Scene {
    let mut alone = scene.clone();
    alone.sources = vec![scene.sources[source].clone()];
    alone.listeners = vec![scene.listeners[listener].clone()];
    alone
}

const PAIRS: [(usize, usize); 3] = [(1, 0), (0, 1), (1, 1)];

/// Protects frames, waves, paths and arrivals of every pair: they equal, bit for bit, those of a scene that has only
/// this pair.
#[test]
fn a_pair_is_traced_as_if_it_were_alone() {
    let (scene, mut tracer) = (furnished(), tracer());
    for profile in [Profile::Hybrid, Profile::March, Profile::Thesis] {
        let settings = Settings::new(profile).with_waves(2000);
        for (source, listener) in PAIRS {
            let alone = alone(&scene, source, listener);
            let pair = scene.pair(source, listener).unwrap();
            let (frame, waves) = tracer.frame_with_waves(pair, &settings).unwrap();
            let (own_frame, own_waves) = tracer.frame_with_waves(&alone, &settings).unwrap();
            let results = |frame: &echomarch::Frame| (frame.panning, frame.counts);
            assert_eq!(results(&frame), results(&own_frame), "{profile}");
            assert!(frame.counts.listener_hits > 0, "{profile}");
            assert_eq!(waves, own_waves, "{profile}");
            let again = tracer.frame(pair, &settings).unwrap();
            assert_eq!(results(&again), results(&own_frame), "{profile}");
            let few = settings.clone().with_waves(64);
            let [paths, own_paths] = [tracer.paths(pair, &few), tracer.paths(&alone, &few)];
            assert_eq!(paths.unwrap(), own_paths.unwrap(), "{profile}");
        }
    }
}

/// Protects the responses of every pair, with exact paths and late parts, and the exact references of every pair.
#[test]
fn a_pair_is_heard_as_if_it_were_alone() {
    let (scene, mut tracer) = (furnished(), tracer());
    let settings = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(4096))
        .with_seconds(0.3);
    for (source, listener) in PAIRS {
        let alone = alone(&scene, source, listener);
        let pair = scene.pair(source, listener).unwrap();
        let [response, own] = [
            Response::trace(&mut tracer, pair, &settings).unwrap(),
            Response::trace(&mut tracer, &alone, &settings).unwrap(),
        ];
        assert_eq!(response.paths, own.paths);
        assert!(!response.paths.is_empty());
        assert_eq!(response.echogram, own.echogram);
        assert_eq!(response.figures, own.figures);
        let start = pair.source().position.as_dvec3();
        let wave = |exact: ExactScene| exact.trace(start, -start, 8);
        let [exact, own] = [ExactScene::new(pair), ExactScene::new(&alone)];
        assert_eq!(wave(exact.unwrap()), wave(own.unwrap()));
    }
}

/// Protects listeners that share the waves of a source: the exact paths of each are those that it has alone, and its
/// figures agree within their errors. A pair of its own is the same, bit for bit.
#[test]
fn listeners_that_share_waves_hear_what_they_hear_alone() {
    let (mut scene, mut tracer) = (Scene::builtin("shoebox").unwrap(), tracer());
    let pillar = Surface::new(Cuboid {
        size: Vec3::new(0.4, 2.0, 0.5),
    });
    scene.surfaces.push(pillar.at(Vec3::new(0.5, -0.4, 1.0)));
    scene.sources.push(Source::at(Vec3::new(1.0, 0.5, 2.0)));
    scene
        .listeners
        .push(Listener::at(Vec3::new(-1.5, 0.3, 0.4), 0.2));
    let wall = Material::absorbing(0.4).scattering_by(0.2);
    scene.materials.insert("wall".to_owned(), wall);
    for surface in &mut scene.surfaces {
        surface.material = Some("wall".to_owned());
    }
    let settings = ResponseSettings::default().with_trace(Settings::default().with_waves(16_384));
    let pairs = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(s, l)| scene.pair(s, l).unwrap());
    let all = Response::trace_pairs(&mut tracer, &pairs, &settings).unwrap();
    assert_eq!(all.len(), pairs.len());
    for (pair, shared) in pairs.into_iter().zip(&all) {
        let [alone] = &Response::trace_pairs(&mut tracer, &[pair], &settings).unwrap()[..] else {
            panic!("one pair has one response");
        };
        let own = Response::trace(&mut tracer, pair, &settings).unwrap();
        assert_eq!((&alone.paths, &alone.figures), (&own.paths, &own.figures));
        assert_eq!(shared.paths.len(), own.paths.len());
        for (path, of) in shared.paths.iter().zip(&own.paths) {
            assert_eq!(path.path.surfaces, of.path.surfaces);
            assert!((path.delay_s - of.delay_s).abs() < 1e-9);
        }
        let mut compared = 0;
        for band in 0..8 {
            let [a, b] = [shared, &own].map(|response| &response.figures.bands[band]);
            let [ea, eb] = [shared, &own].map(|response| &response.figures.errors[band]);
            let figures = a.list().into_iter().zip(b.list());
            for ((a, b), (ea, eb)) in figures.zip(ea.list().into_iter().zip(eb.list())) {
                if let (Some(a), Some(b), Some(ea), Some(eb)) = (a, b, ea, eb) {
                    compared += 1;
                    // Some 200 figures are compared, and few of their errors have more than 16 degrees of freedom.
                    assert!(
                        (a - b).abs() <= 5.0 * ea.hypot(eb),
                        "{a} ± {ea}, {b} ± {eb}"
                    );
                }
            }
        }
        assert!(compared > 24, "{compared}");
    }
}

/// Protects callers from a silent choice of source or listener: a trace of a scene with several of them requires an
/// explicit choice.
#[test]
fn without_a_choice_nothing_is_traced() {
    fn assert_refused<T>(of: Result<T, Error>, counts: (usize, usize)) {
        match of.map(drop) {
            Err(Error::Scene(SceneError::NotOnePair {
                sources, listeners, ..
            })) => assert_eq!((sources, listeners), counts),
            other => panic!("{other:?}"),
        }
    }
    let mut tracer = tracer();
    let settings = Settings::default().with_waves(256);
    let ways = [Vec3::X];
    let how = ArrivalSettings::new(0.1);
    let response = ResponseSettings::default().with_seconds(0.1);
    for (sources, listeners) in [(2, 1), (1, 2), (0, 1), (1, 0)] {
        let mut scene = furnished();
        scene.sources.truncate(sources);
        scene.listeners.truncate(listeners);
        scene.validate().unwrap();
        tracer.check(&scene, &settings).unwrap();
        let counts = (sources, listeners);
        let scene = &scene;
        assert_refused(tracer.frame(scene, &settings), counts);
        assert_refused(tracer.frame_begin(scene, &settings), counts);
        assert_refused(tracer.frame_with_waves(scene, &settings), counts);
        assert_refused(tracer.frame_to_texture(scene, &settings), counts);
        assert_refused(tracer.paths(scene, &settings), counts);
        assert_refused(tracer.trace_directions(scene, &settings, &ways), counts);
        assert_refused(tracer.heard_paths(scene, &settings, 1, 1), counts);
        assert_refused(tracer.arrivals(scene, &settings, &how, &mut |_| ()), counts);
        assert_refused(Response::trace(&mut tracer, scene, &response), counts);
        assert_refused(response.seconds_needed(&mut tracer, scene), counts);
        assert_refused(ExactScene::new(scene).map_err(Error::from), counts);
    }
}

/// Renders half a second of a scene with all its sources. Returns the figures of the sources, and the samples.
fn rendered(tracer: &mut Tracer, scene: &Scene, listener: usize) -> (Vec<u64>, Vec<f32>) {
    let response = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(1024))
        .with_order(2);
    let settings = FullSettings::new(response, listener).with_tail(0.2);
    let sound = |_| Sound::parse("noise:3", Sound::SAMPLE_RATE).unwrap();
    let mut sounds: Vec<Sound> = scene.sources.iter().map(sound).collect();
    let (mut paths, mut samples) = (Vec::new(), Vec::new());
    let timing = Timing::new(0.5, 10.0);
    render_full(tracer, scene, &settings, &mut sounds, timing, |block| {
        paths.extend(block.heard.iter().map(|source| source.paths as u64));
        samples.extend_from_slice(block.samples);
        Ok::<(), Error>(())
    })
    .unwrap();
    (paths, samples)
}

/// Protects the rendering of all sources: two sources sound like the sum of both alone, at the requested listener.
#[test]
fn sources_together_sound_as_each_alone() {
    let (scene, mut tracer) = (furnished(), tracer());
    let (_, both) = rendered(&mut tracer, &scene, 1);
    let one = [0, 1].map(|source| rendered(&mut tracer, &alone(&scene, source, 1), 0).1);
    let loudest = both
        .iter()
        .fold(0.0, |most: f32, sample| most.max(sample.abs()));
    assert!(loudest > 0.0);
    for (at, sample) in both.iter().enumerate() {
        let sum = one[0][at] + one[1][at];
        assert!(
            (sample - sum).abs() <= 1e-6 * loudest,
            "{at}: {sample}, {sum}"
        );
    }
}

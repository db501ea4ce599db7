//! Tests of frames in steps, which are begun, advanced, and collected later.

use crate::common::{builtin, for_each_api};
use echomarch::{Profile, Scene, Settings, Tracer};

/// Begins a frame and draws all of it, but does not collect it.
fn begin_and_draw(tracer: &mut Tracer, scene: &Scene, settings: &Settings) {
    tracer.frame_begin(scene, settings).unwrap();
    assert!(tracer.frame_advance(f64::INFINITY).unwrap());
}

/// Protects the read-back through a pixel buffer: the result equals that of a blocking frame bit for bit, summed on the
/// CPU or on the GPU. A frame that was begun before does not disturb a blocking frame.
#[test]
fn a_frame_begun_is_the_frame_that_waits() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let scene = builtin("corner");
        for sum_on_gpu in [false, true] {
            // With these numbers some texels hold no wave. The second number is larger than the first.
            for waves in [1000, 4099, 64] {
                let mut settings = Settings::default().with_waves(waves).with_iterations(6);
                settings.sum_on_gpu = sum_on_gpu;
                begin_and_draw(&mut tracer, &scene, &settings);
                let late = tracer.frame_wait().unwrap().unwrap();
                begin_and_draw(&mut tracer, &scene, &settings);
                let now = tracer.frame(&scene, &settings).unwrap();
                assert_eq!((late.panning, late.counts), (now.panning, now.counts));
                let begun = tracer.frame_wait().unwrap().unwrap();
                assert_eq!((begun.panning, begun.counts), (now.panning, now.counts));
                // A pending frame with another number of waves does not disturb the frame either.
                begin_and_draw(&mut tracer, &scene, &settings);
                let other = settings.clone().with_waves(2 * waves);
                assert!(tracer.frame(&scene, &other).unwrap().panning != now.panning);
                let begun = tracer.frame_wait().unwrap().unwrap();
                assert_eq!((begun.panning, begun.counts), (now.panning, now.counts));
                assert!(now.counts.travelling > 0);
                assert!(late.milliseconds.march > 0.0);
            }
        }
    });
}

/// Protects callers that poll: a frame is returned only once, and only after a frame was begun.
#[test]
fn a_frame_is_collected_once() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        assert!(tracer.frame_poll().unwrap().is_none());
        assert!(tracer.frame_wait().unwrap().is_none());
        let settings = Settings::default().with_waves(256);
        begin_and_draw(&mut tracer, &builtin("shoebox"), &settings);
        let frame = loop {
            assert!(tracer.is_frame_pending());
            if let Some(frame) = tracer.frame_poll().unwrap() {
                break frame;
            }
        };
        assert!(frame.counts.listener_hits > 0);
        assert!(!tracer.is_frame_pending());
        assert!(tracer.frame_poll().unwrap().is_none());
    });
}

/// Protects frames that are divided among many pictures: they equal a frame in one call bit for bit, for any drawing
/// between the parts. They use the scene in its state at the begin.
#[test]
fn a_frame_in_parts_is_the_frame_in_one_piece() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let mut other = tracer.with_shared_programs().unwrap();
        let mut parts = 0;
        for profile in [Profile::Thesis, Profile::March, Profile::Hybrid] {
            for sum_on_gpu in [false, true] {
                let mut settings = Settings::new(profile).with_waves(4099).with_iterations(5);
                settings.sum_on_gpu = sum_on_gpu;
                let mut scene = builtin("corner");
                let whole = tracer.frame(&scene, &settings).unwrap();
                tracer.frame_begin(&scene, &settings).unwrap();
                scene.sources[0].position.x += 1.0;
                loop {
                    assert!(tracer.is_frame_pending() && tracer.frame_marching_for().is_some());
                    assert!(tracer.frame_poll().unwrap().is_none());
                    // This tracer has the same programs, but other uniforms.
                    other
                        .frame(&scene, &settings.clone().with_waves(64))
                        .unwrap();
                    parts += 1;
                    // Without time, each call draws one row.
                    if tracer.frame_advance(0.0).unwrap() {
                        break;
                    }
                }
                let late = tracer.frame_wait().unwrap().unwrap();
                assert_eq!((late.panning, late.counts), (whole.panning, whole.counts));
                assert!(late.milliseconds.march > 0.0);
                assert!(!tracer.is_frame_pending());
            }
        }
        assert!(parts > 6 * 16, "{parts} parts");
    });
}

/// Protects callers that cannot wait for all parts, or no longer need the frame: a wait traces the rest, and another
/// frame discards the parts.
#[test]
fn a_frame_in_parts_may_be_waited_for_or_given_up() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let (scene, settings) = (builtin("corner"), Settings::default().with_waves(4099));
        // If no frame was begun, there is nothing to advance, so the call fails.
        let refused = tracer.frame_advance(1.0).unwrap_err().to_string();
        assert!(refused.contains("no frame to advance"), "{refused}");
        let whole = tracer.frame(&scene, &settings).unwrap();
        tracer.frame_begin(&scene, &settings).unwrap();
        for milliseconds in [-1.0, f64::NAN] {
            assert!(tracer.frame_advance(milliseconds).is_err());
        }
        tracer.frame_advance(0.0).unwrap();
        let waited = tracer.frame_wait().unwrap().unwrap();
        assert!(tracer.frame_advance(0.0).is_err());
        assert_eq!(
            (waited.panning, waited.counts),
            (whole.panning, whole.counts)
        );
        tracer.frame_begin(&scene, &settings).unwrap();
        let other = settings.clone().with_waves(100);
        let now = tracer.frame(&scene, &other).unwrap();
        assert!(!tracer.is_frame_pending() && now.panning != whole.panning);
        assert!(tracer.frame_wait().unwrap().is_none());
    });
}

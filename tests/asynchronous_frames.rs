//! Frames that are begun now and collected later.

mod common;

use common::{builtin, for_each_api};
use echomarch::{Settings, Tracer};

/// Protects the read-back through a pixel buffer: bit for bit what a frame that waits answers, summed on either
/// side, and a frame that waits is not disturbed by one begun before it.
#[test]
fn a_frame_begun_is_the_frame_that_waits() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let scene = builtin("corner");
        for sum_on_gpu in [false, true] {
            // Odd counts leave texels without a wave; the second is larger than the first.
            for waves in [1000, 4099, 64] {
                let mut settings = Settings::default().with_waves(waves).with_iterations(6);
                settings.sum_on_gpu = sum_on_gpu;
                tracer.frame_begin(&scene, &settings).unwrap();
                let late = tracer.frame_wait().unwrap().unwrap();
                tracer.frame_begin(&scene, &settings).unwrap();
                let now = tracer.frame(&scene, &settings).unwrap();
                assert_eq!((late.panning, late.counts), (now.panning, now.counts));
                let begun = tracer.frame_wait().unwrap().unwrap();
                assert_eq!((begun.panning, begun.counts), (now.panning, now.counts));
                // Nor by one of another size.
                tracer.frame_begin(&scene, &settings).unwrap();
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

/// Protects callers that poll: one frame is given once, and none where none was begun.
#[test]
fn a_frame_is_collected_once() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        assert!(tracer.frame_poll().unwrap().is_none());
        assert!(tracer.frame_wait().unwrap().is_none());
        let settings = Settings::default().with_waves(256);
        tracer.frame_begin(&builtin("shoebox"), &settings).unwrap();
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

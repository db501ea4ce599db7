//! Tests of tracers together with contexts that another program has made current.

use crate::gl::tests::foreign_program::RawEgl;
use crate::gl::{Api, AsyncRead, GpuTimer, Picture, Program, RenderTarget, Texture};
use crate::test_common::context;
use crate::{Scene, Settings, Tracer};

/// Protects frames from contexts that a program makes current between calls: each frame has the result of its own
/// scene, runs on the tracer's context, and leaves the program's own context current.
#[test]
fn gpu_frames_do_not_mind_what_others_make_current() {
    for api in Api::ALL {
        let raw = RawEgl::new();
        let mut tracer = Tracer::new(&context(api)).unwrap();
        let settings = Settings::hybrid().with_waves(4096);
        let near = Scene::builtin("corner").unwrap();
        let mut far = near.clone();
        far.listeners[0].position.x -= 4.0;
        let mut alone = Tracer::new(&context(Api::Gl)).unwrap();
        let [of_near, of_far] = [&near, &far].map(|s| alone.frame(s, &settings).unwrap().counts);
        assert_ne!(of_near, of_far);
        drop(alone);
        let mut counts = |scene| tracer.frame(scene, &settings).unwrap().counts;
        for _ in 0..2 {
            assert_eq!(counts(&near), of_near, "{api}");
            raw.unbind();
            assert_eq!(counts(&far), of_far, "{api}, unbound");
            raw.bind();
            assert_eq!(counts(&near), of_near, "{api}, with another's context");
            assert!(raw.is_current(), "{api}");
            assert_eq!(counts(&far), of_far, "{api}, with another's context again");
            assert!(raw.is_current(), "{api}");
            raw.unbind();
        }
        tracer.frame_begin(&near, &settings).unwrap();
        raw.bind();
        assert_eq!(
            tracer.frame_wait().unwrap().unwrap().counts,
            of_near,
            "{api}"
        );
        assert!(raw.is_current(), "{api}");
    }
}

/// Drops an object of an echomarch context while the program's own context is current. Afterwards the program's context
/// must still be current: EGL must report it, and GL calls must reach it.
fn drop_beside<T>(raw: &RawEgl, what: &str, dropped: T) {
    const VIEWPORT: [i32; 4] = [1, 2, 3, 4];
    raw.bind();
    raw.set_viewport(VIEWPORT);
    drop(dropped);
    assert!(raw.is_current(), "{what} was dropped");
    assert_eq!(raw.viewport(), VIEWPORT, "{what} was dropped");
}

/// Protects a program's own context when the program drops objects of echomarch: echomarch makes its context current to
/// free an object, and then restores the program's context. Each kind of object is dropped separately, and the context
/// with the last of them.
#[test]
fn gpu_drops_leave_the_context_of_others_current() {
    const BODY: &str = "layout(location = 0) out vec4 result; void main() { result = vec4(1.0); }";
    for api in Api::ALL {
        let raw = RawEgl::new();
        let context = context(api);
        let texture = Texture::new(&context, 2, 2).unwrap();
        let target = RenderTarget::new(&context, &[&texture]).unwrap();
        let mut read = AsyncRead::new(&context).unwrap();
        read.begin(&target, 0..1, 2, 2).unwrap();
        drop_beside(&raw, "a read under way", read);
        drop_beside(&raw, "a target", target);
        drop_beside(&raw, "a texture", texture);
        let program = Program::fragment(&context, "constant", BODY).unwrap();
        drop_beside(&raw, "a program", program);
        drop_beside(&raw, "a picture", Picture::new(&context, 2, 2).unwrap());
        // There is a query between two marks, if queries are available.
        let mut timer = GpuTimer::new(&context);
        timer.restart().unwrap();
        timer.mark().unwrap();
        drop_beside(&raw, "a timer", timer);

        let mut tracer = Tracer::new(&context).unwrap();
        let scene = Scene::builtin("corner").unwrap();
        let settings = Settings::hybrid().with_waves(256);
        tracer.frame_begin(&scene, &settings).unwrap();
        tracer.frame_advance(f64::INFINITY).unwrap();
        drop_beside(&raw, "a tracer with a frame under way", tracer);
        let alone = Tracer::new(&context).unwrap();
        drop(context);
        drop_beside(&raw, "a tracer, and the context with it", alone);
        raw.unbind();
    }
}

//! Tests of frames on contexts that another program created.

use crate::gl::tests::foreign_program::{ForeignProgram, Kind, RawEgl, Switch};
use crate::gl::{Api, Context, GpuError, MakeCurrent, SwitchContext};
use crate::test_common::context;
use crate::tracer::{ArrivalSettings, Counts, Panning};
use crate::{Scene, Settings, Tracer};
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_void};
use std::rc::Rc;
use std::sync::Arc;

/// The context of the program. Either the program makes it current itself, or callbacks do.
fn context_of(egl: &Rc<RawEgl>, is_switched: bool) -> Context {
    let loader = egl.clone();
    let loader = move |name: &CStr| loader.address(name);
    let current = match is_switched {
        true => MakeCurrent::With(Box::new(Switch(egl.clone()))),
        false => MakeCurrent::ByCaller,
    };
    // SAFETY: the functions are those of the context, which is current or made current, and lives to the end of the
    // test.
    unsafe { Context::from_loader(loader, current) }.unwrap()
}

fn api_of(kind: Kind) -> Api {
    match kind {
        Kind::Core | Kind::Compatibility => Api::Gl,
        Kind::Es => Api::Gles,
    }
}

/// A scene and settings for each way of drawing passes: in one pass, in several passes with texture pairs, with the
/// scene's data in a buffer, and with the sum on the GPU.
fn inputs() -> Vec<(Scene, Settings)> {
    let corner = || Scene::builtin("corner").unwrap();
    vec![
        (corner(), Settings::hybrid().with_waves(4096)),
        (
            corner(),
            Settings::hybrid().with_waves(4096).with_sum_on_gpu(true),
        ),
        (corner(), Settings::thesis().with_waves(1024)),
        (
            Scene::builtin("colonnade").unwrap(),
            Settings::march().with_waves(1024),
        ),
    ]
}

fn frame(tracer: &mut Tracer, (scene, settings): &(Scene, Settings)) -> (Panning, Counts) {
    let frame = tracer.frame(scene, settings).unwrap();
    (frame.panning, frame.counts)
}

/// Protects both programs that share a context, with all of its state spoiled: the frame is bit for bit the same as on
/// echomarch's own context, and every call restores all state, including transform feedback.
#[test]
fn gpu_a_callers_context_is_left_as_it_was() {
    for (kind, is_switched) in Kind::ALL.into_iter().flat_map(|k| [(k, false), (k, true)]) {
        let mut own = Tracer::new(&context(api_of(kind))).unwrap();
        let inputs = inputs();
        let expected: Vec<_> = inputs.iter().map(|input| frame(&mut own, input)).collect();
        drop(own);
        let feedback = feedback_alone(kind);
        let program = ForeignProgram::new(kind);
        program.spoil();
        program.begin_feedback();
        program.draw();
        let state = program.state();
        let same = |what: &str| {
            let what = format!("{kind:?}, switched {is_switched}, after {what}");
            assert!(program.egl.is_current(), "{what}");
            for (found, expected) in program.state().iter().zip(&state) {
                assert_eq!(found, expected, "{what}");
            }
        };
        let context = context_of(&program.egl, is_switched);
        assert_eq!(context.api(), api_of(kind));
        same("the context was described");
        let mut tracer = Tracer::new(&context).unwrap();
        same("a tracer was made");
        for (input, expected) in inputs.iter().zip(&expected) {
            program.make_an_error();
            assert_eq!(frame(&mut tracer, input), *expected, "{kind:?}");
            same("a frame");
            let (scene, settings) = input;
            tracer.frame_begin(scene, settings).unwrap();
            same("begin");
            tracer.frame_advance(f64::INFINITY).unwrap();
            same("advance");
            let found = loop {
                if let Some(frame) = tracer.frame_poll().unwrap() {
                    break (frame.panning, frame.counts);
                }
            };
            assert_eq!(found, *expected, "{kind:?}");
            same("poll");
        }
        let (scene, settings) = &inputs[0];
        tracer.frame_with_waves(scene, settings).unwrap();
        same("waves");
        let how = ArrivalSettings::new(0.05);
        tracer.arrivals(scene, settings, &how, &mut |_| ()).unwrap();
        same("arrivals");
        tracer.frame_to_texture(scene, settings).unwrap();
        same("a frame in a texture");
        assert!(
            tracer
                .frame(scene, &settings.clone().with_waves(0))
                .is_err()
        );
        same("a refusal");
        drop((tracer, context));
        same("the end");
        program.draw();
        assert_eq!(program.end_feedback(), feedback, "{kind:?}");
    }
}

extern "system" fn of_gl_3_3(name: u32) -> *const c_char {
    match name {
        glow::VERSION => c"3.3 Mesa".as_ptr(),
        _ => c"Mesa".as_ptr(),
    }
}

extern "system" fn of_es_3_0(name: u32) -> *const c_char {
    match name {
        glow::VERSION => c"OpenGL ES 3.0 Mesa".as_ptr(),
        _ => c"Mesa".as_ptr(),
    }
}

/// Protects programs on drivers of the lowest versions, which have one viewport, one scissor and one blending state,
/// and cannot pause transform feedback: all state that such a version has is restored.
#[test]
fn gpu_a_callers_context_of_the_least_version_is_left_as_it_was() {
    for (kind, version) in [(Kind::Core, of_gl_3_3 as GetString), (Kind::Es, of_es_3_0)] {
        let program = ForeignProgram::new(kind);
        program.spoil();
        program.spoil_no_newer();
        let is_known = |line: &String| {
            let is_indexed = ["area ", "mask ", "blending "]
                .iter()
                .find_map(|of| line.strip_prefix(of));
            is_indexed.is_none_or(|rest| rest.starts_with("0:"))
        };
        let state: Vec<String> = program.state().into_iter().filter(is_known).collect();
        let egl = program.egl.clone();
        let older = move |name: &CStr| match name == c"glGetString" {
            true => version as *const c_void,
            false => egl.address(name),
        };
        // SAFETY: the context is current, and has everything that the reported version requires.
        let context = unsafe { Context::from_loader(older, MakeCurrent::ByCaller) }.unwrap();
        let mut tracer = Tracer::new(&context).unwrap();
        for input in inputs() {
            frame(&mut tracer, &input);
            let found = program.state().into_iter().filter(is_known);
            for (found, expected) in found.zip(&state) {
                assert_eq!(found, *expected, "{kind:?}");
            }
        }
    }
}

/// The type of `glGetString`.
type GetString = extern "system" fn(u32) -> *const c_char;

/// The transform feedback of two draws in this state, without calls of echomarch in between. It is `[0, 1, 2, 0, 1,
/// 2]`, but zeros with zink of Mesa 22.3 in the compatibility profile.
fn feedback_alone(kind: Kind) -> Vec<f32> {
    let program = ForeignProgram::new(kind);
    program.spoil();
    program.begin_feedback();
    program.draw();
    program.draw();
    program.end_feedback()
}

/// Protects the drawing of another program, which sets its state once and then only draws. Also protects the program's
/// memory: all objects of echomarch are freed.
#[test]
fn gpu_a_caller_draws_between_the_parts_of_a_frame() {
    for kind in Kind::ALL {
        let program = ForeignProgram::new(kind);
        let objects = program.objects();
        let mut draws = 0;
        let mut draw = || {
            program.draw();
            draws += 1;
            let picture = program.picture();
            assert_eq!(picture, ForeignProgram::expected_picture(draws), "{kind:?}");
        };
        let (scene, settings) = &inputs()[3];
        draw();
        let mut tracer = Tracer::new(&context_of(&program.egl, false)).unwrap();
        let expected = tracer.frame(scene, settings).unwrap().counts;
        tracer.frame_begin(scene, settings).unwrap();
        draw();
        while !tracer.frame_advance(0.0).unwrap() {
            assert!(program.is_in_use());
        }
        draw();
        assert_eq!(tracer.frame_wait().unwrap().unwrap().counts, expected);
        assert_ne!(program.objects(), objects);
        drop(tracer);
        assert_eq!(program.objects(), objects, "{kind:?}");
    }
}

/// Protects a program that makes its context current or not current at any time, and has a second context: the
/// previously current context is restored.
#[test]
fn gpu_a_callers_context_is_current_only_when_it_was() {
    let settings = Settings::hybrid().with_waves(1024);
    let scene = Scene::builtin("corner").unwrap();
    for is_own_around in [false, true] {
        let mut own = Tracer::new(&context(Api::Gl)).unwrap();
        let expected = own.frame(&scene, &settings).unwrap().counts;
        let own = is_own_around.then_some(own);
        let (egl, other) = (Rc::new(RawEgl::of(Kind::Core)), RawEgl::of(Kind::Core));
        let mut tracer = Tracer::new(&context_of(&egl, true)).unwrap();
        assert!(!egl.is_current());
        let mut counts = || tracer.frame(&scene, &settings).unwrap().counts;
        for _ in 0..2 {
            egl.bind();
            assert_eq!(counts(), expected);
            assert!(egl.is_current());
            egl.unbind();
            assert_eq!(counts(), expected);
            assert!(!egl.is_current());
            other.bind();
            assert_eq!(counts(), expected);
            assert!(other.is_current());
            other.unbind();
        }
        if let Some(mut own) = own {
            for _ in 0..2 {
                assert_eq!(own.frame(&scene, &settings).unwrap().counts, expected);
                assert_eq!(counts(), expected);
            }
            egl.bind();
            assert_eq!(own.frame(&scene, &settings).unwrap().counts, expected);
            assert!(egl.is_current());
            assert_eq!(counts(), expected);
            drop(own);
            assert!(egl.is_current());
        }
        other.bind();
        drop(tracer);
        assert!(other.is_current());
        other.unbind();
    }
}

/// Protects results that stay on the GPU: the texture that the program receives holds the value of each wave, and
/// belongs to the program's context.
#[test]
fn gpu_a_frame_stays_in_a_texture() {
    let program = ForeignProgram::new(Kind::Core);
    // SAFETY: the program's context stays current until the end of the test.
    let gl = unsafe { Context::from_glow(Arc::new(program.egl.gl()), MakeCurrent::ByCaller) };
    let mut tracer = Tracer::new(&gl.unwrap()).unwrap();
    for (scene, settings) in inputs() {
        let expected = tracer.frame(&scene, &settings).unwrap();
        tracer.frame_begin(&scene, &settings).unwrap();
        tracer.frame_advance(f64::INFINITY).unwrap();
        let result = tracer.frame_to_texture(&scene, &settings).unwrap();
        assert_eq!(result.waves, settings.waves);
        let texels = program.texels(result.texture, result.width, result.height);
        let waves = texels.iter().take(result.waves as usize);
        let right: f64 = waves.map(|[_, right, ..]| f64::from(*right)).sum();
        assert!(
            (right - expected.panning.right).abs() < 1e-6 * right,
            "{right}"
        );
        // The earlier frame, whose passes are all drawn, can still be collected.
        let drawn = tracer.frame_wait().unwrap().unwrap();
        assert_eq!(drawn.counts, expected.counts);
    }
}

/// Protects from contexts on which nothing can be traced, because their version is too old or they no longer exist.
#[test]
fn gpu_a_callers_context_that_cannot_trace_is_an_error() {
    extern "system" fn of_2006(_: u32) -> *const c_char {
        c"2.1 Mesa 1.0".as_ptr()
    }
    let egl = Rc::new(RawEgl::of(Kind::Core));
    egl.bind();
    let loader = egl.clone();
    let old = move |name: &CStr| match name == c"glGetString" {
        true => of_2006 as *const c_void,
        false => loader.address(name),
    };
    // SAFETY: the context is current.
    let error = unsafe { Context::from_loader(old, MakeCurrent::ByCaller) }.unwrap_err();
    assert!(matches!(&error, GpuError::TooOld { version } if version.starts_with("2.1")));
    egl.unbind();

    struct Gone;
    impl SwitchContext for Gone {
        fn make_current(&self) -> Result<(), String> {
            Err("the window was closed".into())
        }
        fn is_current(&self) -> bool {
            false
        }
        fn release(&self) {}
    }
    let nothing = |_: &CStr| std::ptr::null();
    // SAFETY: the functions are never called.
    let error = unsafe { Context::from_loader(nothing, MakeCurrent::ByCaller) }.unwrap_err();
    assert!(matches!(error, GpuError::NoFunctions { .. }), "{error}");
    let loader = move |name: &CStr| egl.address(name);
    // SAFETY: the functions are never called.
    let error = unsafe { Context::from_loader(loader, MakeCurrent::With(Box::new(Gone))) };
    let error = error.unwrap_err().to_string();
    assert!(error.contains("the window was closed"), "{error}");
}

/// The functions of a context that can no longer be made current once `is_gone` is set.
struct Going {
    switch: Switch,
    is_gone: Rc<Cell<bool>>,
}

impl SwitchContext for Going {
    fn make_current(&self) -> Result<(), String> {
        match self.is_gone.get() {
            true => Err("the window was closed".into()),
            false => self.switch.make_current(),
        }
    }

    fn is_current(&self) -> bool {
        !self.is_gone.get() && self.switch.is_current()
    }

    fn release(&self) {
        assert!(!self.is_gone.get(), "a context that is not current");
        self.switch.release();
    }
}

/// Protects a program whose window closes before the tracer is dropped: frames return errors, dropping calls no GL
/// function, and another context of the program stays current.
#[test]
fn gpu_a_callers_context_that_goes_is_an_error_and_no_panic() {
    let egl = Rc::new(RawEgl::of(Kind::Core));
    let loader = egl.clone();
    let loader = move |name: &CStr| loader.address(name);
    let is_gone = Rc::new(Cell::new(false));
    let going = Going {
        switch: Switch(egl.clone()),
        is_gone: is_gone.clone(),
    };
    // SAFETY: the functions are those of the context, which is made current by these functions.
    let context =
        unsafe { Context::from_loader(loader, MakeCurrent::With(Box::new(going))) }.unwrap();
    let mut tracer = Tracer::new(&context).unwrap();
    let (scene, settings) = &inputs()[0];
    tracer.frame(scene, settings).unwrap();
    tracer.frame_begin(scene, settings).unwrap();
    let other = RawEgl::of(Kind::Core);
    other.bind();
    is_gone.set(true);
    let error = tracer.frame_advance(f64::INFINITY).unwrap_err().to_string();
    assert!(error.contains("the window was closed"), "{error}");
    assert!(tracer.frame(scene, settings).is_err());
    drop((tracer, context));
    assert!(other.is_current());
    other.unbind();
}

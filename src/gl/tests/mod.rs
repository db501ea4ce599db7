//! Tests of contexts without a window on every API, of textures and passes without acoustics, and of contexts of other
//! programs. These tests fail on a machine without GL.

pub mod foreign_program;
mod foreign_state;
mod passes;

use crate::gl::{
    Api, Context, GpuError, GpuTimer, Picture, Program, RenderTarget, Texture, full_screen_pass,
};
use crate::test_common::{context, on_a_thread_for_each_api as on_every_api};
use foreign_program::RawEgl;
use glow::HasContext;

/// Draws a constant with the context and reads it back: the value is wrong if the calls went to another context.
fn draws(context: &Context, value: f32) {
    let texture = Texture::new(context, 3, 2).unwrap();
    let target = RenderTarget::new(context, &[&texture]).unwrap();
    let body = "uniform float value; layout(location = 0) out vec4 result; void main() { result = vec4(value); }";
    let program = Program::fragment(context, "constant", body).unwrap();
    program.set_f32("value", value);
    full_screen_pass(context, &program, &target, 3, 2).unwrap();
    assert_eq!(target.read(0).unwrap(), [value; 24]);
}

/// Protects the description of a context: its renderer has a name, and its limits are at least those that OpenGL 3.3
/// and ES 3.0 guarantee.
#[test]
fn gpu_context_describes_itself() {
    on_every_api(|api| {
        let context = context(api);
        println!(
            "{api}: {} | {} | {}",
            context.renderer(),
            context.version(),
            context.shading_language()
        );
        assert_eq!(context.api(), api);
        assert!(!context.renderer().is_empty() && !context.vendor().is_empty());
        assert_eq!(context.version().contains("OpenGL ES"), api == Api::Gles);
        let limits = context.limits();
        assert!(limits.max_texture_size >= 1024 && limits.max_fragment_uniform_vectors >= 224);
        assert!(limits.max_draw_buffers >= 4 && limits.max_color_attachments >= 4);
        context.check("nothing").unwrap();
    });
}

/// Protects calls from going to a foreign context while contexts of all APIs take turns on one thread. After OSMesa's
/// context the test uses the same EGL context again, a switch that EGL alone does not notice.
#[test]
fn gpu_contexts_of_all_apis_interleave_on_one_thread() {
    let contexts = [Api::Gl, Api::OsMesa, Api::Gles, Api::OsMesa].map(context);
    for (step, index) in [0, 1, 0, 3, 1, 2, 1, 2, 0, 2, 3, 2, 3, 0]
        .into_iter()
        .enumerate()
    {
        let context = &contexts[index];
        draws(context, step as f32);
        // SAFETY: the context is current.
        let version = unsafe { context.gl().get_parameter_string(glow::VERSION) };
        assert_eq!(version, context.version(), "step {step}");
    }
}

/// Protects objects of a context while a context of another API draws, and after that other context is dropped.
#[test]
fn gpu_objects_survive_other_contexts() {
    for api in [Api::Gl, Api::Gles] {
        let (egl, osmesa) = (context(api), context(Api::OsMesa));
        let textures = [&egl, &osmesa].map(|context| Texture::new(context, 1, 1).unwrap());
        let [kept, dropped] = [(&egl, &textures[0]), (&osmesa, &textures[1])]
            .map(|(context, texture)| RenderTarget::new(context, &[texture]).unwrap());
        textures[0].upload(&[1.0; 4]).unwrap();
        textures[1].upload(&[2.0; 4]).unwrap();
        for _ in 0..2 {
            assert_eq!(kept.read(0).unwrap(), [1.0; 4]);
            assert_eq!(dropped.read(0).unwrap(), [2.0; 4]);
        }
        let [texture, of_osmesa] = textures;
        drop((dropped, of_osmesa, osmesa));
        assert_eq!(kept.read(0).unwrap(), [1.0; 4]);
        drop(texture);
    }
}

/// Protects the dropping of contexts: it is possible in any order, for current and other contexts, and before the
/// objects made with them are dropped.
#[test]
fn gpu_contexts_drop_in_any_order() {
    let apis = [Api::Gl, Api::OsMesa, Api::Gles];
    for first_dropped in 0..apis.len() {
        for current in 0..apis.len() {
            let mut contexts: Vec<Context> = apis.map(context).into();
            let textures: Vec<Texture> = contexts
                .iter()
                .map(|context| Texture::new(context, 2, 2).unwrap())
                .collect();
            draws(&contexts[current], 1.0);
            drop(contexts.remove(first_dropped));
            for (index, context) in contexts.iter().enumerate() {
                draws(context, index as f32);
            }
            // The first context is destroyed with its texture here, while another is current.
            drop(textures);
            draws(&contexts[0], 5.0);
            drop(contexts.remove(1));
            draws(&contexts[0], 6.0);
        }
    }
}

/// Protects from leaking contexts: 200 can be made in a row, and 20 at once.
#[test]
fn gpu_contexts_are_freed() {
    on_every_api(|api| {
        for _ in 0..200 {
            let context = context(api);
            drop(Texture::new(&context, 64, 64).unwrap());
        }
        let contexts: Vec<Context> = (0..20).map(|_| context(api)).collect();
        for (index, context) in contexts.iter().enumerate() {
            draws(context, index as f32);
        }
    });
}

/// Protects from waiting forever for a context lost in a reset of the graphics card: contexts request reset
/// notification if the driver offers it.
#[test]
fn gpu_contexts_are_told_of_resets_where_the_driver_offers_it() {
    // Constant of KHR_robustness.
    const RESET_NOTIFICATION_STRATEGY: u32 = 0x8256;
    const LOSE_CONTEXT_ON_RESET: i32 = 0x8252;
    let raw = RawEgl::new();
    let is_offered = raw.offers_robustness();
    let context = context(Api::Gl);
    // SAFETY: the context is current.
    let strategy = unsafe { context.gl().get_parameter_i32(RESET_NOTIFICATION_STRATEGY) };
    println!(
        "{}: offered {is_offered}, strategy {strategy:#x}",
        context.renderer()
    );
    assert_eq!(is_offered, strategy == LOSE_CONTEXT_ON_RESET);
}

/// Protects the context while a clone of it exists.
#[test]
fn gpu_context_lives_as_long_as_its_last_clone() {
    on_every_api(|api| {
        let first = context(api);
        let second = first.clone();
        drop(first);
        draws(&second, 7.0);
    });
}

/// Protects error reporting: impossible sizes cause errors that state the numbers, and no later driver failures.
#[test]
fn gpu_impossible_sizes_are_errors() {
    on_every_api(|api| {
        let context = context(api);
        let limit = context.limits().max_texture_size;
        for (width, height) in [(limit + 1, 1), (1, u32::MAX), (0, 4)] {
            assert!(
                Texture::new(&context, width, height)
                    .unwrap_err()
                    .is_bad_input()
            );
            assert!(
                Picture::new(&context, width, height)
                    .unwrap_err()
                    .is_bad_input()
            );
        }
        let error = Texture::new(&context, limit + 1, 1)
            .unwrap_err()
            .to_string();
        assert!(error.contains(&limit.to_string()), "{error}");
        draws(&context, 1.0);
    });
}

/// Protects the context when a texture is within the size limit but exceeds memory: the result is an error, and the
/// context still works.
#[test]
fn gpu_out_of_memory_is_an_error() {
    on_every_api(|api| {
        let context = context(api);
        let limit = context.limits().max_texture_size;
        match Texture::new(&context, limit, limit) {
            Ok(_) => println!("{} has room for {limit} × {limit}", context.renderer()),
            Err(error) => assert!(matches!(error, GpuError::OutOfMemory { .. }), "{error}"),
        }
        draws(&context, 1.0);
    });
}

/// Protects error reporting: a GL error is reported once, with its name.
#[test]
fn gpu_check_names_the_error() {
    on_every_api(|api| {
        let context = context(api);
        // SAFETY: the context is current; GL refuses an unknown capability.
        unsafe { context.gl().enable(0xFFFF) };
        let error = context.check("the test").unwrap_err().to_string();
        assert!(
            error.contains("GL_INVALID_ENUM") && error.contains("the test"),
            "{error}"
        );
        context.check("the test").unwrap();
    });
}

/// Protects error reporting: the error of an earlier call that a read-back reports is not said to be that of the
/// read-back alone.
#[test]
fn gpu_errors_at_a_read_back_name_earlier_calls() {
    on_every_api(|api| {
        let context = context(api);
        // SAFETY: the context is current; GL refuses an unknown capability.
        unsafe { context.gl().enable(0xFFFF) };
        let error = context.check_and_wait("the read-back of a texture");
        let error = error.unwrap_err().to_string();
        let told = "GL_INVALID_ENUM in the read-back of a texture (or an earlier call,";
        assert!(error.contains(told), "{error}");
        context.check("the test").unwrap();
    });
}

/// Protects the times of passes: each is positive, and software renderers use the wall clock.
#[test]
fn gpu_timers_measure() {
    on_every_api(|api| {
        let context = context(api);
        let mut timer = GpuTimer::new(&context);
        timer.restart().unwrap();
        for _ in 0..2 {
            draws(&context, 3.0);
            timer.mark().unwrap();
        }
        let took = timer.milliseconds();
        assert_eq!(took.len(), 2);
        assert!(took.iter().all(|time| *time > 0.0), "{}", timer.name());
        if context.is_software() {
            assert_eq!(timer.name(), "wall clock around glFinish");
            assert!(timer.waits());
        }
    });
}

//! Full-screen passes.

use std::ops::Range;

use glow::HasContext;

use super::{Context, GpuError, Program};

/// Something that a pass can draw into.
pub trait Target {
    /// GL's name for the framebuffer, of the context that the pass is drawn with; `None` is the one of a window.
    fn framebuffer(&self) -> Option<glow::Framebuffer>;
}

/// Runs the program once for each texel of the lower left `width` × `height` of the target, where
/// `gl_FragCoord.xy` is the texel's index plus a half. Uniforms and textures are those set last. Returns before the
/// drawing is done.
///
/// A texture that the program reads must not be one that the target writes to.
///
/// # Errors
/// What GL reports, in debug builds: see [`Context::debug_check`].
pub fn full_screen_pass(
    context: &Context,
    program: &Program,
    target: &impl Target,
    width: u32,
    height: u32,
) -> Result<(), GpuError> {
    prepare(context, program, target, width, height);
    draw(context, program)
}

/// [`full_screen_pass`] for a band of rows alone, so that a large pass can be drawn in parts: the system may
/// stop a single draw call that takes a graphics card some seconds. Rows from `height` on are left out.
///
/// # Errors
/// What GL reports, in debug builds: see [`Context::debug_check`].
pub fn full_screen_pass_rows(
    context: &Context,
    program: &Program,
    target: &impl Target,
    width: u32,
    height: u32,
    rows: Range<u32>,
) -> Result<(), GpuError> {
    let end = rows.end.min(height);
    if rows.start >= end {
        return Ok(());
    }
    prepare(context, program, target, width, height);
    let gl = context.gl();
    // SAFETY: the context is current.
    unsafe {
        gl.enable(glow::SCISSOR_TEST);
        gl.scissor(
            0,
            rows.start as i32,
            width as i32,
            (end - rows.start) as i32,
        );
    }
    let drawn = draw(context, program);
    // SAFETY: the context is current, as above: drawing touches no other. The flush keeps a driver from handing
    // several bands to the card as one piece of work.
    unsafe {
        gl.disable(glow::SCISSOR_TEST);
        gl.flush();
    }
    drawn
}

/// Sets all the state that a pass depends on, whatever was drawn before.
fn prepare(context: &Context, program: &Program, target: &impl Target, width: u32, height: u32) {
    debug_assert!(
        context.is_same(program.context()),
        "program \"{}\" is of another context",
        program.label()
    );
    let gl = context.gl();
    // SAFETY: the context is current, and program, framebuffer and vertex array its own.
    unsafe {
        gl.bind_framebuffer(glow::FRAMEBUFFER, target.framebuffer());
        gl.viewport(0, 0, width as i32, height as i32);
        for test in [
            glow::DEPTH_TEST,
            glow::STENCIL_TEST,
            glow::BLEND,
            glow::SCISSOR_TEST,
            glow::DITHER,
            glow::CULL_FACE,
        ] {
            gl.disable(test);
        }
        gl.color_mask(true, true, true, true);
        gl.bind_vertex_array(Some(context.vertex_array()));
        gl.use_program(Some(program.raw()));
    }
}

fn draw(context: &Context, program: &Program) -> Result<(), GpuError> {
    // SAFETY: the context is current; the vertex shader reads no attribute.
    unsafe { context.gl().draw_arrays(glow::TRIANGLES, 0, 3) };
    context.debug_check(program.label())
}

//! Full-screen passes.

use std::ops::Range;

use glow::HasContext;

use super::{Context, GpuError, Program};

/// A framebuffer that a pass can draw into.
pub trait Target {
    /// GL's name for the framebuffer in the context that draws the pass; `None` is a window's framebuffer.
    fn framebuffer(&self) -> Option<glow::Framebuffer>;
}

/// Runs the program once for each texel of the lower left `width` × `height` texels of the target, where
/// `gl_FragCoord.xy` is the texel's index plus a half. Uses the uniforms and textures set last. Returns before the
/// drawing is done.
///
/// A texture that the program reads must not be one that the target writes to.
///
/// # Errors
/// What GL reports, in debug builds: see `Context::debug_check`.
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

/// [`full_screen_pass`] for a band of rows, so that a large pass can be drawn in parts: the system may stop a single
/// draw call that takes a graphics card several seconds. Rows from `height` on are left out.
///
/// # Errors
/// What GL reports, in debug builds: see `Context::debug_check`.
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
    context.set_scissor(0, rows.start, width, end - rows.start);
    context.set_scissor_test(true);
    let drawn = draw(context, program);
    context.set_scissor_test(false);
    // SAFETY: the context is current. The flush keeps a driver from submitting several bands as one piece of work.
    unsafe { context.gl().flush() };
    drawn
}

/// Sets all the state that a pass depends on, regardless of earlier drawing.
fn prepare(context: &Context, program: &Program, target: &impl Target, width: u32, height: u32) {
    debug_assert!(
        context.is_same(program.context()),
        "program \"{}\" is of another context",
        program.label()
    );
    context.set_viewport(width, height);
    context.set_scissor_test(false);
    let gl = context.gl();
    // SAFETY: the context is current, and program, framebuffer and vertex array its own.
    unsafe {
        gl.bind_framebuffer(glow::FRAMEBUFFER, target.framebuffer());
        for test in [
            glow::DEPTH_TEST,
            glow::STENCIL_TEST,
            glow::BLEND,
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

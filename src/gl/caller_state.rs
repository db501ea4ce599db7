//! The state of a caller's context: saved before a call, set to the values that passes need, restored after the call.
//!
//! The lists contain all state that this crate changes, and all state that its drawing, uploads and read-backs depend
//! on. When other files of this module change more state, add it here; `tests/foreign_state.rs` queries all of it, and
//! `tracer/tests/caller_contexts.rs` compares it.

use std::cell::Cell;
use std::ffi::c_void;

use glow::HasContext;

use super::backend::Backend;
use super::error::ERRORS_AT_MOST;

// Constants that glow does not define.
const ALPHA_TEST: u32 = 0x0BC0;
const POLYGON_STIPPLE: u32 = 0x0B42;
const CLAMP_VERTEX_COLOR: u32 = 0x891A;
const CLAMP_FRAGMENT_COLOR: u32 = 0x891B;

/// The texture unit for creating and filling textures, so that the textures bound for a pass stay bound. Every driver
/// of OpenGL 3.3 or ES 3.0 has at least 32 units.
pub(super) const SCRATCH_UNIT: u32 = 31;

/// The texture units whose bindings are restored: those that programs read from, and the scratch unit.
pub(super) const UNITS: [u32; 7] = [0, 1, 2, 3, 4, 5, SCRATCH_UNIT];

/// Pixel storage parameters of every version, with the initial values, which read-backs and uploads need.
const PIXEL_STORE: [(u32, i32); 10] = [
    (glow::PACK_ALIGNMENT, 4),
    (glow::PACK_ROW_LENGTH, 0),
    (glow::PACK_SKIP_ROWS, 0),
    (glow::PACK_SKIP_PIXELS, 0),
    (glow::UNPACK_ALIGNMENT, 4),
    (glow::UNPACK_ROW_LENGTH, 0),
    (glow::UNPACK_SKIP_ROWS, 0),
    (glow::UNPACK_SKIP_PIXELS, 0),
    (glow::UNPACK_IMAGE_HEIGHT, 0),
    (glow::UNPACK_SKIP_IMAGES, 0),
];

/// Pixel storage parameters of OpenGL only.
const PIXEL_STORE_OF_GL: [(u32, i32); 4] = [
    (glow::PACK_SWAP_BYTES, 0),
    (glow::PACK_LSB_FIRST, 0),
    (glow::UNPACK_SWAP_BYTES, 0),
    (glow::UNPACK_LSB_FIRST, 0),
];

/// Capabilities of every version that would change or discard the result of a pass. Blending and the scissor, which can
/// be set per draw buffer or viewport, are handled separately.
const CAPABILITIES: [u32; 7] = [
    glow::CULL_FACE,
    glow::DEPTH_TEST,
    glow::DITHER,
    glow::STENCIL_TEST,
    glow::SAMPLE_ALPHA_TO_COVERAGE,
    glow::SAMPLE_COVERAGE,
    glow::RASTERIZER_DISCARD,
];

/// Capabilities of OpenGL only that would change or discard the result of a pass.
const CAPABILITIES_OF_GL: [u32; 7] = [
    glow::COLOR_LOGIC_OP,
    glow::POLYGON_SMOOTH,
    glow::SAMPLE_ALPHA_TO_ONE,
    glow::SAMPLE_MASK,
    glow::PRIMITIVE_RESTART,
    glow::FRAMEBUFFER_SRGB,
    glow::DEPTH_CLAMP,
];

/// Capabilities of the compatibility profile only that would change or discard the result of a pass.
const CAPABILITIES_OF_COMPATIBILITY: [u32; 2] = [ALPHA_TEST, POLYGON_STIPPLE];

type GetBooleans = unsafe extern "system" fn(u32, u32, *mut u8);
type ClampColor = unsafe extern "system" fn(u32, u32);

/// Data of a [`Context`](super::Context) that the caller made.
pub(super) struct CallerPart {
    pub traits: Traits,
    /// Nesting depth of the calls into this crate that are in progress.
    pub entered: Cell<u32>,
}

/// The kinds of state that a context has.
pub(super) struct Traits {
    is_gl: bool,
    capabilities: Vec<u32>,
    pixel_store: Vec<(u32, i32)>,
    /// Buffer bindings: the target and the parameter that queries it.
    buffers: Vec<(u32, u32)>,
    clamps: &'static [u32],
    /// Draw buffers with separate blending and colour masks; 0 if all share the same.
    draw_buffers: u32,
    /// Whether the context has several viewports and scissors, selected by index.
    pub has_viewport_arrays: bool,
    can_pause_feedback: bool,
    get_booleans: Option<GetBooleans>,
    clamp_color: Option<ClampColor>,
}

impl Traits {
    /// Queries the context, which is current.
    pub fn of(gl: &glow::Context, backend: &dyn Backend) -> Traits {
        let version = gl.version();
        let is_gl = !version.is_embedded;
        let is_from = |major, minor| (version.major, version.minor) >= (major, minor);
        // SAFETY: the context is current, and its version has these parameters; the same holds below.
        let number = |name| unsafe { gl.get_parameter_i32(name) };
        let is_compatible = is_gl
            && number(glow::CONTEXT_PROFILE_MASK) & glow::CONTEXT_COMPATIBILITY_PROFILE_BIT as i32
                != 0;
        let mut capabilities = CAPABILITIES.to_vec();
        let mut pixel_store = PIXEL_STORE.to_vec();
        let mut buffers = vec![
            (glow::PIXEL_PACK_BUFFER, glow::PIXEL_PACK_BUFFER_BINDING),
            (glow::PIXEL_UNPACK_BUFFER, glow::PIXEL_UNPACK_BUFFER_BINDING),
        ];
        if is_gl {
            capabilities.extend(CAPABILITIES_OF_GL);
            let clip_distances = number(glow::MAX_CLIP_DISTANCES).max(0) as u32;
            capabilities.extend((glow::CLIP_DISTANCE0..).take(clip_distances as usize));
            pixel_store.extend(PIXEL_STORE_OF_GL);
            buffers.push((glow::TEXTURE_BUFFER, glow::TEXTURE_BUFFER));
        } else if is_from(3, 1) {
            capabilities.push(glow::SAMPLE_MASK);
        }
        if is_compatible {
            capabilities.extend(CAPABILITIES_OF_COMPATIBILITY);
        }
        if is_gl && is_from(4, 4) {
            buffers.push((glow::QUERY_BUFFER, glow::QUERY_BUFFER_BINDING));
        }
        Traits {
            is_gl,
            capabilities,
            pixel_store,
            buffers,
            clamps: clamps_of(is_gl, is_compatible),
            draw_buffers: match is_gl || is_from(3, 2) {
                true => number(glow::MAX_DRAW_BUFFERS).max(0) as u32,
                false => 0,
            },
            has_viewport_arrays: is_gl && is_from(4, 1),
            can_pause_feedback: !is_gl || is_from(4, 0),
            // SAFETY: the address is that of the function with this name, or null.
            get_booleans: unsafe {
                std::mem::transmute::<*const c_void, Option<GetBooleans>>(
                    backend.proc_address(c"glGetBooleani_v"),
                )
            },
            // SAFETY: as above.
            clamp_color: unsafe {
                std::mem::transmute::<*const c_void, Option<ClampColor>>(
                    backend.proc_address(c"glClampColor"),
                )
            },
        }
    }
}

/// Colour clamps. OpenGL ES has none, and only the compatibility profile clamps the colours of vertices and fragments.
fn clamps_of(is_gl: bool, is_compatible: bool) -> &'static [u32] {
    match (is_gl, is_compatible) {
        (true, true) => &[
            glow::CLAMP_READ_COLOR,
            CLAMP_VERTEX_COLOR,
            CLAMP_FRAGMENT_COLOR,
        ],
        (true, false) => &[glow::CLAMP_READ_COLOR],
        (false, _) => &[],
    }
}

/// Bindings of one texture unit.
struct Unit {
    texture: Option<glow::Texture>,
    /// OpenGL only.
    buffer_texture: Option<glow::Texture>,
    sampler: Option<glow::Sampler>,
}

/// Blending and colour mask of one draw buffer.
struct Output {
    is_blended: bool,
    mask: [bool; 4],
}

/// A saved context state.
pub(super) struct CallerState {
    is_feedback_paused: bool,
    program: Option<glow::Program>,
    vertex_array: Option<glow::VertexArray>,
    draw_framebuffer: Option<glow::Framebuffer>,
    read_framebuffer: Option<glow::Framebuffer>,
    renderbuffer: Option<glow::Renderbuffer>,
    viewport: [f32; 4],
    scissor: [i32; 4],
    is_scissored: bool,
    capabilities: Vec<(u32, bool)>,
    /// One entry for all draw buffers, or one for each.
    outputs: Vec<Output>,
    polygon_modes: [i32; 2],
    clamps: Vec<(u32, u32)>,
    pixel_store: Vec<(u32, i32)>,
    buffers: Vec<(u32, Option<glow::Buffer>)>,
    active_texture: u32,
    units: [Unit; UNITS.len()],
}

impl CallerState {
    /// Saves the state of the current context, and sets the state that passes need.
    pub fn keep(gl: &glow::Context, traits: &Traits) -> CallerState {
        // SAFETY: the context is current, and its version has all queried parameters.
        unsafe {
            forget_errors(gl);
            let kept = CallerState::ask(gl, traits);
            kept.set_needed(gl, traits);
            kept
        }
    }

    unsafe fn ask(gl: &glow::Context, traits: &Traits) -> CallerState {
        // SAFETY: as in `keep`.
        unsafe {
            let (mut viewport, mut scissor) = ([0.0; 4], [0; 4]);
            gl.get_parameter_f32_slice(glow::VIEWPORT, &mut viewport);
            gl.get_parameter_i32_slice(glow::SCISSOR_BOX, &mut scissor);
            let mut polygon_modes = [glow::FILL as i32; 2];
            if traits.is_gl {
                gl.get_parameter_i32_slice(glow::POLYGON_MODE, &mut polygon_modes);
            }
            let clamps = traits.clamp_color.map_or(&[][..], |_| traits.clamps);
            let active_texture = gl.get_parameter_i32(glow::ACTIVE_TEXTURE) as u32;
            let is_enabled = |name: &u32| (*name, gl.is_enabled(*name));
            let stored = |(name, _): &(u32, i32)| (*name, gl.get_parameter_i32(*name));
            let bound = |(target, name): &(u32, u32)| (*target, gl.get_parameter_buffer(*name));
            let clamp = |name: &u32| (*name, gl.get_parameter_i32(*name) as u32);
            CallerState {
                is_feedback_paused: pause_feedback(gl, traits),
                program: gl.get_parameter_program(glow::CURRENT_PROGRAM),
                vertex_array: gl.get_parameter_vertex_array(glow::VERTEX_ARRAY_BINDING),
                draw_framebuffer: gl.get_parameter_framebuffer(glow::DRAW_FRAMEBUFFER_BINDING),
                read_framebuffer: gl.get_parameter_framebuffer(glow::READ_FRAMEBUFFER_BINDING),
                renderbuffer: gl.get_parameter_renderbuffer(glow::RENDERBUFFER_BINDING),
                viewport,
                scissor,
                is_scissored: gl.is_enabled(glow::SCISSOR_TEST),
                capabilities: traits.capabilities.iter().map(is_enabled).collect(),
                outputs: outputs(gl, traits),
                polygon_modes,
                clamps: clamps.iter().map(clamp).collect(),
                pixel_store: traits.pixel_store.iter().map(stored).collect(),
                buffers: traits.buffers.iter().map(bound).collect(),
                active_texture,
                units: UNITS.map(|unit| unit_of(gl, traits, unit)),
            }
        }
    }

    /// Sets the state that passes, uploads and read-backs need and do not set themselves.
    unsafe fn set_needed(&self, gl: &glow::Context, traits: &Traits) {
        // SAFETY: as in `keep`.
        unsafe {
            for (name, is_enabled) in &self.capabilities {
                if *is_enabled {
                    gl.disable(*name);
                }
            }
            if traits.is_gl {
                gl.polygon_mode(glow::FRONT_AND_BACK, glow::FILL);
            }
            if let Some(clamp_color) = traits.clamp_color {
                for (target, _) in &self.clamps {
                    clamp_color(*target, glow::FALSE.into());
                }
            }
            for (name, needed) in &traits.pixel_store {
                gl.pixel_store_i32(*name, *needed);
            }
            for (target, _) in &self.buffers {
                gl.bind_buffer(*target, None);
            }
            for unit in UNITS {
                gl.bind_sampler(unit, None);
            }
        }
    }

    /// Restores the state; the context is current.
    pub fn put_back(&self, gl: &glow::Context, traits: &Traits) {
        // SAFETY: the context is current, and every object bound here was bound before.
        unsafe {
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, self.draw_framebuffer);
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, self.read_framebuffer);
            gl.bind_renderbuffer(glow::RENDERBUFFER, self.renderbuffer);
            gl.bind_vertex_array(self.vertex_array);
            // A program that was marked for deletion while in use no longer exists.
            gl.use_program(self.program.filter(|program| gl.is_program(*program)));
            if self.is_feedback_paused {
                gl.resume_transform_feedback();
            }
            for (name, is_enabled) in &self.capabilities {
                switch(gl, *name, *is_enabled);
            }
            self.put_back_area(gl, traits);
            self.put_back_outputs(gl);
            self.put_back_pixels(gl, traits);
            for (unit, number) in self.units.iter().zip(UNITS) {
                gl.active_texture(glow::TEXTURE0 + number);
                gl.bind_texture(glow::TEXTURE_2D, unit.texture);
                if traits.is_gl {
                    gl.bind_texture(glow::TEXTURE_BUFFER, unit.buffer_texture);
                }
                gl.bind_sampler(number, unit.sampler);
            }
            gl.active_texture(self.active_texture);
        }
    }

    unsafe fn put_back_area(&self, gl: &glow::Context, traits: &Traits) {
        // SAFETY: as in `put_back`; the indexed functions exist if there are several viewports.
        unsafe {
            let [x, y, width, height] = self.scissor;
            if traits.has_viewport_arrays {
                gl.viewport_f32_slice(0, 1, &[self.viewport]);
                gl.scissor_slice(0, 1, &[self.scissor]);
            } else {
                gl.scissor(x, y, width, height);
                let [x, y, width, height] = self.viewport.map(|number| number as i32);
                gl.viewport(x, y, width, height);
            }
        }
        set_scissor_test(gl, traits, self.is_scissored);
    }

    unsafe fn put_back_outputs(&self, gl: &glow::Context) {
        let Some(first) = self.outputs.first() else {
            return;
        };
        // SAFETY: as in `put_back`; the indexed functions exist if there are several draw buffers.
        unsafe {
            // The call without an index comes first, because Mesa's glthread derives the result of
            // glIsEnabled(GL_BLEND) from the last such call.
            switch(gl, glow::BLEND, first.is_blended);
            let [red, green, blue, alpha] = first.mask;
            gl.color_mask(red, green, blue, alpha);
            for (number, output) in (0..).zip(&self.outputs) {
                if output.is_blended != first.is_blended {
                    match output.is_blended {
                        true => gl.enable_draw_buffer(glow::BLEND, number),
                        false => gl.disable_draw_buffer(glow::BLEND, number),
                    }
                }
                if output.mask != first.mask {
                    let [red, green, blue, alpha] = output.mask;
                    gl.color_mask_draw_buffer(number, red, green, blue, alpha);
                }
            }
        }
    }

    unsafe fn put_back_pixels(&self, gl: &glow::Context, traits: &Traits) {
        // SAFETY: as in `put_back`.
        unsafe {
            if traits.is_gl {
                self.put_back_polygon_modes(gl);
            }
            if let Some(clamp_color) = traits.clamp_color {
                for (target, clamp) in &self.clamps {
                    clamp_color(*target, *clamp);
                }
            }
            for (name, value) in &self.pixel_store {
                gl.pixel_store_i32(*name, *value);
            }
            for (target, buffer) in &self.buffers {
                gl.bind_buffer(*target, *buffer);
            }
        }
    }

    unsafe fn put_back_polygon_modes(&self, gl: &glow::Context) {
        let [front, back] = self.polygon_modes.map(|mode| mode as u32);
        // SAFETY: as in `put_back`; front and back differ in the compatibility profile only.
        unsafe {
            if front == back || back == 0 {
                gl.polygon_mode(glow::FRONT_AND_BACK, front);
            } else {
                gl.polygon_mode(glow::FRONT, front);
                gl.polygon_mode(glow::BACK, back);
            }
        }
    }
}

/// Turns the scissor on or off for passes; the context is current.
pub(super) fn set_scissor_test(gl: &glow::Context, traits: &Traits, is_on: bool) {
    // SAFETY: the context is current, and the indexed functions exist if there are several scissors.
    unsafe {
        match (traits.has_viewport_arrays, is_on) {
            (true, true) => gl.enable_draw_buffer(glow::SCISSOR_TEST, 0),
            (true, false) => gl.disable_draw_buffer(glow::SCISSOR_TEST, 0),
            (false, is_on) => switch(gl, glow::SCISSOR_TEST, is_on),
        }
    }
}

unsafe fn switch(gl: &glow::Context, name: u32, is_on: bool) {
    // SAFETY: guaranteed by the caller: the context is current and has the capability.
    unsafe {
        if is_on {
            gl.enable(name);
        } else {
            gl.disable(name);
        }
    }
}

/// Pauses a transform feedback in progress, because no other program can be used while it is active. Returns whether a
/// transform feedback was in progress.
unsafe fn pause_feedback(gl: &glow::Context, traits: &Traits) -> bool {
    // SAFETY: guaranteed by the caller: the context is current.
    unsafe {
        let is_under_way = traits.can_pause_feedback
            && gl.get_parameter_bool(glow::TRANSFORM_FEEDBACK_ACTIVE)
            && !gl.get_parameter_bool(glow::TRANSFORM_FEEDBACK_PAUSED);
        if is_under_way {
            gl.pause_transform_feedback();
        }
        is_under_way
    }
}

unsafe fn outputs(gl: &glow::Context, traits: &Traits) -> Vec<Output> {
    // SAFETY: guaranteed by the caller: the context is current.
    unsafe {
        let first_mask = gl.get_parameter_bool_array::<4>(glow::COLOR_WRITEMASK);
        if traits.draw_buffers == 0 {
            return vec![Output {
                is_blended: gl.is_enabled(glow::BLEND),
                mask: first_mask,
            }];
        }
        let mask = |number| {
            let Some(get_booleans) = traits.get_booleans else {
                return first_mask;
            };
            let mut mask = [0; 4];
            get_booleans(glow::COLOR_WRITEMASK, number, mask.as_mut_ptr());
            mask.map(|channel| channel != 0)
        };
        (0..traits.draw_buffers)
            .map(|number| Output {
                is_blended: gl.get_parameter_indexed_i32(glow::BLEND, number) != 0,
                mask: mask(number),
            })
            .collect()
    }
}

unsafe fn unit_of(gl: &glow::Context, traits: &Traits, unit: u32) -> Unit {
    // SAFETY: guaranteed by the caller: the context is current.
    unsafe {
        gl.active_texture(glow::TEXTURE0 + unit);
        Unit {
            texture: gl.get_parameter_texture(glow::TEXTURE_BINDING_2D),
            buffer_texture: match traits.is_gl {
                true => gl.get_parameter_texture(glow::TEXTURE_BINDING_BUFFER),
                false => None,
            },
            sampler: gl.get_parameter_sampler(glow::SAMPLER_BINDING),
        }
    }
}

/// Clears errors that the caller has not queried; otherwise they would be attributed to this crate.
unsafe fn forget_errors(gl: &glow::Context) {
    for _ in 0..ERRORS_AT_MOST {
        // SAFETY: guaranteed by the caller: the context is current.
        if unsafe { gl.get_error() } == glow::NO_ERROR {
            return;
        }
    }
}

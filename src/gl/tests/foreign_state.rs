//! Context state that would spoil any pass, and queries of that state.

use super::foreign_program::{ForeignProgram, Kind};
use glow::HasContext;
use std::fmt::Debug;

/// Maximum numbers per parameter.
const MOST_NUMBERS: usize = 16;

// Constants that glow does not define.
const ALPHA_TEST: u32 = 0x0BC0;
const POLYGON_STIPPLE: u32 = 0x0B42;
const CLAMP_FRAGMENT_COLOR: u32 = 0x891B;

/// The texture units that the tests compare.
const UNITS: [u32; 8] = [0, 1, 2, 3, 4, 5, 7, 31];

/// Parameters of every version, except capabilities.
const PARAMETERS: [u32; 62] = [
    glow::CURRENT_PROGRAM,
    glow::VERTEX_ARRAY_BINDING,
    glow::DRAW_FRAMEBUFFER_BINDING,
    glow::READ_FRAMEBUFFER_BINDING,
    glow::RENDERBUFFER_BINDING,
    glow::ARRAY_BUFFER_BINDING,
    glow::ELEMENT_ARRAY_BUFFER_BINDING,
    glow::PIXEL_PACK_BUFFER_BINDING,
    glow::PIXEL_UNPACK_BUFFER_BINDING,
    glow::UNIFORM_BUFFER_BINDING,
    glow::TRANSFORM_FEEDBACK_BUFFER_BINDING,
    glow::COPY_READ_BUFFER_BINDING,
    glow::COPY_WRITE_BUFFER_BINDING,
    glow::ACTIVE_TEXTURE,
    glow::VIEWPORT,
    glow::SCISSOR_BOX,
    glow::COLOR_WRITEMASK,
    glow::COLOR_CLEAR_VALUE,
    glow::BLEND_SRC_RGB,
    glow::BLEND_DST_RGB,
    glow::BLEND_SRC_ALPHA,
    glow::BLEND_DST_ALPHA,
    glow::BLEND_EQUATION_RGB,
    glow::BLEND_EQUATION_ALPHA,
    glow::BLEND_COLOR,
    glow::CULL_FACE_MODE,
    glow::FRONT_FACE,
    glow::DEPTH_FUNC,
    glow::DEPTH_WRITEMASK,
    glow::DEPTH_RANGE,
    glow::DEPTH_CLEAR_VALUE,
    glow::STENCIL_FUNC,
    glow::STENCIL_REF,
    glow::STENCIL_VALUE_MASK,
    glow::STENCIL_WRITEMASK,
    glow::STENCIL_FAIL,
    glow::STENCIL_PASS_DEPTH_FAIL,
    glow::STENCIL_PASS_DEPTH_PASS,
    glow::STENCIL_CLEAR_VALUE,
    glow::SAMPLE_COVERAGE_VALUE,
    glow::SAMPLE_COVERAGE_INVERT,
    glow::PACK_ALIGNMENT,
    glow::PACK_ROW_LENGTH,
    glow::PACK_SKIP_ROWS,
    glow::PACK_SKIP_PIXELS,
    glow::UNPACK_ALIGNMENT,
    glow::UNPACK_ROW_LENGTH,
    glow::UNPACK_SKIP_ROWS,
    glow::UNPACK_SKIP_PIXELS,
    glow::UNPACK_IMAGE_HEIGHT,
    glow::UNPACK_SKIP_IMAGES,
    glow::READ_BUFFER,
    glow::DRAW_BUFFER0,
    glow::DRAW_BUFFER1,
    glow::LINE_WIDTH,
    glow::POLYGON_OFFSET_FACTOR,
    glow::POLYGON_OFFSET_UNITS,
    glow::FRAGMENT_SHADER_DERIVATIVE_HINT,
    glow::TRANSFORM_FEEDBACK_BINDING,
    glow::TRANSFORM_FEEDBACK_ACTIVE,
    glow::TRANSFORM_FEEDBACK_PAUSED,
    glow::SAMPLES,
];

/// Parameters of OpenGL 4.5 only.
const PARAMETERS_OF_GL: [u32; 15] = [
    glow::POLYGON_MODE,
    glow::LOGIC_OP_MODE,
    glow::PROVOKING_VERTEX,
    glow::PRIMITIVE_RESTART_INDEX,
    glow::POINT_SIZE,
    glow::CLAMP_READ_COLOR,
    glow::TEXTURE_BUFFER,
    glow::QUERY_BUFFER_BINDING,
    glow::DRAW_INDIRECT_BUFFER_BINDING,
    glow::PROGRAM_PIPELINE_BINDING,
    glow::PACK_SWAP_BYTES,
    glow::PACK_LSB_FIRST,
    glow::UNPACK_SWAP_BYTES,
    glow::UNPACK_LSB_FIRST,
    glow::PATCH_VERTICES,
];

/// Capabilities of every version.
const CAPABILITIES: [u32; 11] = [
    glow::BLEND,
    glow::CULL_FACE,
    glow::DEPTH_TEST,
    glow::DITHER,
    glow::POLYGON_OFFSET_FILL,
    glow::SAMPLE_ALPHA_TO_COVERAGE,
    glow::SAMPLE_COVERAGE,
    glow::SCISSOR_TEST,
    glow::STENCIL_TEST,
    glow::RASTERIZER_DISCARD,
    glow::PRIMITIVE_RESTART_FIXED_INDEX,
];

/// Capabilities of OpenGL only.
const CAPABILITIES_OF_GL: [u32; 12] = [
    glow::COLOR_LOGIC_OP,
    glow::POLYGON_SMOOTH,
    glow::LINE_SMOOTH,
    glow::MULTISAMPLE,
    glow::SAMPLE_ALPHA_TO_ONE,
    glow::SAMPLE_MASK,
    glow::PRIMITIVE_RESTART,
    glow::FRAMEBUFFER_SRGB,
    glow::DEPTH_CLAMP,
    glow::PROGRAM_POINT_SIZE,
    glow::CLIP_DISTANCE0,
    glow::CLIP_DISTANCE0 + 5,
];

type GetIndexed<T> = unsafe extern "system" fn(u32, u32, *mut T);
type ClampColor = unsafe extern "system" fn(u32, u32);

impl ForeignProgram {
    /// Sets all state that would spoil a pass, an upload or a read-back.
    pub fn spoil(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            self.spoil_objects();
            self.spoil_tests();
            for (name, value) in [
                (glow::PACK_ALIGNMENT, 8),
                (glow::PACK_ROW_LENGTH, 77),
                (glow::PACK_SKIP_ROWS, 3),
                (glow::PACK_SKIP_PIXELS, 5),
                (glow::UNPACK_ALIGNMENT, 8),
                (glow::UNPACK_ROW_LENGTH, 99),
                (glow::UNPACK_SKIP_ROWS, 2),
                (glow::UNPACK_SKIP_PIXELS, 1),
                (glow::UNPACK_IMAGE_HEIGHT, 7),
                (glow::UNPACK_SKIP_IMAGES, 1),
            ] {
                gl.pixel_store_i32(name, value);
            }
            if self.kind != Kind::Es {
                self.spoil_gl();
            }
            assert_eq!(gl.get_error(), glow::NO_ERROR);
        }
    }

    unsafe fn spoil_objects(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffers[1]));
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(gl.create_renderbuffer().unwrap()));
            for target in [
                glow::ARRAY_BUFFER,
                glow::PIXEL_PACK_BUFFER,
                glow::PIXEL_UNPACK_BUFFER,
                glow::UNIFORM_BUFFER,
                glow::COPY_READ_BUFFER,
            ] {
                gl.bind_buffer(target, Some(gl.create_buffer().unwrap()));
                gl.buffer_data_size(target, 64, glow::STATIC_DRAW);
            }
            for unit in UNITS {
                gl.active_texture(glow::TEXTURE0 + unit);
                for target in [glow::TEXTURE_2D, glow::TEXTURE_3D] {
                    gl.bind_texture(target, Some(gl.create_texture().unwrap()));
                }
                let sampler = gl.create_sampler().unwrap();
                let (name, value) = (glow::TEXTURE_MIN_FILTER, glow::LINEAR_MIPMAP_LINEAR);
                gl.sampler_parameter_i32(sampler, name, value as i32);
                gl.bind_sampler(unit, Some(sampler));
            }
            gl.active_texture(glow::TEXTURE7);
        }
    }

    unsafe fn spoil_tests(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            gl.viewport(3, 1, 5, 2);
            gl.scissor(1, 2, 3, 1);
            gl.cull_face(glow::FRONT_AND_BACK);
            gl.front_face(glow::CW);
            gl.depth_func(glow::NEVER);
            gl.depth_range_f32(0.25, 0.5);
            gl.stencil_func(glow::NEVER, 3, 5);
            gl.blend_func(glow::ZERO, glow::CONSTANT_ALPHA);
            gl.blend_equation(glow::MIN);
            gl.blend_color(0.1, 0.2, 0.3, 0.4);
            gl.color_mask(false, true, false, false);
            gl.sample_coverage(0.0, false);
            for name in [
                glow::CULL_FACE,
                glow::DEPTH_TEST,
                glow::STENCIL_TEST,
                glow::SCISSOR_TEST,
                glow::SAMPLE_COVERAGE,
                glow::SAMPLE_ALPHA_TO_COVERAGE,
                glow::RASTERIZER_DISCARD,
                glow::POLYGON_OFFSET_FILL,
                glow::PRIMITIVE_RESTART_FIXED_INDEX,
            ] {
                gl.enable(name);
            }
            for number in [0, 2] {
                gl.disable_draw_buffer(glow::BLEND, 1);
                gl.enable_draw_buffer(glow::BLEND, number);
                gl.color_mask_draw_buffer(1 + number, true, false, true, number == 0);
            }
        }
    }

    unsafe fn spoil_gl(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            for name in CAPABILITIES_OF_GL {
                gl.enable(name);
            }
            gl.polygon_mode(glow::FRONT_AND_BACK, glow::POINT);
            for name in [
                glow::PACK_SWAP_BYTES,
                glow::PACK_LSB_FIRST,
                glow::UNPACK_SWAP_BYTES,
                glow::UNPACK_LSB_FIRST,
            ] {
                gl.pixel_store_bool(name, true);
            }
            for target in [glow::TEXTURE_BUFFER, glow::QUERY_BUFFER] {
                gl.bind_buffer(target, Some(gl.create_buffer().unwrap()));
            }
            for unit in UNITS {
                gl.active_texture(glow::TEXTURE0 + unit);
                gl.bind_texture(glow::TEXTURE_BUFFER, Some(gl.create_texture().unwrap()));
            }
            // Mesa 22 writes to its input numbers, so they must not be constants.
            let viewports = [[0.5, 1.5, 7.25, 3.0], [1.0, 1.0, 2.0, 2.0]];
            gl.viewport_f32_slice(0, 2, &std::hint::black_box(viewports));
            gl.scissor_slice(1, 1, &[[4, 3, 2, 1]]);
            gl.disable_draw_buffer(glow::SCISSOR_TEST, 2);
            self.function::<ClampColor>("glClampColor")(glow::CLAMP_READ_COLOR, glow::TRUE.into());
            if self.kind == Kind::Compatibility {
                gl.enable(ALPHA_TEST);
                gl.enable(POLYGON_STIPPLE);
                let clamp = self.function::<ClampColor>("glClampColor");
                clamp(CLAMP_FRAGMENT_COLOR, glow::TRUE.into());
                gl.polygon_mode(glow::FRONT, glow::LINE);
            }
        }
    }

    /// Resets the spoiled state that the lowest versions lack: the buffer for query results, and the viewport with
    /// fractional coordinates.
    pub fn spoil_no_newer(&self) {
        // SAFETY: the program's own context is current while a test calls this.
        unsafe {
            if self.kind != Kind::Es {
                self.gl.bind_buffer(glow::QUERY_BUFFER, None);
            }
            self.gl.viewport(3, 1, 5, 2);
        }
    }

    /// All compared state, with names.
    pub fn state(&self) -> Vec<String> {
        let gl = &self.gl;
        let mut state = Vec::new();
        let mut tell = |name: String, value: &dyn Debug| state.push(format!("{name}: {value:?}"));
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            assert_eq!(gl.get_error(), glow::NO_ERROR);
            let is_gl = self.kind != Kind::Es;
            let more: (&[u32], &[u32]) = match is_gl {
                true => (&PARAMETERS_OF_GL, &CAPABILITIES_OF_GL),
                false => (&[], &[]),
            };
            for name in PARAMETERS.iter().chain(more.0) {
                let mut numbers = [0.0; MOST_NUMBERS];
                gl.get_parameter_f32_slice(*name, &mut numbers);
                tell(format!("parameter {name:#x}"), &numbers);
            }
            for name in CAPABILITIES.iter().chain(more.1) {
                tell(format!("capability {name:#x}"), &gl.is_enabled(*name));
            }
            let active_texture = gl.get_parameter_i32(glow::ACTIVE_TEXTURE) as u32;
            for unit in UNITS {
                gl.active_texture(glow::TEXTURE0 + unit);
                let mut names = vec![
                    glow::TEXTURE_BINDING_2D,
                    glow::TEXTURE_BINDING_3D,
                    glow::SAMPLER_BINDING,
                ];
                names.extend(is_gl.then_some(glow::TEXTURE_BINDING_BUFFER));
                for name in names {
                    tell(
                        format!("unit {unit}, {name:#x}"),
                        &gl.get_parameter_i32(name),
                    );
                }
            }
            gl.active_texture(active_texture);
            if self.kind == Kind::Compatibility {
                tell("alpha test".into(), &gl.is_enabled(ALPHA_TEST));
                tell("stipple".into(), &gl.is_enabled(POLYGON_STIPPLE));
                let clamp = gl.get_parameter_i32(CLAMP_FRAGMENT_COLOR);
                tell("clamp".into(), &clamp);
            }
            self.indexed_state(&mut tell);
            // Parameters that a version lacks cause an error and are compared as zeros.
            while gl.get_error() != glow::NO_ERROR {}
        }
        state
    }

    /// The state of each draw buffer, viewport and scissor.
    unsafe fn indexed_state(&self, tell: &mut dyn FnMut(String, &dyn Debug)) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this.
        unsafe {
            for number in 0..4 {
                let mut mask = [0_u8; 4];
                let get = self.function::<GetIndexed<u8>>("glGetBooleani_v");
                get(glow::COLOR_WRITEMASK, number, mask.as_mut_ptr());
                tell(format!("mask {number}"), &mask);
                let is_blended = gl.get_parameter_indexed_i32(glow::BLEND, number);
                tell(format!("blending {number}"), &is_blended);
            }
            for number in 0..if self.kind != Kind::Es { 4 } else { 0 } {
                let (mut viewport, mut scissor) = ([0.0_f32; 4], [0_i32; 4]);
                let get = self.function::<GetIndexed<f32>>("glGetFloati_v");
                get(glow::VIEWPORT, number, viewport.as_mut_ptr());
                let get = self.function::<GetIndexed<i32>>("glGetIntegeri_v");
                get(glow::SCISSOR_BOX, number, scissor.as_mut_ptr());
                let is_scissored = gl.get_parameter_indexed_i32(glow::SCISSOR_TEST, number);
                tell(format!("area {number}"), &(viewport, scissor, is_scissored));
            }
        }
    }
}

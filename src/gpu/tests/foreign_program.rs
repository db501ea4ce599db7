//! A program that draws with a context of its own, in a state that would spoil any pass, and that asks for all of it.

use super::raw_egl::{Kind, RawEgl};
use glow::{HasContext, PixelPackData, PixelUnpackData};
use std::fmt::Debug;
use std::rc::Rc;

/// Numbers that one parameter has at most.
const MOST_NUMBERS: usize = 16;

// What glow has no names for.
const ALPHA_TEST: u32 = 0x0BC0;
const POLYGON_STIPPLE: u32 = 0x0B42;
const CLAMP_FRAGMENT_COLOR: u32 = 0x891B;

/// Texture units that are looked at.
const UNITS: [u32; 7] = [0, 1, 2, 3, 4, 7, 31];

/// Parameters of every version, besides capabilities.
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

/// Parameters of OpenGL 4.5 alone.
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

/// Capabilities of OpenGL alone.
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

/// Side of the picture that the program draws.
const SIDE: i32 = 8;

type GetIndexed<T> = unsafe extern "system" fn(u32, u32, *mut T);
type IsObject = unsafe extern "system" fn(u32) -> u8;
type ClampColor = unsafe extern "system" fn(u32, u32);

/// The program, whose context is current from its making on.
pub struct ForeignProgram {
    pub egl: Rc<RawEgl>,
    gl: glow::Context,
    kind: Kind,
    program: glow::Program,
    framebuffers: [glow::Framebuffer; 2],
    feedback: glow::Buffer,
}

impl ForeignProgram {
    /// A program with a picture to draw to, half of which its triangles cover; what is drawn is what is there plus a
    /// quarter.
    pub fn new(kind: Kind) -> ForeignProgram {
        let egl = Rc::new(RawEgl::of(kind));
        egl.bind();
        let gl = egl.gl();
        // SAFETY: the context is current, and all objects are its own; so in all of this file.
        unsafe {
            let program = program(&gl, kind);
            let framebuffers = [0, 1].map(|_| framebuffer(&gl));
            let feedback = gl.create_buffer().unwrap();
            gl.use_program(Some(program));
            gl.bind_vertex_array(Some(gl.create_vertex_array().unwrap()));
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffers[0]));
            gl.viewport(0, 0, SIDE, SIDE);
            gl.enable(glow::SCISSOR_TEST);
            gl.scissor(0, 0, SIDE / 2, SIDE);
            gl.enable(glow::BLEND);
            gl.blend_func(glow::ONE, glow::ONE);
            gl.color_mask(true, true, false, true);
            ForeignProgram {
                egl,
                gl,
                kind,
                program,
                framebuffers,
                feedback,
            }
        }
    }

    /// Draws once more, with the state as it stands.
    pub fn draw(&self) {
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) };
    }

    /// The picture, of four bytes a pixel.
    pub fn picture(&self) -> Vec<u8> {
        let mut pixels = vec![0; (4 * SIDE * SIDE) as usize];
        let slice = PixelPackData::Slice(Some(&mut pixels));
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe {
            let (format, kind) = (glow::RGBA, glow::UNSIGNED_BYTE);
            self.gl.read_pixels(0, 0, SIDE, SIDE, format, kind, slice);
        }
        pixels
    }

    /// What the picture is after so many draws: red in the left half, and no blue.
    pub fn expected_picture(draws: u8) -> Vec<u8> {
        let pixel = |index| match index % SIDE < SIDE / 2 {
            true => [64 * draws, 0, 0, 64 * draws],
            false => [0; 4],
        };
        (0..SIDE * SIDE).flat_map(pixel).collect()
    }

    /// An error that the program has not asked for.
    pub fn make_an_error(&self) {
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe { self.gl.enable(0xFFFF) };
    }

    /// Sets whatever would spoil a pass, an upload or a read-back.
    pub fn spoil(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
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
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
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
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
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
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
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
            // Mesa 22 writes to the numbers that it is given: they must not be constants.
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

    /// Begins to write what the vertex shader computes into a buffer.
    pub fn begin_feedback(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe {
            gl.bind_buffer(glow::TRANSFORM_FEEDBACK_BUFFER, Some(self.feedback));
            let target = glow::TRANSFORM_FEEDBACK_BUFFER;
            gl.buffer_data_size(target, 6 * 4, glow::STATIC_READ);
            gl.bind_buffer_base(target, 0, Some(self.feedback));
            gl.begin_transform_feedback(glow::TRIANGLES);
            assert_eq!(gl.get_error(), glow::NO_ERROR);
        }
    }

    /// Ends that, and gives what was written: the vertices' numbers.
    pub fn end_feedback(&self) -> Vec<f32> {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe {
            gl.end_transform_feedback();
            let target = glow::TRANSFORM_FEEDBACK_BUFFER;
            let mapped = gl.map_buffer_range(target, 0, 6 * 4, glow::MAP_READ_BIT);
            let written = std::slice::from_raw_parts(mapped.cast::<f32>(), 6).to_vec();
            gl.unmap_buffer(target);
            written
        }
    }

    /// All state that is looked at, with names.
    pub fn state(&self) -> Vec<String> {
        let gl = &self.gl;
        let mut state = Vec::new();
        let mut tell = |name: String, value: &dyn Debug| state.push(format!("{name}: {value:?}"));
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
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
            for number in 0..4 {
                let mut mask = [0_u8; 4];
                let get = self.function::<GetIndexed<u8>>("glGetBooleani_v");
                get(glow::COLOR_WRITEMASK, number, mask.as_mut_ptr());
                tell(format!("mask {number}"), &mask);
                let is_blended = gl.get_parameter_indexed_i32(glow::BLEND, number);
                tell(format!("blending {number}"), &is_blended);
            }
            if self.kind == Kind::Compatibility {
                tell("alpha test".into(), &gl.is_enabled(ALPHA_TEST));
                tell("stipple".into(), &gl.is_enabled(POLYGON_STIPPLE));
                let clamp = gl.get_parameter_i32(CLAMP_FRAGMENT_COLOR);
                tell("clamp".into(), &clamp);
            }
            for number in 0..if is_gl { 4 } else { 0 } {
                let (mut viewport, mut scissor) = ([0.0_f32; 4], [0_i32; 4]);
                let get = self.function::<GetIndexed<f32>>("glGetFloati_v");
                get(glow::VIEWPORT, number, viewport.as_mut_ptr());
                let get = self.function::<GetIndexed<i32>>("glGetIntegeri_v");
                get(glow::SCISSOR_BOX, number, scissor.as_mut_ptr());
                let is_scissored = gl.get_parameter_indexed_i32(glow::SCISSOR_TEST, number);
                tell(format!("area {number}"), &(viewport, scissor, is_scissored));
            }
            // What a version does not know is an error, and compared as zeros.
            while gl.get_error() != glow::NO_ERROR {}
        }
        state
    }

    /// How many objects of each kind there are: textures, buffers, programs, vertex arrays, framebuffers, samplers.
    pub fn objects(&self) -> [usize; 5] {
        let gl = &self.gl;
        let names = || (1..500).map(|name| std::num::NonZeroU32::new(name).unwrap());
        let count = |is: &dyn Fn(std::num::NonZeroU32) -> bool| names().filter(|n| is(*n)).count();
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe {
            let is_vertex_array = self.function::<IsObject>("glIsVertexArray");
            [
                count(&|name| gl.is_texture(glow::NativeTexture(name))),
                count(&|name| gl.is_buffer(glow::NativeBuffer(name))),
                count(&|name| gl.is_program(glow::NativeProgram(name))),
                count(&|name| is_vertex_array(name.get()) != 0),
                count(&|name| gl.is_framebuffer(glow::NativeFramebuffer(name))),
            ]
        }
    }

    /// Whether the program's shaders are what it draws with.
    pub fn is_in_use(&self) -> bool {
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe { self.gl.get_parameter_program(glow::CURRENT_PROGRAM) == Some(self.program) }
    }

    /// The texels of a texture of four floats that is not the program's own.
    pub fn texels(&self, texture: glow::Texture, width: u32, height: u32) -> Vec<[f32; 4]> {
        let gl = &self.gl;
        let mut bytes = vec![0; 16 * (width * height) as usize];
        // SAFETY: the program's own context is current while a test calls this, and the names are its own.
        unsafe {
            let framebuffer = gl.create_framebuffer().unwrap();
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            let (target, point) = (glow::FRAMEBUFFER, glow::COLOR_ATTACHMENT0);
            gl.framebuffer_texture_2d(target, point, glow::TEXTURE_2D, Some(texture), 0);
            let slice = PixelPackData::Slice(Some(&mut bytes));
            let (width, height) = (width as i32, height as i32);
            gl.read_pixels(0, 0, width, height, glow::RGBA, glow::FLOAT, slice);
        }
        let number = |four: &[u8]| f32::from_ne_bytes(four.try_into().unwrap());
        let texel = |bytes: &[u8]| std::array::from_fn(|i| number(&bytes[4 * i..4 * i + 4]));
        bytes.chunks_exact(16).map(texel).collect()
    }

    /// A function that glow has not, or has with less.
    unsafe fn function<T: Copy>(&self, name: &str) -> T {
        let address = self.egl.address(&std::ffi::CString::new(name).unwrap());
        assert!(!address.is_null(), "{name}");
        assert_eq!(size_of::<T>(), size_of_val(&address));
        // SAFETY: T is the type of the function of this name.
        unsafe { std::mem::transmute_copy(&address) }
    }
}

/// A program that covers everything with a quarter of red and of blue, and writes the vertices' numbers.
unsafe fn program(gl: &glow::Context, kind: Kind) -> glow::Program {
    let header = match kind {
        Kind::Es => "#version 300 es\nprecision highp float;\n",
        Kind::Core | Kind::Compatibility => "#version 330 core\n",
    };
    let vertex = "out float number; void main() { number = float(gl_VertexID);\
        gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";
    let fragment =
        "out vec4 colour; void main() { colour = vec4(0.2509804, 0.0, 0.25, 0.2509804); }";
    // SAFETY: the caller's: the context is current.
    unsafe {
        let program = gl.create_program().unwrap();
        for (stage, text) in [
            (glow::VERTEX_SHADER, vertex),
            (glow::FRAGMENT_SHADER, fragment),
        ] {
            let shader = gl.create_shader(stage).unwrap();
            gl.shader_source(shader, &format!("{header}{text}"));
            gl.compile_shader(shader);
            gl.attach_shader(program, shader);
        }
        gl.transform_feedback_varyings(program, &["number"], glow::INTERLEAVED_ATTRIBS);
        gl.link_program(program);
        let log = gl.get_program_info_log(program);
        assert!(gl.get_program_link_status(program), "{log}");
        program
    }
}

/// A framebuffer with a picture that is black.
unsafe fn framebuffer(gl: &glow::Context) -> glow::Framebuffer {
    // SAFETY: the caller's: the context is current.
    unsafe {
        let texture = gl.create_texture().unwrap();
        gl.bind_texture(glow::TEXTURE_2D, Some(texture));
        let (format, kind) = (glow::RGBA, glow::UNSIGNED_BYTE);
        let none = PixelUnpackData::Slice(None);
        let internal = glow::RGBA8 as i32;
        gl.tex_image_2d(
            glow::TEXTURE_2D,
            0,
            internal,
            SIDE,
            SIDE,
            0,
            format,
            kind,
            none,
        );
        let framebuffer = gl.create_framebuffer().unwrap();
        let (target, point) = (glow::FRAMEBUFFER, glow::COLOR_ATTACHMENT0);
        gl.bind_framebuffer(target, Some(framebuffer));
        gl.framebuffer_texture_2d(target, point, glow::TEXTURE_2D, Some(texture), 0);
        gl.clear(glow::COLOR_BUFFER_BIT);
        framebuffer
    }
}

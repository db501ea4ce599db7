//! A test program that draws with its own context, made with raw EGL calls and without this crate.

use crate::gl::SwitchContext;
use glow::{HasContext, PixelPackData, PixelUnpackData};
use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Version};
use glutin::display::{AsRawDisplay, DisplayFeatures, RawDisplay};
use glutin::prelude::*;
use std::ffi::{CStr, CString, c_void};
use std::rc::Rc;

/// Raw EGL calls, as used by a program that does not know echomarch's contexts.
pub struct RawEgl {
    egl: &'static glutin::api::egl::Egl,
    display: Display,
    context: PossiblyCurrentContext,
}

/// The kind of context that a program makes for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Core,
    Compatibility,
    Es,
}

impl Kind {
    pub const ALL: [Kind; 3] = [Kind::Core, Kind::Compatibility, Kind::Es];

    fn apis(self) -> (ConfigApi, ContextApi, GlProfile) {
        let gl = ContextApi::OpenGl(Some(Version::new(3, 3)));
        match self {
            Kind::Core => (ConfigApi::OPENGL, gl, GlProfile::Core),
            Kind::Compatibility => (ConfigApi::OPENGL, gl, GlProfile::Compatibility),
            Kind::Es => {
                let es = ContextApi::Gles(Some(Version::new(3, 0)));
                (ConfigApi::GLES3, es, GlProfile::Core)
            }
        }
    }
}

impl RawEgl {
    /// Creates a context of the program's own on the first device that allows one; it is not current.
    pub fn new() -> RawEgl {
        RawEgl::of(Kind::Core)
    }

    /// Like [`new`](RawEgl::new), for a given kind of context.
    pub fn of(kind: Kind) -> RawEgl {
        let (config_api, context_api, profile) = kind.apis();
        let made = Device::query_devices().unwrap().find_map(|device| {
            // SAFETY: the call uses neither a native display nor a window, and shares no context.
            unsafe {
                let display = Display::with_device(&device, None).ok()?;
                let template = ConfigTemplateBuilder::new()
                    .with_surface_type(ConfigSurfaceTypes::empty())
                    .with_api(config_api)
                    .build();
                let config = display.find_configs(template).ok()?.next()?;
                let attributes = ContextAttributesBuilder::new()
                    .with_profile(profile)
                    .with_context_api(context_api)
                    .build(None);
                let context = display.create_context(&config, &attributes).ok()?;
                let egl = display.egl();
                let context = context.treat_as_possibly_current();
                Some(RawEgl {
                    egl,
                    display,
                    context,
                })
            }
        });
        made.unwrap()
    }

    /// Makes the context current.
    pub fn bind(&self) {
        self.context.make_current_surfaceless().unwrap();
    }

    /// Leaves the thread without a current context.
    pub fn unbind(&self) {
        let RawDisplay::Egl(display) = self.display.raw_display();
        let none = std::ptr::null();
        // SAFETY: the display lives, and null means none.
        unsafe { self.egl.MakeCurrent(display, none, none, none) };
    }

    /// Whether EGL reports the context as current.
    pub fn is_current(&self) -> bool {
        self.context.is_current()
    }

    /// Whether the context's display offers contexts with reset notification.
    pub fn offers_robustness(&self) -> bool {
        let features = self.display.supported_features();
        features.contains(DisplayFeatures::CONTEXT_ROBUSTNESS)
    }

    /// Sets the viewport of the current context: x, y, width and height.
    pub fn set_viewport(&self, [x, y, width, height]: [i32; 4]) {
        // SAFETY: the functions are those of the current context's library.
        unsafe { self.gl().viewport(x, y, width, height) };
    }

    /// The viewport of the current context.
    pub fn viewport(&self) -> [i32; 4] {
        let mut found = [0; 4];
        // SAFETY: as above, and the slice has room for four numbers.
        unsafe {
            self.gl()
                .get_parameter_i32_slice(glow::VIEWPORT, &mut found)
        };
        found
    }

    /// The address of a function of the library.
    pub fn address(&self, name: &CStr) -> *const c_void {
        self.display.get_proc_address(name)
    }

    /// The GL functions, for use while the context is current.
    pub fn gl(&self) -> glow::Context {
        let address = |name: &str| self.address(&CString::new(name).unwrap());
        // SAFETY: a context is current, and the addresses are those of its library.
        unsafe { glow::Context::from_loader_function(address) }
    }
}

/// The program's functions, as it passes them to echomarch.
pub struct Switch(pub Rc<RawEgl>);

impl SwitchContext for Switch {
    fn make_current(&self) -> Result<(), String> {
        let made = self.0.context.make_current_surfaceless();
        made.map_err(|error| error.to_string())
    }

    fn is_current(&self) -> bool {
        self.0.is_current()
    }

    fn release(&self) {
        self.0.unbind();
    }
}

/// Side of the picture that the program draws.
const SIDE: i32 = 8;

type IsObject = unsafe extern "system" fn(u32) -> u8;
/// The program. Its context is current after construction.
pub struct ForeignProgram {
    pub egl: Rc<RawEgl>,
    pub(super) gl: glow::Context,
    pub(super) kind: Kind,
    program: glow::Program,
    pub(super) framebuffers: [glow::Framebuffer; 2],
    feedback: glow::Buffer,
}

impl ForeignProgram {
    /// Creates a program with a picture. Each draw covers half of the picture and adds a quarter to its colour.
    pub fn new(kind: Kind) -> ForeignProgram {
        let egl = Rc::new(RawEgl::of(kind));
        egl.bind();
        let gl = egl.gl();
        // SAFETY: the context is current, and all objects belong to it; the same holds in all of this file.
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

    /// Draws once more, with the current state.
    pub fn draw(&self) {
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) };
    }

    /// The picture, four bytes per pixel.
    pub fn picture(&self) -> Vec<u8> {
        let mut pixels = vec![0; (4 * SIDE * SIDE) as usize];
        let slice = PixelPackData::Slice(Some(&mut pixels));
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            let (format, kind) = (glow::RGBA, glow::UNSIGNED_BYTE);
            self.gl.read_pixels(0, 0, SIDE, SIDE, format, kind, slice);
        }
        pixels
    }

    /// The picture after `draws` draws: red in the left half, and no blue.
    pub fn expected_picture(draws: u8) -> Vec<u8> {
        let pixel = |index| match index % SIDE < SIDE / 2 {
            true => [64 * draws, 0, 0, 64 * draws],
            false => [0; 4],
        };
        (0..SIDE * SIDE).flat_map(pixel).collect()
    }

    /// Causes a GL error that the program does not query.
    pub fn make_an_error(&self) {
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe { self.gl.enable(0xFFFF) };
    }

    /// Begins to write the vertex shader's output into a buffer.
    pub fn begin_feedback(&self) {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            gl.bind_buffer(glow::TRANSFORM_FEEDBACK_BUFFER, Some(self.feedback));
            let target = glow::TRANSFORM_FEEDBACK_BUFFER;
            gl.buffer_data_size(target, 6 * 4, glow::STATIC_READ);
            gl.bind_buffer_base(target, 0, Some(self.feedback));
            gl.begin_transform_feedback(glow::TRIANGLES);
            assert_eq!(gl.get_error(), glow::NO_ERROR);
        }
    }

    /// Ends the transform feedback, and returns its data: the vertices' numbers.
    pub fn end_feedback(&self) -> Vec<f32> {
        let gl = &self.gl;
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe {
            gl.end_transform_feedback();
            let target = glow::TRANSFORM_FEEDBACK_BUFFER;
            let mapped = gl.map_buffer_range(target, 0, 6 * 4, glow::MAP_READ_BIT);
            let written = std::slice::from_raw_parts(mapped.cast::<f32>(), 6).to_vec();
            gl.unmap_buffer(target);
            written
        }
    }

    /// Number of objects of each kind: textures, buffers, programs, vertex arrays, framebuffers.
    pub fn objects(&self) -> [usize; 5] {
        let gl = &self.gl;
        let names = || (1..500).map(|name| std::num::NonZeroU32::new(name).unwrap());
        let count = |is: &dyn Fn(std::num::NonZeroU32) -> bool| names().filter(|n| is(*n)).count();
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
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

    /// Whether the program's shaders are in use.
    pub fn is_in_use(&self) -> bool {
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
        unsafe { self.gl.get_parameter_program(glow::CURRENT_PROGRAM) == Some(self.program) }
    }

    /// The texels of a texture that the program did not make. The texture has four floats per texel.
    pub fn texels(&self, texture: glow::Texture, width: u32, height: u32) -> Vec<[f32; 4]> {
        let gl = &self.gl;
        let mut bytes = vec![0; 16 * (width * height) as usize];
        // SAFETY: the program's own context is current while a test calls this, and owns the objects.
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

    /// A function that glow lacks, or has with fewer parameters.
    pub(super) unsafe fn function<T: Copy>(&self, name: &str) -> T {
        let address = self.egl.address(&std::ffi::CString::new(name).unwrap());
        assert!(!address.is_null(), "{name}");
        assert_eq!(size_of::<T>(), size_of_val(&address));
        // SAFETY: T is the type of the function with this name.
        unsafe { std::mem::transmute_copy(&address) }
    }
}

/// A program that adds a quarter of red and of blue everywhere, and writes the vertices' numbers.
unsafe fn program(gl: &glow::Context, kind: Kind) -> glow::Program {
    let header = match kind {
        Kind::Es => "#version 300 es\nprecision highp float;\n",
        Kind::Core | Kind::Compatibility => "#version 330 core\n",
    };
    let vertex = "out float number; void main() { number = float(gl_VertexID);\
        gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";
    let fragment =
        "out vec4 colour; void main() { colour = vec4(0.2509804, 0.0, 0.25, 0.2509804); }";
    // SAFETY: guaranteed by the caller: the context is current.
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

/// A framebuffer with a black picture.
unsafe fn framebuffer(gl: &glow::Context) -> glow::Framebuffer {
    // SAFETY: guaranteed by the caller: the context is current.
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

//! Shader programs with their uniforms, and a cache of compiled ones.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::rc::Rc;

use glam::{Vec3, Vec4};
use glow::HasContext;

use super::{Api, Context, GpuError, Texture};

/// The vertex shader of all programs.
const FULL_SCREEN: &str = include_str!("../../glsl/full_screen.vert");

/// The header of every shader: the version and the precisions. Line numbers start at 1 after the header.
pub fn header(api: Api) -> &'static str {
    match api {
        Api::Gl | Api::OsMesa => "#version 330 core\n#line 1\n",
        Api::Gles => {
            "#version 300 es\n\
             precision highp float;\n\
             precision highp int;\n\
             precision highp sampler2D;\n\
             precision highp usampler2D;\n\
             #line 1\n"
        }
    }
}

/// A program of the full-screen vertex shader and one fragment shader, with its uniforms.
///
/// Setting a uniform that the shader lacks, or that the driver removed as unused, has no effect. Setting a uniform with
/// a setter of another type is an error, which the next check reports. Dropping the program frees it.
#[derive(Debug)]
pub struct Program {
    context: Context,
    program: glow::Program,
    label: String,
    uniforms: HashMap<String, glow::UniformLocation>,
}

impl Program {
    /// Compiles and links a fragment shader, whose text has no `#version` line and uses only GLSL ES 3.00. The label
    /// names the program in errors.
    ///
    /// # Errors
    /// [`GpuError::Compile`] and [`GpuError::Link`] with the driver's log.
    pub fn fragment(context: &Context, label: &str, body: &str) -> Result<Program, GpuError> {
        let gl = context.gl();
        let failed = GpuError::not_created(format!("the program \"{label}\""));
        // SAFETY: the context is current.
        let program = unsafe { gl.create_program() }.map_err(failed)?;
        let mut program = Program {
            context: context.clone(),
            program,
            label: label.into(),
            uniforms: HashMap::new(),
        };
        let vertex = Shader::compile(context, glow::VERTEX_SHADER, label, FULL_SCREEN)?;
        let fragment = Shader::compile(context, glow::FRAGMENT_SHADER, label, body)?;
        program.link(&[&vertex, &fragment])?;
        program.uniforms = find_uniforms(gl, program.program);
        context.check(label)?;
        Ok(program)
    }

    fn link(&self, shaders: &[&Shader]) -> Result<(), GpuError> {
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the program and shaders.
        unsafe {
            for shader in shaders {
                gl.attach_shader(self.program, shader.shader);
            }
            gl.link_program(self.program);
            for shader in shaders {
                gl.detach_shader(self.program, shader.shader);
            }
            if gl.get_program_link_status(self.program) {
                return Ok(());
            }
            Err(GpuError::Link {
                label: self.label.clone(),
                log: gl.get_program_info_log(self.program),
            })
        }
    }

    /// The name used in errors.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Whether the shader uses a uniform of that name.
    pub fn has_uniform(&self, name: &str) -> bool {
        self.uniforms.contains_key(name)
    }

    /// Sets an `int` or a `bool`.
    pub fn set_i32(&self, name: &str, value: i32) {
        // SAFETY: `set` has made the context and the program current, and the location is the program's own; the same
        // holds for all setters below.
        self.set(name, |gl, at| unsafe { gl.uniform_1_i32(at, value) });
    }

    /// Sets a `uint`.
    pub fn set_u32(&self, name: &str, value: u32) {
        // SAFETY: as in set_i32.
        self.set(name, |gl, at| unsafe { gl.uniform_1_u32(at, value) });
    }

    /// Sets a `float`.
    pub fn set_f32(&self, name: &str, value: f32) {
        // SAFETY: as in set_i32.
        self.set(name, |gl, at| unsafe { gl.uniform_1_f32(at, value) });
    }

    /// Sets a `vec2`.
    pub fn set_vec2(&self, name: &str, value: glam::Vec2) {
        // SAFETY: as in set_i32.
        self.set(name, |gl, at| unsafe {
            gl.uniform_2_f32(at, value.x, value.y)
        });
    }

    /// Sets a `vec3`.
    pub fn set_vec3(&self, name: &str, value: Vec3) {
        // SAFETY: as in set_i32.
        self.set(name, |gl, at| unsafe {
            gl.uniform_3_f32(at, value.x, value.y, value.z)
        });
    }

    /// Sets a `vec4`.
    pub fn set_vec4(&self, name: &str, value: Vec4) {
        // SAFETY: as in set_i32.
        self.set(name, |gl, at| unsafe {
            gl.uniform_4_f32(at, value.x, value.y, value.z, value.w)
        });
    }

    /// Sets an array of `vec4`, starting at its first element; `name` has no brackets. Elements beyond the end of the
    /// array are ignored.
    pub fn set_vec4_array(&self, name: &str, values: &[Vec4]) {
        if values.is_empty() {
            return;
        }
        let floats: Vec<f32> = values.iter().flat_map(|value| value.to_array()).collect();
        // SAFETY: as in set_i32; GL ignores elements beyond the end.
        self.set(name, |gl, at| unsafe {
            gl.uniform_4_f32_slice(at, &floats)
        });
    }

    /// Sets an array of `float`, like [`set_vec4_array`](Self::set_vec4_array).
    pub fn set_f32_array(&self, name: &str, values: &[f32]) {
        if values.is_empty() {
            return;
        }
        // SAFETY: as in set_i32; GL ignores elements beyond the end.
        self.set(name, |gl, at| unsafe { gl.uniform_1_f32_slice(at, values) });
    }

    /// Binds a texture to a unit (0 to 15) and sets the `sampler2D` to that unit. All programs of a context share the
    /// units: set a program's textures just before its pass.
    pub fn set_texture(&self, name: &str, unit: u32, texture: &Texture) {
        debug_assert!(
            unit < 16,
            "a fragment shader has at least 16 texture units, not {unit}"
        );
        if self.has_uniform(name) {
            texture.bind(unit);
            self.set_i32(name, unit as i32);
        }
    }

    /// GL's name for the program.
    pub(super) fn raw(&self) -> glow::Program {
        self.program
    }

    /// The context of the program.
    pub(super) fn context(&self) -> &Context {
        &self.context
    }

    fn set(&self, name: &str, assign: impl FnOnce(&glow::Context, Option<&glow::UniformLocation>)) {
        let location = self.uniforms.get(name);
        if location.is_some() {
            let gl = self.context.gl();
            // SAFETY: the context is current and owns the program.
            unsafe { gl.use_program(Some(self.program)) };
            assign(gl, location);
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns the program, which is not used again.
        self.context
            .free(|gl| unsafe { gl.delete_program(self.program) });
    }
}

/// The locations of the uniforms that the driver kept; arrays are listed under their name without brackets.
fn find_uniforms(
    gl: &glow::Context,
    program: glow::Program,
) -> HashMap<String, glow::UniformLocation> {
    let mut uniforms = HashMap::new();
    // SAFETY: the context is current, the program linked, and the indices below the count.
    unsafe {
        for index in 0..gl.get_active_uniforms(program) {
            let Some(uniform) = gl.get_active_uniform(program, index) else {
                continue;
            };
            if let Some(location) = gl.get_uniform_location(program, &uniform.name) {
                let name = uniform.name.strip_suffix("[0]").unwrap_or(&uniform.name);
                uniforms.insert(name.to_owned(), location);
            }
        }
    }
    uniforms
}

/// One compiled shader, freed when dropped.
struct Shader<'a> {
    context: &'a Context,
    shader: glow::Shader,
}

impl<'a> Shader<'a> {
    fn compile(
        context: &'a Context,
        kind: u32,
        label: &str,
        body: &str,
    ) -> Result<Shader<'a>, GpuError> {
        let gl = context.gl();
        let failed = GpuError::not_created(format!("the shader \"{label}\""));
        // SAFETY: the context is current.
        let shader = unsafe { gl.create_shader(kind) }.map_err(failed)?;
        let shader = Shader { context, shader };
        let source = format!("{}{body}", header(context.api()));
        // SAFETY: the context is current and owns the shader.
        unsafe {
            gl.shader_source(shader.shader, &source);
            gl.compile_shader(shader.shader);
            if gl.get_shader_compile_status(shader.shader) {
                return Ok(shader);
            }
            Err(GpuError::Compile {
                stage: if kind == glow::VERTEX_SHADER {
                    "vertex"
                } else {
                    "fragment"
                },
                label: label.into(),
                log: gl.get_shader_info_log(shader.shader),
            })
        }
    }
}

impl Drop for Shader<'_> {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns the shader, which is not used again.
        self.context
            .free(|gl| unsafe { gl.delete_shader(self.shader) });
    }
}

/// Programs by the key that determines their text. A full cache drops the least recently used program, which bounds the
/// number of programs when many scenes are rendered in turn.
#[derive(Debug)]
pub struct ProgramCache<K: Eq> {
    /// The cached programs, the most recently used one last. With so few programs, a linear search costs less than a
    /// map.
    kept: Vec<(K, Rc<Program>)>,
    most: usize,
    compiled: usize,
}

impl<K: Eq> ProgramCache<K> {
    /// Creates an empty cache for at most `most` programs.
    pub fn new(most: NonZeroUsize) -> ProgramCache<K> {
        ProgramCache {
            kept: Vec::new(),
            most: most.get(),
            compiled: 0,
        }
    }

    /// Returns the program cached for `key`, or compiles and caches it.
    ///
    /// # Errors
    /// The errors of `compile`; then the cache is unchanged.
    pub fn get_or_compile<E>(
        &mut self,
        key: K,
        compile: impl FnOnce() -> Result<Program, E>,
    ) -> Result<Rc<Program>, E> {
        if let Some(at) = self.kept.iter().position(|(known, _)| *known == key) {
            self.kept[at..].rotate_left(1);
        } else {
            let program = Rc::new(compile()?);
            self.compiled += 1;
            if self.kept.len() == self.most {
                self.kept.remove(0);
            }
            self.kept.push((key, program));
        }
        Ok(self.kept[self.kept.len() - 1].1.clone())
    }

    /// Total number of programs compiled, including dropped ones.
    pub fn compiled(&self) -> usize {
        self.compiled
    }

    /// Number of programs in the cache.
    #[cfg(test)]
    pub fn kept(&self) -> usize {
        self.kept.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl::ContextOptions;

    const TWO: NonZeroUsize = NonZeroUsize::new(2).unwrap();

    /// Protects rendering many scenes in turn: unused programs are dropped, used ones stay.
    #[test]
    fn the_program_unused_longest_goes() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut cache = ProgramCache::new(TWO);
        let mut ask = |name: &'static str| {
            let text = "out vec4 colour; void main() { colour = vec4(1.0); }";
            let compile = || Program::fragment(&context, name, text);
            let program = cache.get_or_compile(name, compile).unwrap();
            (program, cache.compiled(), cache.kept())
        };
        let (first, ..) = ask("first");
        let (second, ..) = ask("second");
        assert!(Rc::ptr_eq(&ask("first").0, &first));
        let (_, compiled, kept) = ask("third");
        assert_eq!((compiled, kept), (3, 2));
        assert!(Rc::ptr_eq(&ask("first").0, &first));
        // Other references to the program can still draw with it.
        assert_eq!(second.label(), "second");
        assert!(!Rc::ptr_eq(&ask("second").0, &second));
        assert_eq!(ask("second").1, 4);
    }

    /// Protects cached programs: a program that does not compile removes no other from the cache.
    #[test]
    fn what_does_not_compile_drives_nothing_out() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut cache = ProgramCache::new(TWO);
        let good = "out vec4 colour; void main() { colour = vec4(1.0); }";
        for (name, text) in [("a", good), ("b", good), ("c", "void main() { no }")] {
            let compile = || Program::fragment(&context, name, text);
            let made = cache.get_or_compile(name, compile);
            assert_eq!(made.is_ok(), text == good);
        }
        assert_eq!((cache.compiled(), cache.kept()), (2, 2));
        let never = || -> Result<Program, GpuError> { panic!("it is kept") };
        cache.get_or_compile("a", never).unwrap();
        cache.get_or_compile("b", never).unwrap();
    }
}

//! Textures, programs and passes on every API. These tests fail on a machine without GL.

use crate::gl::program::header;
use crate::gl::{
    Api, Context, GpuError, Picture, PingPong, Program, RenderTarget, Texture, TexturePair,
    full_screen_pass, full_screen_pass_rows,
};
use crate::test_common::for_each_api;
use glam::{Vec2, Vec3, Vec4};

/// Runs the test on every API and checks that no GL error remains at its end.
fn on_every_api(test: fn(&Context)) {
    for_each_api(|context| {
        test(context);
        context.check("the end of the test").unwrap();
    });
}

/// Floats whose bits a driver might change: NaNs with a payload, infinities, denormals, negative zero.
fn delicate_floats() -> [f32; 8] {
    let bits = [
        0x7FC0_0001,
        0x7F80_0001,
        0xFFC1_2345,
        0x7F80_0000,
        0xFF80_0000,
        0x0000_0001,
        0x8000_0000,
        0x3F80_0001,
    ];
    bits.map(f32::from_bits)
}

fn bits(floats: &[f32]) -> Vec<u32> {
    floats.iter().map(|float| float.to_bits()).collect()
}

/// Protects the bits of floats read from the requested attachment of a texture, whole and in part.
#[test]
fn gpu_textures_keep_every_bit() {
    on_every_api(|context| {
        let pair = TexturePair::new(context, 3, 4).unwrap();
        let ramp: Vec<f32> = (0..48).map(|index| index as f32 * 0.1).collect();
        let mut delicate: Vec<f32> = delicate_floats().repeat(6);
        delicate[47] = -1.5;
        pair.first.upload(&ramp).unwrap();
        pair.second.upload(&delicate).unwrap();
        assert_eq!(bits(&pair.target.read(0).unwrap()), bits(&ramp));
        assert_eq!(bits(&pair.target.read(1).unwrap()), bits(&delicate));
        let mut part = vec![9.0; 100];
        pair.target.read_into(0, 2, 2, &mut part).unwrap();
        assert_eq!(part, [&ramp[0..8], &ramp[12..20]].concat());
    });
}

/// Protects memory: data or reads of the wrong size are errors.
#[test]
fn gpu_sizes_that_do_not_fit_are_errors() {
    on_every_api(|context| {
        let pair = TexturePair::new(context, 3, 4).unwrap();
        let error = pair.first.upload(&[0.0; 47]).unwrap_err();
        assert!(
            matches!(
                error,
                GpuError::DataSize {
                    expected: 48,
                    found: 47
                }
            ),
            "{error}"
        );
        let mut texels = Vec::new();
        for (attachment, width, rows) in [(2, 3, 4), (0, 4, 4), (0, 3, 5)] {
            let error = pair
                .target
                .read_into(attachment, width, rows, &mut texels)
                .unwrap_err();
            assert!(matches!(error, GpuError::ReadOutOfRange { .. }), "{error}");
        }
        let small = Texture::new(context, 2, 4).unwrap();
        let too_many = context.limits().most_outputs() as usize + 1;
        for textures in [vec![], vec![&pair.first, &small], vec![&small; too_many]] {
            let error = RenderTarget::new(context, &textures).unwrap_err();
            assert!(
                matches!(error, GpuError::IncompleteFramebuffer { .. }),
                "{error}"
            );
        }
    });
}

/// Protects the order of passes: each reads what the previous one wrote, so n passes add n, in both textures of the
/// pair.
#[test]
fn gpu_ping_pong_adds_once_a_pass() {
    on_every_api(|context| {
        let body = "
            uniform sampler2D before_first;
            uniform sampler2D before_second;
            layout(location = 0) out vec4 first;
            layout(location = 1) out vec4 second;
            void main() {
                ivec2 texel = ivec2(gl_FragCoord.xy);
                first = texelFetch(before_first, texel, 0) + 1.0;
                second = texelFetch(before_second, texel, 0) + vec4(1.0, 2.0, 3.0, 4.0);
            }";
        let program = Program::fragment(context, "add", body).unwrap();
        let (width, height) = (5, 7);
        let mut pairs = PingPong::new(context, width, height).unwrap();
        let start: Vec<f32> = (0..4 * width * height).map(|index| index as f32).collect();
        pairs.current().first.upload(&start).unwrap();
        pairs.current().second.upload(&start).unwrap();
        for _ in 0..13 {
            program.set_texture("before_first", 0, &pairs.current().first);
            program.set_texture("before_second", 1, &pairs.current().second);
            full_screen_pass(context, &program, pairs.next(), width, height).unwrap();
            pairs.flip();
        }
        let expected: Vec<f32> = start.iter().map(|value| value + 13.0).collect();
        assert_eq!(pairs.current().target.read(0).unwrap(), expected);
        let added = |(index, value): (usize, &f32)| value + 13.0 * (1 + index % 4) as f32;
        let expected: Vec<f32> = start.iter().enumerate().map(added).collect();
        assert_eq!(pairs.current().target.read(1).unwrap(), expected);
    });
}

/// Protects bound textures: making and filling a texture between set_texture and the pass leaves the units of the pass
/// unchanged.
#[test]
fn gpu_new_textures_leave_bound_ones_alone() {
    on_every_api(|context| {
        let body = "
            uniform sampler2D source;
            layout(location = 0) out vec4 result;
            void main() { result = texelFetch(source, ivec2(0), 0); }";
        let program = Program::fragment(context, "copy", body).unwrap();
        let [source, result] = [(); 2].map(|()| Texture::new(context, 1, 1).unwrap());
        let target = RenderTarget::new(context, &[&result]).unwrap();
        source.upload(&[4.0; 4]).unwrap();
        program.set_texture("source", 0, &source);
        Texture::new(context, 1, 1)
            .unwrap()
            .upload(&[9.0; 4])
            .unwrap();
        full_screen_pass(context, &program, &target, 1, 1).unwrap();
        assert_eq!(target.read(0).unwrap(), [4.0; 4]);
    });
}

const COORDINATES: &str = "
    uniform float round;
    layout(location = 0) out vec4 result;
    void main() { result = vec4(gl_FragCoord.xy, sqrt(gl_FragCoord.x * gl_FragCoord.y), round); }";

/// Protects drawing in bands of rows: the result equals that of one draw, each row is drawn once, and nothing is drawn
/// outside the viewport.
#[test]
fn gpu_bands_cover_what_one_draw_covers() {
    on_every_api(|context| {
        let program = Program::fragment(context, "coordinates", COORDINATES).unwrap();
        let textures = [(); 2].map(|()| Texture::new(context, 9, 11).unwrap());
        let targets = [0, 1].map(|index| RenderTarget::new(context, &[&textures[index]]).unwrap());
        for texture in &textures {
            texture.upload(&[-1.0; 4 * 9 * 11]).unwrap();
        }
        program.set_f32("round", 1.0);
        full_screen_pass(context, &program, &targets[0], 8, 10).unwrap();
        let whole = targets[0].read(0).unwrap();
        assert_eq!(whole[4 * (3 * 9 + 2)..][..2], [2.5, 3.5]);
        assert_eq!(whole[4 * 8..4 * 9], [-1.0; 4]);
        assert_eq!(whole[4 * 9 * 10..], [-1.0; 36]);
        for rows in [0..3, 3..4, 4..9, 9..100] {
            full_screen_pass_rows(context, &program, &targets[1], 8, 10, rows).unwrap();
        }
        assert_eq!(targets[1].read(0).unwrap(), whole);
        // A band leaves the other rows unchanged, and a whole pass afterwards is not clipped.
        program.set_f32("round", 2.0);
        full_screen_pass_rows(context, &program, &targets[1], 8, 10, 4..6).unwrap();
        let rounds: Vec<f32> = targets[1]
            .read(0)
            .unwrap()
            .chunks(4 * 9)
            .map(|row| row[3])
            .collect();
        assert_eq!(
            rounds,
            [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, -1.0]
        );
        full_screen_pass(context, &program, &targets[0], 8, 10).unwrap();
        assert_eq!(targets[0].read(0).unwrap()[3], 2.0);
    });
}

/// Protects the setters: each reaches its uniform, arrays by their plain name, and unknown names have no effect.
#[test]
fn gpu_uniforms_arrive() {
    on_every_api(|context| {
        let body = "
            uniform int an_int;
            uniform uint a_uint;
            uniform float a_float;
            uniform vec2 two;
            uniform vec3 three;
            uniform vec4 four;
            uniform vec4 array[3];
            uniform float unused;
            layout(location = 0) out vec4 result;
            void main() {
                int part = int(gl_FragCoord.x);
                if (part == 0) result = vec4(float(an_int), float(a_uint), a_float, 0.0);
                else if (part == 1) result = vec4(two, three.xy);
                else if (part == 2) result = vec4(three.z, four.xyz);
                else if (part < 6) result = array[part - 3];
                else result = vec4(four.w);
            }";
        let program = Program::fragment(context, "uniforms", body).unwrap();
        let texture = Texture::new(context, 7, 1).unwrap();
        let target = RenderTarget::new(context, &[&texture]).unwrap();
        program.set_i32("an_int", -3);
        program.set_u32("a_uint", 5);
        program.set_f32("a_float", 0.25);
        program.set_vec2("two", Vec2::new(1.0, 2.0));
        program.set_vec3("three", Vec3::new(3.0, 4.0, 5.0));
        program.set_vec4("four", Vec4::new(6.0, 7.0, 8.0, 9.0));
        let array = [Vec4::splat(10.0), Vec4::splat(11.0), Vec4::splat(12.0)];
        program.set_vec4_array("array", &array);
        program.set_f32("unused", 1.0);
        program.set_texture("nowhere", 3, &texture);
        assert!(program.has_uniform("array") && !program.has_uniform("unused"));
        full_screen_pass(context, &program, &target, 7, 1).unwrap();
        let mut expected = vec![-3.0, 5.0, 0.25, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        expected.extend(array.iter().flat_map(|value| value.to_array()));
        expected.extend([9.0; 4]);
        assert_eq!(target.read(0).unwrap(), expected);
    });
}

/// Protects compile errors, which state the label and the driver's log with lines counted from the body's first.
#[test]
fn gpu_compile_errors_name_shader_and_line() {
    on_every_api(|context| {
        let body = "layout(location = 0) out vec4 result;\nvoid main() {\n    result = no_such_thing;\n}\n";
        let error = Program::fragment(context, "broken", body).unwrap_err();
        println!("{}: {error}", context.api());
        let GpuError::Compile { stage, label, log } = &error else {
            panic!("{error}")
        };
        assert_eq!((*stage, label.as_str()), ("fragment", "broken"));
        assert!(log.contains("no_such_thing"), "{log}");
        assert!(
            log.contains(":3(") || log.contains(":3:") || log.contains("(3)"),
            "not line 3: {log}"
        );
        assert!(error.to_string().contains("broken"));
    });
}

/// Protects link errors: a missing function is an error, which some drivers report when compiling and others when
/// linking.
#[test]
fn gpu_link_errors_name_the_program() {
    on_every_api(|context| {
        let body = "vec4 missing(); layout(location = 0) out vec4 result; void main() { result = missing(); }";
        let error = Program::fragment(context, "unlinked", body).unwrap_err();
        println!("{}: {error}", context.api());
        let (GpuError::Link { label, log } | GpuError::Compile { label, log, .. }) = &error else {
            panic!("{error}")
        };
        assert!(label == "unlinked" && log.contains("missing"), "{error}");
    });
}

/// Protects from silent type errors: setting a uniform with a setter of another type is reported.
#[test]
fn gpu_wrong_uniform_type_is_reported() {
    on_every_api(|context| {
        let program = Program::fragment(context, "coordinates", COORDINATES).unwrap();
        program.set_vec3("round", Vec3::ONE);
        let error = context.check("the uniform").unwrap_err().to_string();
        assert!(error.contains("GL_INVALID_OPERATION"), "{error}");
    });
}

/// Protects the row order of pictures: the top row is read back first.
#[test]
fn gpu_pictures_have_the_top_row_first() {
    on_every_api(|context| {
        let body = "
            layout(location = 0) out vec4 colour;
            void main() { colour = vec4(floor(gl_FragCoord.xy) / 255.0, 1.0, 0.0); }";
        let program = Program::fragment(context, "colours", body).unwrap();
        let picture = Picture::new(context, 2, 3).unwrap();
        full_screen_pass(context, &program, &picture, 2, 3).unwrap();
        let expected =
            [[0, 2], [1, 2], [0, 1], [1, 1], [0, 0], [1, 0]].map(|[x, y]| [x, y, 255, 0]);
        assert_eq!(picture.read_rgba8().unwrap(), expected.as_flattened());
    });
}

/// Protects the version line, which GLSL requires to be first.
#[test]
fn gpu_headers_begin_with_the_version() {
    assert!(header(Api::Gl).starts_with("#version 330 core\n"));
    assert!(header(Api::OsMesa).starts_with("#version 330 core\n"));
    assert!(header(Api::Gles).starts_with("#version 300 es\n"));
}

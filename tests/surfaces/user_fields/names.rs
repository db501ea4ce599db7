//! Names declared by a field's text: GLSL's own are refused, all others change nothing.

use super::{BALL, settings};
use crate::common::for_each_api;
use echomarch::scene::shape::{Room, User};
use echomarch::scene::{Node, UserField};
use echomarch::{Listener, Profile, Scene, Source, Surface, Tracer};
use glam::Vec3;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Functions of GLSL 3.30 and of GLSL ES 3.00 (chapters 8 of the specifications).
const FUNCTIONS: &str = "radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh \
    atanh pow exp log exp2 log2 sqrt inversesqrt abs sign floor trunc round roundEven ceil fract \
    mod modf min max clamp mix step smoothstep isnan isinf floatBitsToInt floatBitsToUint \
    intBitsToFloat uintBitsToFloat length distance dot cross normalize faceforward reflect \
    refract matrixCompMult outerProduct transpose determinant inverse lessThan lessThanEqual \
    greaterThan greaterThanEqual equal notEqual any all not";

/// Functions of only one of the two, or of whole shaders only.
const OTHER_FUNCTIONS: &str = "packSnorm2x16 unpackSnorm2x16 packUnorm2x16 unpackUnorm2x16 \
    packHalf2x16 unpackHalf2x16 ftransform EmitVertex EndPrimitive noise1 noise2 noise3 noise4 \
    textureSize texture textureProj textureLod textureOffset texelFetch texelFetchOffset \
    textureProjOffset textureLodOffset textureProjLod textureProjLodOffset textureGrad \
    textureGradOffset textureProjGrad textureProjGradOffset texture1D texture1DProj texture1DLod \
    texture1DProjLod texture2D texture2DProj texture2DLod texture2DProjLod texture3D \
    texture3DProj texture3DLod texture3DProjLod textureCube textureCubeLod shadow1D shadow2D \
    shadow1DProj shadow2DProj shadow1DLod shadow2DLod shadow1DProjLod shadow2DProjLod dFdx dFdy \
    fwidth main";

/// Variables and constants of either, in any stage.
const VARIABLES: &str = "gl_VertexID gl_InstanceID gl_Position gl_PointSize gl_ClipDistance \
    gl_PerVertex gl_in gl_PrimitiveIDIn gl_PrimitiveID gl_Layer gl_FragCoord gl_FrontFacing \
    gl_PointCoord gl_FragColor gl_FragData gl_FragDepth gl_DepthRange gl_DepthRangeParameters \
    gl_MaxVertexAttribs gl_MaxVertexUniformVectors gl_MaxVertexOutputVectors \
    gl_MaxFragmentInputVectors gl_MaxVertexTextureImageUnits gl_MaxCombinedTextureImageUnits \
    gl_MaxTextureImageUnits gl_MaxFragmentUniformVectors gl_MaxDrawBuffers \
    gl_MinProgramTexelOffset gl_MaxProgramTexelOffset gl_MaxTextureUnits gl_MaxTextureCoords \
    gl_MaxVertexUniformComponents gl_MaxVaryingFloats gl_MaxVaryingComponents \
    gl_MaxFragmentUniformComponents gl_MaxClipDistances gl_MaxGeometryOutputVertices \
    gl_ModelViewMatrix gl_Vertex gl_Color gl_Normal gl_unknown";

/// Words of both languages.
const KEYWORDS: &str = "const break continue do for while switch case default if else in out \
    inout float int void bool true false return mat2 mat3 mat4 mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 \
    mat3x4 mat4x2 mat4x3 mat4x4 vec2 vec3 vec4 ivec2 ivec3 ivec4 bvec2 bvec3 bvec4 uint uvec2 \
    uvec3 uvec4 lowp mediump highp precision struct";

/// Words of whole shaders, and words reserved by either language.
const RESERVED: &str = "attribute uniform varying layout centroid flat smooth noperspective \
    invariant discard sampler1D sampler2D sampler3D samplerCube sampler1DShadow sampler2DShadow \
    samplerCubeShadow sampler1DArray sampler2DArray sampler1DArrayShadow sampler2DArrayShadow \
    isampler1D isampler2D isampler3D isamplerCube isampler1DArray isampler2DArray usampler1D \
    usampler2D usampler3D usamplerCube usampler1DArray usampler2DArray sampler2DRect \
    sampler2DRectShadow isampler2DRect usampler2DRect samplerBuffer isamplerBuffer usamplerBuffer \
    sampler2DMS isampler2DMS usampler2DMS sampler2DMSArray isampler2DMSArray usampler2DMSArray \
    common partition active asm class union enum typedef template this packed resource goto \
    inline noinline volatile public static extern external interface long short double half fixed \
    unsigned superp input output hvec2 hvec3 hvec4 dvec2 dvec3 dvec4 fvec2 fvec3 fvec4 \
    sampler3DRect filter image1D image2D image3D imageCube iimage1D iimage2D iimage3D iimageCube \
    uimage1D uimage2D uimage3D uimageCube image1DArray image2DArray iimage1DArray iimage2DArray \
    uimage1DArray uimage2DArray image1DShadow image2DShadow image1DArrayShadow \
    image2DArrayShadow imageBuffer iimageBuffer uimageBuffer sizeof cast namespace using \
    row_major coherent restrict readonly writeonly atomic_uint patch sample subroutine \
    two__underscores __two user0_field users1_a GL_ES GL_any defined";

/// Names that a text may use, however odd: those that select components, and those that resemble the names that the
/// program generates.
const OWN: &str = "s p st xyz rgba w stpq _s _ s_ user_field users_a user1 a0 s0 PI";

/// A declaration of a name, with a number unique to it.
type Form = (&'static str, fn(&str, usize) -> String);

/// Declarations at the text's global level.
const GLOBAL: [Form; 7] = [
    ("a function", |n, _| {
        format!("float {n}(float x) {{ return 9.0; }}")
    }),
    ("an overload", |n, _| {
        format!("vec3 {n}(mat2 a, bvec3 b) {{ return vec3(9.0); }}")
    }),
    ("a prototype", |n, _| format!("float {n}(float x);")),
    ("a global", |n, _| format!("float {n};")),
    ("a constant", |n, _| format!("const highp float {n} = 9.0;")),
    ("a structure", |n, _| format!("struct {n} {{ float a; }};")),
    ("an array", |n, _| format!("float {n}[3];")),
];

/// Declarations at the global level behind others, where only drivers refuse a word of the language.
const FURTHER_GLOBAL: [Form; 2] = [
    ("a second global", |n, i| {
        format!("float g{i} = sqrt(9.0), {n} = 9.0;")
    }),
    ("a structure's variable", |n, _| {
        format!("struct {{ float a; }} {n};")
    }),
];

/// Declarations within a function, or within a structure.
const LOCAL: [Form; 4] = [
    ("a local variable", |n, i| {
        format!("float l{i}() {{ float {n} = 9.0; return {n}; }}")
    }),
    ("a parameter", |n, i| {
        format!("float l{i}(float {n}) {{ return {n}; }}")
    }),
    ("a member", |n, i| {
        format!("struct L{i} {{ float {n}; }}; float l{i}(L{i} l) {{ return l.{n}; }}")
    }),
    ("a local structure", |n, i| {
        format!("float l{i}() {{ struct {n} {{ float a; }}; {n} b; b.a = 9.0; return b.a; }}")
    }),
];

/// Macros; each is undefined again, since the text after it contains words of the language.
const MACROS: [Form; 3] = [
    ("a macro", |n, _| format!("#define {n} 9.0\n#undef {n}")),
    ("a macro with parameters", |n, _| {
        format!("#define {n}(x, y) 9.0\n#undef {n}")
    }),
    ("an undefined macro", |n, _| format!("#undef {n}")),
];

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace()
}

/// Returns the reason why a text with `line` before a good field is refused before it is compiled.
fn refused(line: &str) -> Option<(Option<u32>, String)> {
    let text = format!("{line}\n{BALL}");
    let field = UserField::new("my.glsl", text, Vec3::splat(3.0), 1.0);
    field.check_text().err()
}

/// Returns the names that the program's own shaders declare globally.
fn names_of_shaders() -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(path).unwrap();
            let is_declaration = |line: &&str| line.starts_with(|c: char| c.is_ascii_alphabetic());
            for line in text.lines().filter(is_declaration) {
                let declared = line.split(['(', '=', ';', '{']).next().unwrap_or_default();
                let name = declared.split_whitespace().last().unwrap_or_default();
                let name = name.split('[').next().unwrap_or_default();
                if name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                    names.insert(name.to_owned());
                }
            }
        }
    }
    // A field's text declares these itself.
    names.retain(|name| name != "field" && name != "fieldGradient");
    assert!(names.len() > 200, "{} names", names.len());
    names
}

/// Protects the program's own shaders: a text cannot declare a name of GLSL where the declaration reaches beyond the
/// text's own functions.
#[test]
fn names_of_glsl_are_refused_by_name_and_line() {
    let global = GLOBAL.iter();
    for (what, form) in global.clone().chain(&FURTHER_GLOBAL) {
        for name in words(FUNCTIONS)
            .chain(words(VARIABLES))
            .chain(words(RESERVED))
        {
            let (line, why) = refused(&form(name, 0)).unwrap_or_else(|| panic!("{what} {name}"));
            assert_eq!(line, Some(1), "{what} {name}: {why}");
            assert!(why.contains(&format!("'{name}'")), "{what} {name}: {why}");
        }
    }
    for (what, form) in global {
        for name in words(KEYWORDS) {
            let (line, why) = refused(&form(name, 0)).unwrap_or_else(|| panic!("{what} {name}"));
            assert_eq!(line, Some(1), "{what} {name}: {why}");
            assert!(why.contains(&format!("'{name}'")), "{what} {name}: {why}");
        }
    }
    for (what, form) in LOCAL {
        for name in words(VARIABLES)
            .chain(words(RESERVED))
            .chain(words(KEYWORDS))
        {
            let (_, why) = refused(&form(name, 0)).unwrap_or_else(|| panic!("{what} {name}"));
            assert!(why.contains(&format!("'{name}'")), "{what} {name}: {why}");
        }
    }
    for name in words(FUNCTIONS) {
        for text in [
            format!("void f() {{ float {name}(float x); }}"),
            format!("void f() {{\n}} vec3 {name}\n(vec3 a);"),
            format!("#define F {name}\nfloat F(float x) {{ return x; }}"),
            format!("#define F(n) float n(float x)\nF({name});"),
        ] {
            let (line, why) = refused(&text).unwrap_or_else(|| panic!("{text}"));
            assert!(line.is_some() && why.contains(name), "{text}: {why}");
        }
    }
    for name in words("GL_ES GL_any defined __LINE__ __FILE__ __VERSION__") {
        for (what, form) in MACROS {
            let (line, why) = refused(&form(name, 0)).unwrap_or_else(|| panic!("{what} {name}"));
            assert!(line == Some(1) && why.contains(name), "{what}: {why}");
        }
    }
}

/// Protects texts that call functions whose names they may not declare.
#[test]
fn functions_of_glsl_are_called_everywhere() {
    for text in [
        "const float A = sqrt(2.0), B[2] = float[2](sin(A), abs(-1.0));",
        "float a[int(sqrt(4.0))];",
        "struct S { float a[int(max(1.0, 2.0))]; };",
        "float f(float x) { if (x > 1.0) return sin(x); else sin(x); do abs(x); while (x < 0.0); return 1.0; }",
        "float f(float x) { switch (int(x)) { case 1: return cos(x); default: return dot(vec2(x), vec2(x)); } }",
        "float f(float length, vec2 v[2]) { return length + float(v.length()); }",
    ] {
        assert_eq!(refused(text), None, "{text}");
    }
}

/// Returns a room with a ball and a field.
fn scene_with(text: String) -> Scene {
    let room = Node::Room(Room {
        size: Vec3::splat(9.0),
    });
    let field = UserField::new("my.glsl", text, Vec3::splat(3.0), 1.0);
    let field = Node::User(User {
        field: Arc::new(field),
    });
    let surfaces = vec![
        Surface::new(room),
        Surface::new(field).at(Vec3::new(0.0, 0.5, -1.0)),
    ];
    Scene::new(
        "names",
        surfaces,
        Source::at(Vec3::new(-3.0, 1.0, 1.0)),
        Listener::at(Vec3::new(3.0, 1.0, 1.0), 1.0),
    )
}

/// Protects the waves on every interface: accepted names change nothing, whether they are those of the program's own
/// shaders, of only one language, or of GLSL within a function. Each name is declared in one form, or with
/// `ECHOMARCH_EVERY_FORM=1` in every form, which takes a minute.
#[test]
fn names_that_are_taken_change_no_wave() {
    let every_form = std::env::var_os("ECHOMARCH_EVERY_FORM").is_some();
    let of_shaders = names_of_shaders();
    let own: Vec<&str> = words(OWN).chain(words(OTHER_FUNCTIONS)).collect();
    let own = own.into_iter().chain(of_shaders.iter().map(String::as_str));
    let own: Vec<&str> = own.collect::<BTreeSet<_>>().into_iter().collect();
    let macros: Vec<&str> = own.iter().copied().chain(words(FUNCTIONS)).collect();
    let macros: Vec<&str> = macros.into_iter().chain(words(KEYWORDS)).collect();
    let local: Vec<&str> = own.iter().copied().chain(words(FUNCTIONS)).collect();
    let groups = [
        (&GLOBAL[..], &own),
        (&FURTHER_GLOBAL[..], &own),
        (&LOCAL[..], &local),
        (&MACROS[..], &macros),
    ];
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let mut waves = |text: String| {
            let settings = settings(Profile::Hybrid);
            let (_, waves) = tracer.frame_with_waves(&scene_with(text), &settings)?;
            Ok::<_, echomarch::Error>(waves)
        };
        let expected = waves(BALL.to_owned()).unwrap();
        for (forms, names) in groups {
            for turn in 0..if every_form { forms.len() } else { 1 } {
                let named = |(index, name): (usize, &&str)| {
                    let (what, form) = forms[if every_form {
                        turn
                    } else {
                        index % forms.len()
                    }];
                    let line = form(name, index + 1000);
                    refused(&line).is_none().then_some((what, line))
                };
                let lines: Vec<_> = names.iter().enumerate().filter_map(named).collect();
                let what = if every_form {
                    lines[0].0
                } else {
                    "every form in turn"
                };
                println!("{what}: {} of {} names", lines.len(), names.len());
                assert!(lines.len() > names.len() * 3 / 4, "{what}: {}", lines.len());
                let lines: Vec<String> = lines.into_iter().map(|(_, line)| line).collect();
                let text = format!("{}\n{BALL}", lines.join("\n"));
                let found = waves(text).unwrap_or_else(|error| panic!("{what}: {error}"));
                assert!(found == expected, "{what}: other waves");
            }
        }
    });
}

/// Protects scenes of several fields: helpers with the same name stay separate for each text, also where the name could
/// select components.
#[test]
fn fields_of_one_scene_share_no_names() {
    let field = |radius: &str| {
        format!(
            "struct st {{ float s; vec2 st; }};\nconst float p = {radius};\nfloat _r(float x) {{ return x; }}\n\
             float s(vec3 p) {{ st a = st(length(p.xyz), p.st); return _r(a.s) + 0.0 * a.st.s; }}\n\
             float field(vec3 q) {{ return s(q) - p; }}\n"
        )
    };
    let plain = |radius: &str| format!("float field(vec3 p) {{ return length(p) - {radius}; }}\n");
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let mut waves = |text: &dyn Fn(&str) -> String| {
            let mut scene = scene_with(text("1.0"));
            let other = scene_with(text("0.7")).surfaces.remove(1);
            scene.surfaces.push(other.at(Vec3::new(1.0, -2.5, 0.0)));
            let settings = settings(Profile::Hybrid);
            tracer.frame_with_waves(&scene, &settings).unwrap().1
        };
        assert!(waves(&field) == waves(&plain));
    });
}

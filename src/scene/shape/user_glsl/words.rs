//! Words of GLSL: those that a field may use, and those that it may not.

/// Words and functions that GLSL 3.30 and GLSL ES 3.00 share and that a function of one point
/// can use. Everything else is a name of the text's own.
const KNOWN: &[&str] = &[
    // Types and qualifiers.
    "void",
    "bool",
    "int",
    "uint",
    "float",
    "vec2",
    "vec3",
    "vec4",
    "bvec2",
    "bvec3",
    "bvec4",
    "ivec2",
    "ivec3",
    "ivec4",
    "uvec2",
    "uvec3",
    "uvec4",
    "mat2",
    "mat3",
    "mat4",
    "mat2x2",
    "mat2x3",
    "mat2x4",
    "mat3x2",
    "mat3x3",
    "mat3x4",
    "mat4x2",
    "mat4x3",
    "mat4x4",
    "struct",
    "const",
    "in",
    "out",
    "inout",
    "highp",
    "mediump",
    "lowp",
    "precision",
    // Statements.
    "if",
    "else",
    "for",
    "while",
    "do",
    "switch",
    "case",
    "default",
    "break",
    "continue",
    "return",
    "true",
    "false",
    // Functions.
    "radians",
    "degrees",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "pow",
    "exp",
    "log",
    "exp2",
    "log2",
    "sqrt",
    "inversesqrt",
    "abs",
    "sign",
    "floor",
    "trunc",
    "round",
    "roundEven",
    "ceil",
    "fract",
    "mod",
    "modf",
    "min",
    "max",
    "clamp",
    "mix",
    "step",
    "smoothstep",
    "isnan",
    "isinf",
    "floatBitsToInt",
    "floatBitsToUint",
    "intBitsToFloat",
    "uintBitsToFloat",
    "length",
    "distance",
    "dot",
    "cross",
    "normalize",
    "faceforward",
    "reflect",
    "refract",
    "matrixCompMult",
    "outerProduct",
    "transpose",
    "determinant",
    "inverse",
    "lessThan",
    "lessThanEqual",
    "greaterThan",
    "greaterThanEqual",
    "equal",
    "notEqual",
    "any",
    "all",
    "not",
];

/// What would have to be given from outside.
const GIVEN: &[&str] = &[
    "uniform",
    "varying",
    "attribute",
    "layout",
    "buffer",
    "shared",
    "centroid",
    "flat",
    "smooth",
    "noperspective",
    "invariant",
    "patch",
    "sample",
    "subroutine",
    "coherent",
    "volatile",
    "restrict",
    "readonly",
    "writeonly",
];

/// What reads or does something beyond the field's own point.
const BEYOND: &[&str] = &[
    "dFdx",
    "dFdy",
    "fwidth",
    "texture",
    "texelFetch",
    "texture2D",
    "textureLod",
    "textureSize",
    "textureOffset",
    "textureProj",
    "textureGrad",
];

/// Letters that select components.
const SELECTIONS: [&str; 3] = ["xyzw", "rgba", "stpq"];

/// Whether a word is of GLSL itself.
pub fn is_known(word: &str) -> bool {
    KNOWN.contains(&word)
}

/// Whether a word could select components of a vector.
pub fn is_selection(word: &str) -> bool {
    let is_of = |letters: &&str| word.chars().all(|c| letters.contains(c));
    word.len() <= 4 && SELECTIONS.iter().any(is_of)
}

/// Why a field cannot have a word, if it cannot.
pub fn refusal(word: &str) -> Option<String> {
    if GIVEN.contains(&word) {
        return Some(format!(
            "'{word}' is not allowed: the only input of a field is its point"
        ));
    }
    if word == "discard" {
        return Some("a field cannot 'discard': it has a value everywhere".to_owned());
    }
    if word.starts_with("gl_") || word.starts_with("GL_") || BEYOND.contains(&word) {
        return Some(format!(
            "'{word}' belongs to a whole shader: the only input of a field is its point"
        ));
    }
    let kind = word.strip_prefix(['i', 'u']).unwrap_or(word);
    if ["sampler", "image"].iter().any(|of| {
        let rest = kind.strip_prefix(of).unwrap_or_default();
        rest.starts_with(|c: char| c.is_ascii_digit()) || rest.starts_with("Cube")
    }) {
        return Some(format!(
            "'{word}' is not allowed: the only input of a field is its point"
        ));
    }
    (word == "defined").then(|| "'defined' belongs to the preprocessor".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the renaming's one exception: no name of the program's own shaders looks like
    /// a selection of components.
    #[test]
    fn selections_and_names_are_told_apart() {
        for word in ["x", "xyz", "rgba", "stp", "p", "aaaa"] {
            assert!(is_selection(word), "{word}");
        }
        for word in ["xr", "xyzwx", "origin", "outOrigin", "d"] {
            assert!(!is_selection(word), "{word}");
        }
        for word in ["isampler2D", "samplerCube", "uimage3D", "gl_x", "defined"] {
            assert!(refusal(word).is_some(), "{word}");
        }
        assert!(refusal("sampler").is_none() && refusal("imaged").is_none());
    }
}

//! The words of GLSL that a field may and may not use, and new names for globals.
//!
//! Names are renamed by macros, which would also rename the `.s` of a vector. So a global that looks like a selection
//! of components, such as `float s(float x)`, gets another name in the text itself: two fields with an `s` then do not
//! clash.

use super::tokens::Token;
use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

/// Types common to GLSL 3.30 and GLSL ES 3.00 that a function of one point can use.
const TYPES: &str = "
    void bool int uint float vec2 vec3 vec4 bvec2 bvec3 bvec4 ivec2 ivec3 ivec4 uvec2 uvec3
    uvec4 mat2 mat3 mat4 mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 mat3x4 mat4x2 mat4x3 mat4x4";

/// Other usable words common to both languages: qualifiers, and words of statements.
const WORDS: &str = "
    struct const in out inout highp mediump lowp precision if else for while do switch case
    default break continue return true false";

/// Functions common to both languages that a function of one point can use: a text can call them, but cannot declare
/// them again. In GLSL 3.30 a declaration replaces the function for the whole shader, in GLSL ES 3.00 it is an error.
///
/// All other functions of either language are names that a text may declare: they are then renamed, like all its
/// declarations.
const FUNCTIONS: &str = "
    radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2
    log2 sqrt inversesqrt abs sign floor trunc round roundEven ceil fract mod modf min max clamp
    mix step smoothstep isnan isinf floatBitsToInt floatBitsToUint intBitsToFloat
    uintBitsToFloat length distance dot cross normalize faceforward reflect refract
    matrixCompMult outerProduct transpose determinant inverse lessThan lessThanEqual greaterThan
    greaterThanEqual equal notEqual any all not";

/// Words for inputs from outside.
const GIVEN: &str = "
    uniform varying attribute layout buffer shared centroid flat smooth noperspective invariant
    patch sample subroutine coherent volatile restrict readonly writeonly";

/// Words for reading or doing something other than evaluating the field's own point.
const BEYOND: &str = "
    dFdx dFdy fwidth texture texelFetch texture2D textureLod textureSize textureOffset
    textureProj textureGrad";

/// Words that either language reserves for future use. Texts with them do not compile anywhere.
const RESERVED: &str = "
    active asm atomic_uint cast class common double dvec2 dvec3 dvec4 enum extern external
    filter fixed fvec2 fvec3 fvec4 goto half hvec2 hvec3 hvec4 inline input interface long
    namespace noinline output packed partition public resource row_major short sizeof static
    superp template this typedef union unsigned using";

/// The class of a word of GLSL.
#[derive(Clone, Copy, PartialEq)]
enum Class {
    Type,
    Word,
    Function,
    Given,
    Beyond,
    Reserved,
}

/// The classes of all words above.
static CLASSES: LazyLock<HashMap<&str, Class>> = LazyLock::new(|| {
    let lists = [
        (Class::Type, TYPES),
        (Class::Word, WORDS),
        (Class::Function, FUNCTIONS),
        (Class::Given, GIVEN),
        (Class::Beyond, BEYOND),
        (Class::Reserved, RESERVED),
    ];
    let words = lists.map(|(class, words)| words.split_whitespace().map(move |word| (word, class)));
    words.into_iter().flatten().collect()
});

/// Whether a word is in one of the lists above.
fn is_of(class: Class, word: &str) -> bool {
    CLASSES.get(word) == Some(&class)
}

/// Macros defined by the compiler.
const MACROS: &[&str] = &["__LINE__", "__FILE__", "__VERSION__", "defined"];

/// Letters that select components.
const SELECTIONS: [&str; 3] = ["xyzw", "rgba", "stpq"];

/// Whether a word belongs to GLSL.
pub fn is_known(word: &str) -> bool {
    is_language(word) || is_function(word)
}

/// Whether a word is a type of GLSL.
pub fn is_type(word: &str) -> bool {
    is_of(Class::Type, word)
}

/// Whether a word belongs to the language, so that it cannot be a name.
pub fn is_language(word: &str) -> bool {
    is_of(Class::Word, word) || is_type(word)
}

/// Whether a word is a function of GLSL that a text cannot declare again.
pub fn is_function(word: &str) -> bool {
    is_of(Class::Function, word)
}

/// The reason why a text cannot define or undefine a macro of this name, if any.
pub fn macro_refusal(word: &str) -> Option<String> {
    let is_of_compiler = word.starts_with("GL_") || MACROS.contains(&word);
    is_of_compiler.then(|| {
        format!("'{word}' is the compiler's: a text can neither define it nor undefine it")
    })
}

/// Whether a word could select components of a vector.
pub fn is_selection(word: &str) -> bool {
    let is_of = |letters: &&str| word.chars().all(|c| letters.contains(c));
    word.len() <= 4 && SELECTIONS.iter().any(is_of)
}

/// The reason why a field cannot contain a word, if any.
pub fn refusal(word: &str) -> Option<String> {
    if is_of(Class::Given, word) || is_opaque(word) {
        return Some(format!(
            "'{word}' is not allowed: the only input of a field is its point"
        ));
    }
    if word == "discard" {
        return Some("a field cannot 'discard': it has a value everywhere".to_owned());
    }
    if word.starts_with("gl_") || word.starts_with("GL_") || is_of(Class::Beyond, word) {
        return Some(format!(
            "'{word}' belongs to a whole shader: the only input of a field is its point"
        ));
    }
    if is_of(Class::Reserved, word) {
        return Some(format!(
            "'{word}' is a word that GLSL reserves for later: choose another name"
        ));
    }
    if word.contains("__") {
        return Some(format!(
            "'{word}' has two underscores in a row, which GLSL reserves: choose another name"
        ));
    }
    if is_of_renaming(word) {
        return Some(format!(
            "'{word}' begins like names that the program generates: choose another name"
        ));
    }
    (word == "defined").then(|| "'defined' belongs to the preprocessor".to_owned())
}

/// Whether a word begins with a prefix of renamed names: `user0_`, `users0_`. The macros that rename names could then
/// collide.
fn is_of_renaming(word: &str) -> bool {
    let Some(after) = word.strip_prefix("user") else {
        return false;
    };
    let number = after.strip_prefix('s').unwrap_or(after);
    let name = number.trim_start_matches(|c: char| c.is_ascii_digit());
    name.len() < number.len() && name.starts_with('_')
}

/// Whether a word is the type of a texture or an image: `sampler2D`, `uimageCube`.
fn is_opaque(word: &str) -> bool {
    let is_dimension = |rest: &str| {
        let is_named = ["Cube", "Buffer"].iter().any(|name| rest.starts_with(name));
        is_named || rest.starts_with(|c: char| c.is_ascii_digit())
    };
    let of_integers = word.strip_prefix(['i', 'u']);
    let kinds = [Some(word), of_integers].into_iter().flatten();
    let mut rests = kinds.flat_map(|kind| {
        let kinds = ["sampler", "image"];
        kinds
            .into_iter()
            .filter_map(move |of| kind.strip_prefix(of))
    });
    rests.any(is_dimension)
}

/// The words of a text with their new names; most words are unchanged.
pub struct Renamed<'a> {
    /// The new names of renamed tokens, by position.
    of: HashMap<usize, String>,
    tokens: &'a [Token<'a>],
}

impl<'a> Renamed<'a> {
    /// Chooses new names for a text with globals at these positions.
    pub fn new(tokens: &'a [Token<'a>], globals: &[usize]) -> Renamed<'a> {
        let selections = globals.iter().map(|place| tokens[*place].text);
        let wanted: HashSet<&str> = selections.filter(|word| is_selection(word)).collect();
        let mut of = HashMap::new();
        if !wanted.is_empty() {
            let names = new_names(tokens, wanted);
            let mut members = Members::default();
            for (place, token) in tokens.iter().enumerate() {
                let is_member = members.is_declared_by(token);
                let is_selected = place > 0 && tokens[place - 1].is(".");
                if let Some(name) = names.get(token.text).filter(|_| !is_member && !is_selected) {
                    of.insert(place, name.clone());
                }
            }
        }
        Renamed { of, tokens }
    }

    /// The output text of the token at this position.
    pub fn text(&self, place: usize) -> &str {
        self.of
            .get(&place)
            .map_or(self.tokens[place].text, String::as_str)
    }
}

/// Finds a new name for each wanted name: the name with a number, such that the text does not contain it and it does
/// not select components.
fn new_names<'a>(tokens: &[Token<'a>], wanted: HashSet<&'a str>) -> HashMap<&'a str, String> {
    let known: HashSet<&str> = tokens.iter().map(|token| token.text).collect();
    let new = |word: &'a str| {
        let mut numbered = (0..=tokens.len()).map(|number| format!("{word}{number}"));
        let free = numbered.find(|name| !known.contains(name.as_str()));
        free.map(|name| (word, name))
    };
    wanted.into_iter().filter_map(new).collect()
}

/// Detects the declarations of structure members.
#[derive(Default)]
struct Members {
    /// Whether a `struct` was read but not yet its `{`.
    begins: bool,
    is_inside: bool,
    /// Whether the next word is a member's type.
    is_type: bool,
    brackets: usize,
}

impl Members {
    /// Whether the token declares the name of a member.
    fn is_declared_by(&mut self, token: &Token) -> bool {
        match token.text {
            "struct" => self.begins = true,
            "{" if self.begins => (self.begins, self.is_inside, self.is_type) = (false, true, true),
            "}" => self.is_inside = false,
            "[" => self.brackets += 1,
            "]" => self.brackets = self.brackets.saturating_sub(1),
            ";" => (self.begins, self.is_type) = (false, true),
            "const" | "highp" | "mediump" | "lowp" => (),
            _ if self.is_inside && self.brackets == 0 && token.is_word() => {
                return !std::mem::take(&mut self.is_type);
            }
            _ => (),
        }
        false
    }
}

//! The words of GLSL that are allowed or forbidden in a field, and new names for some globals.
//!
//! The names of a field are renamed by macros. A macro for `s` would also rename the component selection `.s` of a
//! vector. A global that looks like a selection of components, such as `float s(float x)`, therefore gets a new name in
//! the text itself. Two fields that both declare an `s` then do not clash.

use super::tokens::Token;
use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

/// Types that exist in both GLSL 3.30 and GLSL ES 3.00, and that a function of one point can use.
const TYPES: &str = "
    void bool int uint float vec2 vec3 vec4 bvec2 bvec3 bvec4 ivec2 ivec3 ivec4 uvec2 uvec3
    uvec4 mat2 mat3 mat4 mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 mat3x4 mat4x2 mat4x3 mat4x4";

/// Other allowed words that exist in both languages: qualifiers and words of statements.
const WORDS: &str = "
    struct const in out inout highp mediump lowp precision if else for while do switch case
    default break continue return true false";

/// Functions that exist in both languages, and that a function of one point can use. A text can call them, but cannot
/// declare them again. In GLSL 3.30 such a declaration would replace the function for the whole shader. In GLSL ES 3.00
/// it is an error.
///
/// All other functions of the two languages are names that a text may declare. They are renamed like all declarations
/// of the text.
const FUNCTIONS: &str = "
    radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2
    log2 sqrt inversesqrt abs sign floor trunc round roundEven ceil fract mod modf min max clamp
    mix step smoothstep isnan isinf floatBitsToInt floatBitsToUint intBitsToFloat
    uintBitsToFloat length distance dot cross normalize faceforward reflect refract
    matrixCompMult outerProduct transpose determinant inverse lessThan lessThanEqual greaterThan
    greaterThanEqual equal notEqual any all not";

/// Words that declare external inputs.
const GIVEN: &str = "
    uniform varying attribute layout buffer shared centroid flat smooth noperspective invariant
    patch sample subroutine coherent volatile restrict readonly writeonly";

/// Functions that need more than the field's own point.
const BEYOND: &str = "
    dFdx dFdy fwidth texture texelFetch texture2D textureLod textureSize textureOffset
    textureProj textureGrad";

/// Words that one of the languages reserves for future use. A text that contains them does not compile.
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

/// Each word of the lists above, with its class.
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

/// Whether a word has this class.
fn is_of(class: Class, word: &str) -> bool {
    CLASSES.get(word) == Some(&class)
}

/// Macros that the compiler defines.
const MACROS: &[&str] = &["__LINE__", "__FILE__", "__VERSION__", "defined"];

/// Letters that select components.
const SELECTIONS: [&str; 3] = ["xyzw", "rgba", "stpq"];

/// Whether a word is defined by GLSL.
pub fn is_known(word: &str) -> bool {
    is_language(word) || is_function(word)
}

/// Whether a word is a GLSL type.
pub fn is_type(word: &str) -> bool {
    is_of(Class::Type, word)
}

/// Whether a word is reserved, so that it cannot be a name.
pub fn is_language(word: &str) -> bool {
    is_of(Class::Word, word) || is_type(word)
}

/// Whether a word is a GLSL function that a text cannot declare again.
pub fn is_function(word: &str) -> bool {
    is_of(Class::Function, word)
}

/// The reason why a text cannot define or undefine a macro with this name, if any.
pub fn macro_refusal(word: &str) -> Option<String> {
    let is_of_compiler = word.starts_with("GL_") || MACROS.contains(&word);
    is_of_compiler
        .then(|| format!("the compiler defines '{word}': a text cannot define or undefine it"))
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
        return Some("'discard' is not allowed: a field has a value everywhere".to_owned());
    }
    if word.starts_with("gl_") || word.starts_with("GL_") || is_of(Class::Beyond, word) {
        return Some(format!(
            "'{word}' is allowed in whole shaders only: the only input of a field is its point"
        ));
    }
    if is_of(Class::Reserved, word) {
        return Some(format!(
            "'{word}' is a word that GLSL reserves for future use: choose another name"
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

/// Whether a word begins with a prefix of renamed names, such as `user0_` or `users0_`. The macros that rename names
/// could collide with such a word.
fn is_of_renaming(word: &str) -> bool {
    let Some(after) = word.strip_prefix("user") else {
        return false;
    };
    let number = after.strip_prefix('s').unwrap_or(after);
    let name = number.trim_start_matches(|c: char| c.is_ascii_digit());
    name.len() < number.len() && name.starts_with('_')
}

/// Whether a word is an opaque type, such as `sampler2D` or `uimageCube`.
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

/// The words of a text, some of which have new names.
pub struct Renamed<'a> {
    /// The new names of renamed tokens, by the position of the token.
    of: HashMap<usize, String>,
    tokens: &'a [Token<'a>],
}

impl<'a> Renamed<'a> {
    /// Chooses new names for a text whose globals are at these positions.
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

    /// The text of the token at this position after renaming.
    pub fn text(&self, place: usize) -> &str {
        self.of
            .get(&place)
            .map_or(self.tokens[place].text, String::as_str)
    }
}

/// Finds a new name for each wanted name by appending a number. The text does not contain the new name, and it does not
/// select components.
fn new_names<'a>(tokens: &[Token<'a>], wanted: HashSet<&'a str>) -> HashMap<&'a str, String> {
    let known: HashSet<&str> = tokens.iter().map(|token| token.text).collect();
    let new = |word: &'a str| {
        let mut numbered = (0..=tokens.len()).map(|number| format!("{word}{number}"));
        let free = numbered.find(|name| !known.contains(name.as_str()));
        free.map(|name| (word, name))
    };
    wanted.into_iter().filter_map(new).collect()
}

/// Finds the names of structure members in a sequence of tokens.
#[derive(Default)]
struct Members {
    /// Whether a `struct` has been read, but not its `{`.
    begins: bool,
    is_inside: bool,
    /// Whether the next word is the type of a member.
    is_type: bool,
    brackets: usize,
}

impl Members {
    /// Whether this token is the declared name of a member.
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

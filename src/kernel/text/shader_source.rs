//! Pieces of shader text and where they come from.

use std::borrow::Cow;
use std::fmt::Write;

/// A piece of shader text: its file, and its first line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file under the repository's root, or what the piece is about.
    pub name: Cow<'static, str>,
    /// Number of its first line in that file, from 1.
    pub line: usize,
    /// The text itself.
    pub text: Cow<'static, str>,
}

impl Source {
    /// A piece that is no part of a file.
    pub fn new(name: impl Into<Cow<'static, str>>, text: impl Into<Cow<'static, str>>) -> Source {
        Source {
            name: name.into(),
            line: 1,
            text: text.into(),
        }
    }
}

/// A [`Source`] out of a file under `glsl/`. `scripts/mutate.sh` builds the tests with
/// `--cfg glsl_at_run_time`: it changes the files and builds nothing again.
macro_rules! source {
    ($file:expr) => {{
        #[cfg(not(glsl_at_run_time))]
        let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/", $file));
        #[cfg(glsl_at_run_time)]
        let text = $crate::kernel::read_at_run_time($file);
        $crate::kernel::Source::new(concat!("glsl/", $file), text)
    }};
}
pub(crate) use source;

/// The text of a file in the folder that the environment variable `ECHOMARCH_GLSL` names.
#[cfg(glsl_at_run_time)]
pub(crate) fn read_at_run_time(file: &str) -> String {
    let folder = std::env::var_os("ECHOMARCH_GLSL").expect("ECHOMARCH_GLSL names the folder");
    let path = std::path::Path::new(&folder).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Joins sources to one text. Each file has a number by which the driver's messages name it:
/// in the order in which the files come first, from 1.
pub fn join(sources: &[Source]) -> String {
    let mut files: Vec<&str> = Vec::new();
    let mut text = String::new();
    let mut before = "";
    for source in sources {
        let known = files.iter().position(|name| *name == source.name);
        let number = 1 + known.unwrap_or_else(|| {
            files.push(&source.name);
            files.len() - 1
        });
        let Source {
            name,
            line,
            text: part,
        } = source;
        // Parts of one file that follow each other are told once where they come from. Writing
        // to a String cannot fail.
        if before != name {
            let _ = writeln!(text, "// {number}: {name}");
        }
        before = name;
        let _ = write!(text, "#line {line} {number}\n{part}\n");
    }
    text
}

/// The file that has a number in a joined text.
pub fn file_name(text: &str, number: u32) -> Option<&str> {
    let start = format!("// {number}: ");
    text.lines().find_map(|line| line.strip_prefix(&start))
}

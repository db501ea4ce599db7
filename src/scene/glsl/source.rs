//! Pieces of shader text and where they come from.

use std::borrow::Cow;
use std::fmt::Write;

/// One piece of shader text: the file it stands in, and the text itself.
pub type Source = (Cow<'static, str>, Cow<'static, str>);

/// A [`Source`] out of a file under `glsl/`.
macro_rules! source {
    ($file:literal) => {
        (
            std::borrow::Cow::Borrowed(concat!("glsl/", $file)),
            std::borrow::Cow::Borrowed(include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/glsl/",
                $file
            ))),
        )
    };
}
pub(crate) use source;

/// Joins sources to one text, each numbered by `#line` as the driver's messages
/// will name it: the n-th source is file n, counted from 1.
pub fn join(sources: &[Source]) -> String {
    let mut text = String::new();
    for (index, (name, part)) in sources.iter().enumerate() {
        let number = index + 1;
        // Writing to a String cannot fail.
        let _ = write!(text, "// {number}: {name}\n#line 1 {number}\n{part}\n");
    }
    text
}

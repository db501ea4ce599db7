//! Text about the surfaces that lie in cells: one function over all kinds.

use super::scene_text::Text;
use super::surface_names::Named;
use std::fmt::Write;

/// A function over the kinds that are wanted: `head` up to its brace, a statement a kind,
/// and what is returned for none of them.
pub(super) fn of_kind(
    text: &Text,
    head: &str,
    wanted: impl Fn(&Named) -> bool,
    statement: impl Fn(&Named) -> String,
    otherwise: &str,
) -> String {
    let mut out = head.to_owned();
    for (kind, named) in text.instanced.iter().enumerate() {
        if wanted(named) {
            let (label, statement) = (&named.label, statement(named));
            let _ = writeln!(
                out,
                "    if (kind == {kind}.0) {{ {statement} }} // {label}"
            );
        }
    }
    out + otherwise + "}\n\n"
}

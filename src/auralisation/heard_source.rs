//! A summary of the sound of one source at the listener: the level, and the paths by kind.

use crate::bands;
use crate::response::{Figures, PathKind, Response};
use serde::Serialize;
use std::fmt;

/// Number and level of the exact paths of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeardKind {
    /// The kind of the paths.
    pub kind: PathKind,
    /// Number of paths.
    pub paths: usize,
    /// The strength *G* of these paths together, averaged over the bands, in decibels; `None` without paths.
    pub level_db: Option<f64>,
}

/// A summary of the sound of one source at the listener.
///
/// The text form lists the kinds of paths that are heard, and the late part, as in
/// `direct 13.8 dB, 5 mirrored 9.7 dB, late 4.1 dB`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeardSource {
    /// The strength *G* of all arrivals, averaged over the bands, in decibels; `None` without arrivals.
    pub level_db: Option<f64>,
    /// Number of exact paths.
    pub paths: usize,
    /// Whether the direct sound is among the exact paths.
    pub is_direct: bool,
    /// The exact paths of each kind, in the order of [`PathKind::ALL`].
    pub kinds: [HeardKind; PathKind::ALL.len()],
    /// The strength *G* of everything outside the exact paths, averaged over the bands, in decibels; `None` if there is
    /// nothing else.
    pub late_db: Option<f64>,
}

impl Default for HeardSource {
    /// Returns the summary of a source that is not heard.
    fn default() -> HeardSource {
        let none = |kind| HeardKind {
            kind,
            paths: 0,
            level_db: None,
        };
        HeardSource {
            level_db: None,
            paths: 0,
            is_direct: false,
            kinds: PathKind::ALL.map(none),
            late_db: None,
        }
    }
}

impl HeardSource {
    /// Summarises a response.
    pub fn of(response: &Response) -> HeardSource {
        HeardSource {
            level_db: Figures::strength_db(bands::mean(&response.energy())),
            paths: response.paths.len(),
            is_direct: response.direct().is_some(),
            kinds: PathKind::ALL.map(|kind| HeardKind::of(kind, response)),
            late_db: Figures::strength_db(bands::mean(&response.echogram.total())),
        }
    }
}

impl HeardKind {
    fn of(kind: PathKind, response: &Response) -> HeardKind {
        let paths = || response.paths.iter().filter(|path| path.kind == kind);
        let energy = paths().map(|path| bands::mean(&path.energy)).sum();
        HeardKind {
            kind,
            paths: paths().count(),
            level_db: Figures::strength_db(energy),
        }
    }
}

impl fmt::Display for HeardKind {
    /// Writes the number of paths and their level. The direct sound is one path, so its number is left out.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.kind != PathKind::Direct {
            write!(f, "{} ", self.paths)?;
        }
        f.write_str(self.kind.name())?;
        match self.level_db {
            Some(level_db) => write!(f, " {}", Decibels(level_db)),
            None => Ok(()),
        }
    }
}

impl fmt::Display for HeardSource {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let kinds = self.kinds.iter().filter(|kind| kind.paths > 0);
        let mut parts: Vec<String> = kinds.map(HeardKind::to_string).collect();
        parts.extend(self.late_db.map(|db| format!("late {}", Decibels(db))));
        match parts.is_empty() {
            true => f.write_str("nothing arrives"),
            false => f.write_str(&parts.join(", ")),
        }
    }
}

/// A level in decibels with one decimal and a typographic minus sign.
struct Decibels(f64);

impl fmt::Display for Decibels {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let text = format!("{:.1}", self.0);
        match text.strip_prefix('-') {
            Some("0.0") => f.write_str("0.0 dB"),
            Some(size) => write!(f, "−{size} dB"),
            None => write!(f, "{text} dB"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the text that the window, the page and `render` show: each kind with its number and level, in a fixed
    /// order, without kinds that are not heard.
    #[test]
    fn the_text_lists_what_is_heard() {
        let mut heard = HeardSource::default();
        assert_eq!(heard.to_string(), "nothing arrives");
        for (index, (paths, level_db)) in [(1, -12.34), (5, -18.0), (0, 0.0), (2, 3.06)]
            .into_iter()
            .enumerate()
        {
            heard.kinds[index].paths = paths;
            heard.kinds[index].level_db = (paths > 0).then_some(level_db);
        }
        heard.late_db = Some(-0.01);
        assert_eq!(
            heard.to_string(),
            "direct −12.3 dB, 5 mirrored −18.0 dB, 2 transmitted 3.1 dB, late 0.0 dB"
        );
    }

    /// Protects the names of the kinds: the text shows the names that JSON has.
    #[test]
    fn kinds_have_their_serialised_names() {
        for kind in PathKind::ALL {
            let json = serde_json::to_value(kind).unwrap();
            assert_eq!(json, kind.name());
        }
    }
}

//! What is heard of one source, in short.

use super::Response;
use crate::acoustics::strength_db;
use crate::bands;
use serde::Serialize;

/// What is heard of one source, in short.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeardSource {
    /// The strength *G* of all that arrives, the mean of the bands, in decibels; `None` if nothing does.
    pub level_db: Option<f64>,
    /// Exact paths.
    pub paths: usize,
    /// Whether the direct sound is one of them.
    pub is_direct: bool,
}

impl HeardSource {
    /// What the response tells of its source.
    pub fn of(response: &Response) -> HeardSource {
        HeardSource {
            level_db: strength_db(bands::mean(&response.energy())),
            paths: response.paths.len(),
            is_direct: response.direct().is_some(),
        }
    }
}

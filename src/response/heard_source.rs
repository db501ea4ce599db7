//! A summary of the sound of one source.

use super::Response;
use crate::acoustics::strength_db;
use crate::bands;
use serde::Serialize;

/// A summary of the sound of one source at the listener.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeardSource {
    /// The strength *G* of all arrivals, averaged over the bands, in decibels; `None` without arrivals.
    pub level_db: Option<f64>,
    /// Number of exact paths.
    pub paths: usize,
    /// Whether the direct sound is one of them.
    pub is_direct: bool,
}

impl HeardSource {
    /// Summarises a response.
    pub fn of(response: &Response) -> HeardSource {
        HeardSource {
            level_db: strength_db(bands::mean(&response.energy())),
            paths: response.paths.len(),
            is_direct: response.direct().is_some(),
        }
    }
}

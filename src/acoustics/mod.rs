//! What a listener hears of a place: energy against time, the figures of room acoustics, and
//! impulse responses.

mod arrival;
pub mod early;
mod echogram;
mod error;
mod figures;
mod impulse_response;

pub use arrival::{Arrival, Tap};
pub use echogram::{BATCHES, BINS_S, Echogram, EchogramRow};
pub use error::AcousticsError;
pub use figures::{BandFigures, Figures};
pub use impulse_response::{
    Format, ImpulseResponse, ImpulseSettings, ListenerAxes, MAX_SECONDS, RATES_HZ,
};

#[cfg(test)]
mod tests;

//! What a listener hears of a place: energy against time, the figures of room acoustics, and
//! impulse responses.
mod arrival;
mod echogram;
mod error;
mod figures;

pub use arrival::{Arrival, Tap};
pub use echogram::{BATCHES, BINS_S, Echogram, EchogramRow};
pub use error::AcousticsError;
pub use figures::{BandFigures, Figures};

/// The lowest and the highest rate of an impulse response, in hertz.
pub const RATES_HZ: std::ops::RangeInclusive<u32> = 8_000..=192_000;
/// The longest impulse response, in seconds.
pub const MAX_SECONDS: f64 = 60.0;

#[cfg(test)]
mod tests;

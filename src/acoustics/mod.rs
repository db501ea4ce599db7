//! Sound at a listener: energy against time, the figures of room acoustics, and impulse responses.
//! All of it is plain arithmetic on the CPU, in `f64`.
//!
//! ```text
//!  crossings of the listener ─▶ Echogram ─┬─▶ Figures (ISO 3382-1), with their errors
//!  exact paths ───────────────▶ Tap … ────┴─▶ ImpulseResponse: mono, stereo, AmbiX, binaural
//!  SOFA files ────────────────▶ HrirSet ────────────────────────────────────────────┘
//! ```
//!
//! # Units
//! The source has power 1. Energies are energy densities at the listener times the speed of sound,
//! in 1/m²: 1 / (4π r²) for the direct sound at r metres. Times are seconds from the source's
//! impulse, except those of figures, which count from the direct sound. Directions are those of
//! flight, away from where sound comes from, in world axes.
//!
//! ```
//! use echomarch::acoustics::{Echogram, Figures, Tap};
//! use echomarch::glam::DVec3;
//!
//! // The direct sound at 5 m, and a diffuse decay whose reverberation time is 1 s.
//! let direct_s = 5.0 / 343.0;
//! let direct = 1.0 / (4.0 * std::f64::consts::PI * 25.0);
//! let taps = [Tap { seconds: direct_s, energy: [direct; 8], direction: DVec3::X }];
//! let mut echogram = Echogram::with_edge_at(direct_s, 1e-3, 1)?;
//! for bin in 0..1000 {
//!     let late_s = (f64::from(bin) + 0.5) * 1e-3;
//!     let energy = 1e-4 * 10_f64.powf(-6.0 * late_s);
//!     echogram.add(0, direct_s + late_s, &[energy; 8], DVec3::ZERO)?;
//! }
//! let figures = Figures::new(&taps, &echogram, Some(direct_s), 1.0);
//! assert!((figures.bands[4].t30_s.unwrap() - 1.0).abs() < 1e-3);
//! # Ok::<(), echomarch::acoustics::AcousticsError>(())
//! ```

pub mod early;
mod echogram;
mod error;
mod figures;
pub mod hrir;
mod impulse_response;
#[cfg(test)]
mod tests;

pub use crate::arrival::{Arrival, Tap};
pub use echogram::{BATCHES, BINS_S, Echogram, EchogramRow};
pub use error::AcousticsError;
pub(crate) use error::check_taps;
pub use figures::{BandFigures, Figures, strength_db};
pub(crate) use figures::{CommonErrors, Record, uncertain_energy};
pub(crate) use impulse_response::{Encoding, amplitude, tap_filter_gain};
pub use impulse_response::{
    Format, ImpulseResponse, ImpulseSettings, ListenerAxes, MAX_SECONDS, RATES_HZ,
};

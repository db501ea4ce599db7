//! The references of the feature `reference`: whole waves, and the image sources of a rectangular room.

mod image_source;
mod shoebox_energies;
mod waves;

#[doc(hidden)]
pub use image_source::ShoeboxImages;
#[doc(hidden)]
pub use shoebox_energies::EnergiesByLength;
pub use shoebox_energies::{ImageSource, ShoeboxEnergies};
pub use waves::ExactWave;
#[doc(hidden)]
pub use waves::{PathVertex, sequence_hash};

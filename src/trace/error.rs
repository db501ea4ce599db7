//! What can go wrong between settings and a frame.

/// A frame that cannot be traced, and why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A setting outside its range.
    #[error("{what} must be {must}, not {value}")]
    BadSetting {
        /// Which setting, with its unit.
        what: &'static str,
        /// Its range.
        must: String,
        /// What was asked for.
        value: String,
    },
    /// More waves than the renderer's textures hold.
    #[error(
        "{waves} waves need a texture of {side} texels a side, and {renderer} allows {limit}: use at most {most} waves"
    )]
    TooManyWaves {
        /// Waves asked for.
        waves: u32,
        /// Side of the texture that they need.
        side: u32,
        /// The renderer's limit.
        limit: u32,
        /// Waves that fit.
        most: u64,
        /// The renderer's name.
        renderer: String,
    },
    /// More surface parameters than the renderer's uniforms hold.
    #[error(
        "the scene's {surfaces} surfaces need {needed} uniform vectors, and {renderer} has {limit}: use fewer surfaces"
    )]
    TooManySurfaces {
        /// Surfaces in the scene.
        surfaces: usize,
        /// Uniform vectors that they need.
        needed: usize,
        /// Uniform vectors that the renderer has.
        limit: usize,
        /// The renderer's name.
        renderer: String,
    },
    /// Waves were asked for before any frame was traced.
    #[error("no frame was traced yet")]
    NothingTraced,
}

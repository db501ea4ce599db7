//! The maximum values of settings, and the limits of marches.

/// Maximum waves in one frame: 2^24, a 4096 x 4096 texture pair.
pub const MAX_WAVES: u32 = 1 << 24;

/// Maximum iterations. A wave's two counters share one float of 24 bits, 12 each.
pub const MAX_ITERATIONS: u32 = 4095;

/// Maximum evaluations of the distance in one march.
///
/// Every step of the thesis' march is at least the minimum distance long, so with its own constants
/// a wave takes at most 300 / 0.1 = 3000 of them. The bound lies above that and keeps any other
/// setting from hanging the GPU.
pub const MAX_STEPS: u32 = 4096;

/// Maximum evaluations of the fields in one march. Relaxed steps and Newton's at the end take some
/// tens of them; a march that takes more grazes a surface.
pub const MAX_FIELD_STEPS: u32 = 1024;

/// Maximum steps that `hybrid` takes a line past the copies of repetitions that are endless, or
/// have more than 1,024 cells, in one flight. Two such flights fit a pass on llvmpipe. Among
/// rotated boxes 3 m to 4 m apart 10 of 524,288 waves reach it, and others still meet a box after
/// hundreds of kilometres, where a float resolves positions to some centimetres.
pub const MAX_COPY_STEPS: u32 = 32_000;

/// Maximum distance that may be requested, in metres: its square and the square of a wave's
/// movement on the way are still finite in `f32`.
pub(super) const MAX_DISTANCE: f32 = 1e15;

//! The texture units used by programs and uploads, whose bindings are restored in a caller's context.

use glow::HasContext;

/// The unit that textures are created and filled with, so that those bound for a pass stay bound. Every driver of
/// OpenGL 3.3 or ES 3.0 has at least 32 units.
pub(super) const SCRATCH_UNIT: u32 = 31;

/// The texture units that programs read from, and the one that textures are filled with.
pub(super) const UNITS: [u32; 5] = [0, 1, 2, 3, SCRATCH_UNIT];

/// Binds a texture of the context to a unit.
pub(super) fn bind(gl: &glow::Context, unit: u32, target: u32, texture: glow::Texture) {
    debug_assert!(
        UNITS.contains(&unit),
        "unit {unit} of a caller is not put back"
    );
    // SAFETY: the context is current, and the texture its own and of that target.
    unsafe {
        gl.active_texture(glow::TEXTURE0 + unit);
        gl.bind_texture(target, Some(texture));
    }
}

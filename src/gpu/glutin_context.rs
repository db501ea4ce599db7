//! Contexts by the library glutin, whichever way to OpenGL it takes.

use glutin::context::{ContextAttributesBuilder, Robustness};
use glutin::prelude::*;

/// A context that is told when the graphics card was reset, where the driver offers that: otherwise a lost context
/// looks like one that is slow.
///
/// # Errors
/// What the library answered to a context without.
pub(super) fn new_context<D: GlDisplay>(
    display: &D,
    config: &D::Config,
    attributes: ContextAttributesBuilder,
) -> Result<D::NotCurrentContext, glutin::error::Error> {
    let told = attributes
        .clone()
        .with_robustness(Robustness::RobustLoseContextOnReset);
    // SAFETY: the attributes name no window and share no other context.
    unsafe { display.create_context(config, &told.build(None)) }.or_else(|_| {
        // SAFETY: as above.
        unsafe { display.create_context(config, &attributes.build(None)) }
    })
}

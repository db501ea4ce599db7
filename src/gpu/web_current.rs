//! In a browser each context is always current: `current` for contexts that need not be made so.

use std::rc::Rc;

use super::backend::Backend;

/// Makes the context current.
///
/// # Errors
/// What the backend answered.
pub(super) fn make(context: &Rc<dyn Backend>) -> Result<(), String> {
    context.make_current()
}

/// There is nothing to release.
pub(super) fn release() {}

/// There is nothing to put back.
#[must_use]
pub(crate) struct Entered;

/// Makes the context current.
///
/// # Errors
/// Those of [`make`].
pub(super) fn enter(context: &Rc<dyn Backend>) -> Result<Entered, String> {
    make(context).map(|()| Entered)
}

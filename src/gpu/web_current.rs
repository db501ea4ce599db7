//! Replaces `current` in a browser, where each context is always current.

use std::rc::Rc;

use super::backend::Backend;

/// Makes the context current.
///
/// # Errors
/// The backend's answer.
pub(super) fn make(context: &Rc<dyn Backend>) -> Result<(), String> {
    context.make_current()
}

/// Does nothing: there is nothing to release.
pub(super) fn release() {}

/// Guard without effect: there is nothing to restore.
#[must_use]
pub(crate) struct Entered;

/// Makes the context current.
///
/// # Errors
/// The errors of [`make`].
pub(super) fn enter(context: &Rc<dyn Backend>) -> Result<Entered, String> {
    make(context).map(|()| Entered)
}

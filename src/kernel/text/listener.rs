//! What the listener is to a wave.

/// Whether waves meet the listener.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ListenerText {
    /// A wave that comes to its sphere has arrived, and stops.
    Solid,
    /// Waves fly through it: it is in no text about what lies ahead.
    Transparent,
}

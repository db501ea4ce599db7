//! The description of one kind of untrusted file.

/// A kind of file, and the function that reads it.
pub struct Target {
    pub name: &'static str,
    /// Valid files that are corrupted.
    pub corpus: Vec<Vec<u8>>,
    /// Words and symbols that have a meaning in this kind of file.
    pub tokens: &'static [&'static str],
    pub one: fn(&[u8]),
}

//! A kind of untrusted file, and the function that reads it.

/// One kind of file.
pub struct Target {
    pub name: &'static str,
    /// Valid files to start from.
    pub corpus: Vec<Vec<u8>>,
    /// Words and symbols with a meaning in such a file.
    pub tokens: &'static [&'static str],
    pub one: fn(&[u8]),
}

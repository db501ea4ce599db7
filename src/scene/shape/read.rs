//! From the content of a scene file to trees.

use super::Shape;
use crate::scene::SceneError;
use crate::scene::notation::Reader;

/// The form of one shape or operator in a file.
pub(crate) trait FromFile {
    /// The tree with it as its root.
    ///
    /// # Errors
    /// What is wrong with the files that it names.
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError>;
}

/// The children of an operator, as a file writes them.
pub(crate) trait Operands {
    /// How many they may be: least and most.
    const COUNT: (usize, usize);

    /// Each read in its place.
    ///
    /// # Errors
    /// What is wrong with the files that they name.
    fn read(self, reader: &mut Reader) -> Result<Vec<Shape>, SceneError>;
}

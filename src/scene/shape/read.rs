//! Converts the content of a scene file to trees.

use super::Shape;
use crate::scene::SceneError;
use crate::scene::notation::Reader;

/// The form of one shape or operator in a file.
pub(crate) trait FromFile {
    /// Reads the tree with it as its root.
    ///
    /// # Errors
    /// Errors of the files that it names.
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError>;
}

/// The children of an operator, as a file writes them.
pub(crate) trait Operands {
    /// Least and greatest number of children.
    const COUNT: (usize, usize);

    /// Reads the children in order.
    ///
    /// # Errors
    /// Errors of the files that they name.
    fn read(self, reader: &mut Reader) -> Result<Vec<Shape>, SceneError>;
}

//! Reads the numbers of a file: their values at the start, and the drivers of those that move.

use super::attached_files::Attached;
use super::numbers::{Number, Pair, Unit, Vector};
use crate::scene::{Driver, SceneError};
use glam::{Vec2, Vec3};

/// Reads one surface and collects the drivers of its numbers.
pub(crate) struct Reader<'a> {
    files: &'a Attached,
    drivers: Vec<Driver>,
    /// Prefix of the names of the numbers that are read: the path down the tree, as `1.0.`.
    at: String,
}

/// Numbers that belong together, a single one or those of a vector, as a file writes them.
pub(crate) trait ReadNumbers: Sized {
    /// The file's values.
    type Said<U: Unit>;

    /// Returns their values at the start and keeps the drivers.
    fn read<U: Unit>(said: Self::Said<U>, name: &str, reader: &mut Reader) -> Self;
}

impl ReadNumbers for f32 {
    type Said<U: Unit> = Number<U>;

    fn read<U: Unit>(said: Number<U>, name: &str, reader: &mut Reader) -> f32 {
        reader.number(name, said)
    }
}

impl ReadNumbers for Vec2 {
    type Said<U: Unit> = Pair<U>;

    fn read<U: Unit>(said: Pair<U>, name: &str, reader: &mut Reader) -> Vec2 {
        let [x, y] = said.0;
        Vec2::new(
            reader.number(&format!("{name}.x"), x),
            reader.number(&format!("{name}.y"), y),
        )
    }
}

impl ReadNumbers for Vec3 {
    type Said<U: Unit> = Vector<U>;

    fn read<U: Unit>(said: Vector<U>, name: &str, reader: &mut Reader) -> Vec3 {
        let [x, y, z] = said.0;
        Vec3::new(
            reader.number(&format!("{name}.x"), x),
            reader.number(&format!("{name}.y"), y),
            reader.number(&format!("{name}.z"), z),
        )
    }
}

impl<'a> Reader<'a> {
    /// A reader of a surface whose files are `files`.
    pub fn new(files: &'a Attached) -> Reader<'a> {
        Reader {
            files,
            drivers: Vec::new(),
            at: String::new(),
        }
    }

    /// The files that the scene names.
    pub fn files(&self) -> &'a Attached {
        self.files
    }

    /// The drivers of the numbers that were read.
    pub fn into_drivers(self) -> Vec<Driver> {
        self.drivers
    }

    /// Whether a driver moves a number whose name begins with `name`.
    pub fn moves(&self, name: &str) -> bool {
        let mut drivers = self.drivers.iter();
        drivers.any(|driver| driver.parameter.starts_with(name))
    }

    /// Returns a number's value at the start and keeps its driver.
    pub fn number<U>(&mut self, name: &str, said: Number<U>) -> f32 {
        if let Some(motion) = said.motion {
            let parameter = format!("{}{name}", self.at);
            self.drivers.push(Driver { parameter, motion });
        }
        said.start
    }

    /// Reads the parts of the child with this index.
    pub fn within<T>(
        &mut self,
        index: usize,
        read: impl FnOnce(&mut Reader) -> Result<T, SceneError>,
    ) -> Result<T, SceneError> {
        let before = self.at.len();
        self.at.push_str(&format!("{index}."));
        let result = read(self);
        self.at.truncate(before);
        result
    }
}

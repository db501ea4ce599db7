//! Reads the files that a scene file names: height images and GLSL fields.

use crate::file_input::read_text;
use crate::scene::builtin::FIELDS;
use crate::scene::{HeightImage, SceneError, UserField};
use crate::text::in_a_line;
use glam::Vec3;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum size of a GLSL field in bytes: a larger file cannot be meant as one.
const LARGEST_FIELD: u64 = 1 << 20;

/// The places of a scene's files; each file is read once.
pub(crate) struct Attached {
    /// The name of the scene's text in errors.
    origin: String,
    place: Place,
    images: RefCell<Vec<(String, Arc<HeightImage>)>>,
    fields: RefCell<Vec<Arc<UserField>>>,
}

enum Place {
    /// In the scene file's folder.
    Folder(PathBuf),
    /// Within the program: names and texts.
    Embedded(&'static [(&'static str, &'static str)]),
}

impl Attached {
    /// Files in the scene file's folder, or in the current folder.
    pub fn in_folder(origin: &str, folder: &Path) -> Attached {
        Attached::new(origin, Place::Folder(folder.to_owned()))
    }

    /// Texts within the program.
    pub fn embedded(origin: &str, texts: &'static [(&'static str, &'static str)]) -> Attached {
        Attached::new(origin, Place::Embedded(texts))
    }

    fn new(origin: &str, place: Place) -> Attached {
        Attached {
            origin: origin.to_owned(),
            place,
            images: RefCell::default(),
            fields: RefCell::default(),
        }
    }

    /// The name of the scene's text in errors.
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// The folder of the files; `None` for texts within the program.
    pub fn folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Folder(folder) => Some(folder),
            Place::Embedded(_) => None,
        }
    }

    /// Reads a height image by the name that the scene gives.
    pub fn heights(&self, name: &str) -> Result<Arc<HeightImage>, SceneError> {
        let known = self.images.borrow();
        if let Some((_, image)) = known.iter().find(|(known, _)| known == name) {
            return Ok(image.clone());
        }
        drop(known);
        let image = HeightImage::from_file(&self.path(name)).map_err(|why| self.refused(why))?;
        let image = Arc::new(image);
        let read = (name.to_owned(), image.clone());
        self.images.borrow_mut().push(read);
        Ok(image)
    }

    /// Reads a GLSL field by the file name that the scene gives.
    pub fn field(
        &self,
        name: &str,
        size: Vec3,
        lipschitz: f32,
    ) -> Result<Arc<UserField>, SceneError> {
        let path = self.path(name);
        let same = |field: &&Arc<UserField>| {
            field.file == path && field.size == size && field.lipschitz == lipschitz
        };
        if let Some(field) = self.fields.borrow().iter().find(same) {
            return Ok(field.clone());
        }
        let text = self.text(name).map_err(|why| {
            self.refused(format!("cannot read the field {}: {why}", path.display()))
        })?;
        let field = Arc::new(UserField::new(path, text, size, lipschitz));
        self.fields.borrow_mut().push(field.clone());
        Ok(field)
    }

    fn path(&self, name: &str) -> PathBuf {
        match &self.place {
            Place::Folder(folder) => folder.join(name),
            Place::Embedded(_) => PathBuf::from(name),
        }
    }

    fn text(&self, name: &str) -> Result<String, String> {
        match &self.place {
            Place::Folder(folder) => {
                let path = folder.join(name);
                // A copy of a built-in scene in another folder still finds its field.
                match (path.exists(), embedded(FIELDS, name)) {
                    (false, Some(text)) => Ok(text),
                    _ => read_text(&path, LARGEST_FIELD).map_err(|error| error.to_string()),
                }
            }
            Place::Embedded(texts) => {
                embedded(texts, name).ok_or_else(|| "it is not within the program".to_owned())
            }
        }
    }

    fn refused(&self, why: String) -> SceneError {
        SceneError::Attached {
            origin: self.origin.clone(),
            why: in_a_line(&why).into_owned(),
        }
    }
}

fn embedded(texts: &[(&str, &str)], name: &str) -> Option<String> {
    let known = texts.iter().find(|(known, _)| *known == name);
    known.map(|(_, text)| (*text).to_owned())
}

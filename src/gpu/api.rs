//! The ways to reach OpenGL.

use std::fmt;
use std::str::FromStr;

/// A way to reach OpenGL: which library makes the context, and which language the shaders are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Api {
    /// OpenGL 3.3 core through EGL.
    #[default]
    Gl,
    /// OpenGL ES 3.0 with `EXT_color_buffer_float` through EGL.
    Gles,
    /// OpenGL 3.3 core through Mesa's off-screen library, on the processor; needs no EGL, device or display.
    OsMesa,
}

impl Api {
    /// All APIs, in order of preference.
    pub const ALL: [Api; 3] = [Api::Gl, Api::Gles, Api::OsMesa];
}

impl fmt::Display for Api {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Api::Gl => "gl",
            Api::Gles => "gles",
            Api::OsMesa => "osmesa",
        })
    }
}

impl FromStr for Api {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Api::ALL
            .into_iter()
            .find(|api| api.to_string() == name)
            .ok_or_else(|| format!("there is no GL API \"{name}\": use gl, gles or osmesa"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the API names: the command line accepts the names that are printed.
    #[test]
    fn names_read_back() {
        for api in Api::ALL {
            assert_eq!(api.to_string().parse(), Ok(api));
        }
        assert!("vulkan".parse::<Api>().unwrap_err().contains("osmesa"));
    }
}

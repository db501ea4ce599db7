//! A scene with a user's field in a separate file.

use std::path::Path;

/// A sphere as a user's field.
pub const BALL: &str = "float field(vec3 p) {\n    return length(p) - 1.0;\n}\n";

/// A room that contains a field from the file `my.glsl`.
pub const SCENE: &str = "Scene(
    surfaces: [
        Surface(shape: Room(size: (20, 20, 20))),
        Surface(shape: Field(file: \"my.glsl\", lipschitz: 1, size: (4, 4, 4)), position: (0, 0, -5)),
    ],
    source: Source(position: (4, 2, 3)),
    listener: Listener(position: (-4, -2, 4), radius: 1),
)";

/// Writes `my.glsl`.
pub fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("my.glsl"), text).unwrap();
}

//! OpenGL without acoustics.

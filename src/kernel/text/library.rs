//! The files under `glsl/` that the functions of scenes call.

use super::link::{Part, parts};
use super::shader_source::{Source, source};
use crate::scene::shape::every_part;
use std::collections::HashSet;
use std::sync::LazyLock;

macro_rules! files {
    ($folder:literal: $($file:ident)*) => {
        vec![$(source!(concat!($folder, "/", stringify!($file), ".glsl"))),*]
    };
}

macro_rules! files_of_parts {
    (
        shapes: { $($(#[$attr:meta])* $_s:literal $shape:ident::$_st:ident,)* }
        operators: { $($_o:literal $operator:ident::$_ot:ident,)* }
        written_out: { $($_w:tt)* }
        made: { $($_mn:literal $made:ident::$_mt:ident,)* }
    ) => {
        [
            [$($(#[$attr])* source!(concat!("shape/", stringify!($shape), ".glsl"))),*].to_vec(),
            files!("shape": $($made)*),
            files!("operator": $($operator)*),
        ]
        .concat()
    };
}

/// Every function of the files, cut into parts once.
static LIBRARY: LazyLock<Vec<Part>> = LazyLock::new(|| {
    let shared = files!(
        "common": ball beyond_turning bound chord corner cosine_sine exit_distance hash least_component listener mirror_direction
        no_hit onto_field quadric_form reflect_at_face rotate_by_quaternion rounding safe_inverse
        scene_data segment
    );
    let cells = files!("cells": directed distance fields fields_free grid grid_traversal records);
    let all: Vec<Source> = [shared, cells, every_part!(files_of_parts)].concat();
    all.into_iter().flat_map(parts).collect()
});

/// Every function, to be linked where it is called.
pub(in crate::kernel) fn library() -> Vec<Part> {
    LIBRARY.clone()
}

/// Whether the library has a function of this name: the use of a shape depends on the
/// functions in its file.
pub(super) fn has_function(name: &str) -> bool {
    static DEFINED: LazyLock<HashSet<&str>> = LazyLock::new(|| {
        let defined = LIBRARY.iter().flat_map(|part| &part.defines);
        defined.map(String::as_str).collect()
    });
    DEFINED.contains(format!("{name}(").as_str())
}

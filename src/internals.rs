//! What the programs in `apps/` share with the library. It is not a part of the public interface: anything in it may
//! change in any version.

macro_rules! open {
    ($($module:ident),*) => {
        $(#[allow(missing_docs)] pub mod $module { pub use crate::$module::*; })*
    };
}

open!(file_input, file_output, platform, ron_error, sampling, text);

pub mod plain_file {
    pub use crate::file_input::{count_names as names, open_plain as open};
}

pub mod shader {
    pub use crate::shader::{Layout, Lists, is_marched};
}

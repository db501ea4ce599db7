//! Items of the library that the programs in `apps/` use. They are not part of the public interface and may change in
//! any version.

macro_rules! open {
    ($($module:ident),*) => {
        $(#[allow(missing_docs)] pub mod $module { pub use crate::$module::*; })*
    };
}

open!(
    file_input,
    file_output,
    platform,
    ron_error,
    sampling,
    text,
    wave_budget
);

pub mod plain_file {
    pub use crate::file_input::{count_names as names, open_plain as open};
}

pub mod fields_cost {
    pub use crate::tracer::fields_cost::{
        FieldsCost, evaluations, evaluations_per_flight, flights,
    };
}

pub mod shader {
    pub use crate::shader::{Layout, Lists, is_marched};
}

//! Code shared by unit tests and integration tests, from `tests/common`.

#[path = "../tests/common/random.rs"]
mod random;
#[path = "../tests/common/shared.rs"]
mod shared;
#[path = "../tests/common/sofa.rs"]
pub mod sofa;

pub use random::Random;
pub use shared::*;

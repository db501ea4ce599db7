//! What unit tests share with the integration tests, written once in `tests/common`.

#[path = "../tests/common/random.rs"]
mod random;
#[path = "../tests/common/shared.rs"]
mod shared;

pub use random::Random;
pub use shared::*;

//! The ways to listen.

use crate::text::there_is_no;
use crate::trace::Profile;
use std::fmt;
use std::str::FromStr;

/// A way to listen. Names, for `FromStr` and `Display`: `full`, `balance`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Listen {
    /// Loudness, delays, echoes, reverberation.
    Full,
    /// Only the balance of left and right, as in the thesis: one pan, at one loudness.
    Balance,
}

impl Listen {
    /// The default way to listen for an algorithm: waves of the thesis end at the listener and only
    /// give a balance.
    pub fn for_profile(profile: Profile) -> Listen {
        match profile {
            Profile::Thesis => Listen::Balance,
            _ => Listen::Full,
        }
    }
}

impl FromStr for Listen {
    type Err = String;

    fn from_str(name: &str) -> Result<Listen, String> {
        match name {
            "full" => Ok(Listen::Full),
            "balance" => Ok(Listen::Balance),
            _ => Err(there_is_no("way to listen", name, &["full", "balance"])),
        }
    }
}

impl fmt::Display for Listen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Listen::Full => "full",
            Listen::Balance => "balance",
        })
    }
}

//! Exact solutions of sound diffraction, the references that diffracted levels are compared with.

mod axis;
mod fields;
mod oracle;
mod oracles_hold;
mod responses;
mod stated_errors;
mod walks;

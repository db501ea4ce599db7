//! A turn about z that grows along x.

use super::turning::turning;

turning! {
    /// Its child turned about z (right-handed) by an angle proportional to x: a bar along x becomes
    /// an arc.
    Bend about 2, a metre of "x"
}

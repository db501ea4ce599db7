//! A turn about y that grows along y.

use super::turning::turning;

turning! {
    /// Its child turned about y the further up one looks.
    Twist about 1, a metre of "y"
}

//! A turn about y that grows along y.

use super::turning::turning;

turning! {
    /// Its child turned about y by an angle proportional to y.
    Twist about 1, a metre of "y"
}

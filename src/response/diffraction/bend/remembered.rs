//! Values that a way needs more than once.

use std::cell::RefCell;

/// Values of a function, by its arguments. A copy has none: it may differ from its original.
#[derive(Debug)]
pub(super) struct Remembered<K, V>(RefCell<Vec<(K, V)>>);

impl<K: Copy + PartialEq, V: Copy> Remembered<K, V> {
    /// The value that belongs to these arguments, computed at the first call.
    pub fn get(&self, arguments: K, compute: impl FnOnce() -> V) -> V {
        let is_it = |(of, _): &&(K, V)| *of == arguments;
        let known = self.0.borrow().iter().rev().find(is_it).copied();
        match known {
            Some((_, value)) => value,
            None => {
                let value = compute();
                self.0.borrow_mut().push((arguments, value));
                value
            }
        }
    }
}

impl<K, V> Default for Remembered<K, V> {
    fn default() -> Remembered<K, V> {
        Remembered(RefCell::default())
    }
}

impl<K, V> Clone for Remembered<K, V> {
    fn clone(&self) -> Remembered<K, V> {
        Remembered::default()
    }
}

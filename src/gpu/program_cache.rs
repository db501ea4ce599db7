//! A cache of compiled programs.

use super::Program;
use std::num::NonZeroUsize;
use std::rc::Rc;

/// Programs by the key that determines their text. When the cache is full, the least recently used one is dropped,
/// which bounds the number kept during a walk through many scenes.
#[derive(Debug)]
pub struct ProgramCache<K: Eq> {
    /// The most recently used one last: with so few of them, a search costs less than a map.
    kept: Vec<(K, Rc<Program>)>,
    most: usize,
    compiled: usize,
}

impl<K: Eq> ProgramCache<K> {
    /// Creates an empty cache for at most `most` programs.
    pub fn new(most: NonZeroUsize) -> ProgramCache<K> {
        ProgramCache {
            kept: Vec::new(),
            most: most.get(),
            compiled: 0,
        }
    }

    /// Returns the program cached for `key`, or compiles and caches it.
    ///
    /// # Errors
    /// The errors of `compile`; then the cache is unchanged.
    pub fn get_or_compile<E>(
        &mut self,
        key: K,
        compile: impl FnOnce() -> Result<Program, E>,
    ) -> Result<Rc<Program>, E> {
        if let Some(at) = self.kept.iter().position(|(known, _)| *known == key) {
            self.kept[at..].rotate_left(1);
        } else {
            let program = Rc::new(compile()?);
            self.compiled += 1;
            if self.kept.len() == self.most {
                self.kept.remove(0);
            }
            self.kept.push((key, program));
        }
        Ok(self.kept[self.kept.len() - 1].1.clone())
    }

    /// Total number of programs compiled, including those dropped since.
    pub fn compiled(&self) -> usize {
        self.compiled
    }

    /// Number of programs in the cache.
    #[cfg(test)]
    pub fn kept(&self) -> usize {
        self.kept.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Context, ContextOptions, GpuError};

    const TWO: NonZeroUsize = NonZeroUsize::new(2).unwrap();

    /// Protects long walks through many scenes: unused programs are dropped, used ones stay.
    #[test]
    fn the_program_unused_longest_goes() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut cache = ProgramCache::new(TWO);
        let mut ask = |name: &'static str| {
            let text = "out vec4 colour; void main() { colour = vec4(1.0); }";
            let compile = || Program::fragment(&context, name, text);
            let program = cache.get_or_compile(name, compile).unwrap();
            (program, cache.compiled(), cache.kept())
        };
        let (first, ..) = ask("first");
        let (second, ..) = ask("second");
        assert!(Rc::ptr_eq(&ask("first").0, &first));
        let (_, compiled, kept) = ask("third");
        assert_eq!((compiled, kept), (3, 2));
        assert!(Rc::ptr_eq(&ask("first").0, &first));
        // Other holders of the program can still draw with it.
        assert_eq!(second.label(), "second");
        assert!(!Rc::ptr_eq(&ask("second").0, &second));
        assert_eq!(ask("second").1, 4);
    }

    /// Protects cached programs from a scene that does not compile.
    #[test]
    fn what_does_not_compile_drives_nothing_out() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut cache = ProgramCache::new(TWO);
        let good = "out vec4 colour; void main() { colour = vec4(1.0); }";
        for (name, text) in [("a", good), ("b", good), ("c", "void main() { no }")] {
            let compile = || Program::fragment(&context, name, text);
            let made = cache.get_or_compile(name, compile);
            assert_eq!(made.is_ok(), text == good);
        }
        assert_eq!((cache.compiled(), cache.kept()), (2, 2));
        let never = || -> Result<Program, GpuError> { panic!("it is kept") };
        cache.get_or_compile("a", never).unwrap();
        cache.get_or_compile("b", never).unwrap();
    }
}

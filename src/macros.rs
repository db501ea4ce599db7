//! Macros for repetitive code.

/// Defines setters that take the value of a field: `fn name(value: type) => field`.
macro_rules! setters {
    ($($(#[$doc:meta])* $see:vis fn $name:ident($value:ident: $kind:ty) => $field:ident;)*) => {
        $($(#[$doc])* #[must_use] $see fn $name(mut self, $value: $kind) -> Self {
            self.$field = $value;
            self
        })*
    };
}

/// Defines the names of an enum's values as typed and printed. `$what` is the word for such a value in the message for
/// an unknown name.
macro_rules! named_values {
    ($kind:ident, $what:literal: $($value:ident = $name:literal),*) => {
        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(match self {
                    $($kind::$value => $name),*
                })
            }
        }

        impl std::str::FromStr for $kind {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> Result<$kind, Self::Err> {
                match name {
                    $($name => Ok($kind::$value),)*
                    _ => Err($crate::error::Error::UnknownName {
                        message: $crate::text::there_is_no($what, name, &[$($name),*]),
                        name: name.to_owned(),
                    }),
                }
            }
        }
    };
}

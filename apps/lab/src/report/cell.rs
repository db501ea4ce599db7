//! A cell of a table, formatted for people or as data (CSV, JSON).

use crate::text::csv_cell;
use serde::{Serialize, Serializer};

/// A value of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A missing value.
    None,
    /// A count or another whole number.
    Integer(i128),
    /// A measured or computed number.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// Text.
    Text(String),
    /// A number with its confidence interval. `rough` marks an interval that was computed from too few values.
    Interval {
        value: f64,
        ends: Option<[f64; 2]>,
        rough: bool,
    },
}

/// The notation of a column's numbers in tables for people. CSV and JSON always contain every digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// The shortest digits that restore the same number.
    Plain,
    /// A fixed number of decimals.
    Fixed(usize),
    /// A fixed number of decimals, with a sign.
    Signed(usize),
    /// A share from 0 to 1, shown in percent with a fixed number of decimals.
    Percent(usize),
    /// A fixed number of significant digits, see [`significant`].
    Significant(usize),
}

impl Notation {
    /// Formats a number for people.
    pub fn of(self, value: f64) -> String {
        match self {
            Notation::Plain => value.to_string(),
            Notation::Fixed(digits) => format!("{value:.digits$}"),
            Notation::Signed(digits) => format!("{value:+.digits$}"),
            Notation::Percent(digits) => format!("{:.digits$}", 100.0 * value),
            Notation::Significant(digits) => significant(value, digits),
        }
    }
}

/// Formats a number with the given number of significant digits: as a decimal number from 0.01 to 1000, otherwise with
/// a power of ten.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let last = digits.saturating_sub(1);
    if !(0.01..1000.0).contains(&value.abs()) {
        return format!("{value:.last$e}");
    }
    let before_the_point = value.abs().log10().floor() as i32;
    let decimals = (last as i32 - before_the_point).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The text of a missing value.
const NOTHING: &str = "—";

impl Cell {
    /// A cell of text.
    pub fn text(text: impl Into<String>) -> Cell {
        Cell::Text(text.into())
    }

    /// The cell as text for people. Characters that [`crate::text::in_a_line`] escapes are escaped, but the text is not
    /// yet escaped for a format such as Markdown.
    pub fn for_people(&self, notation: Notation) -> String {
        match self {
            Cell::None => NOTHING.to_owned(),
            Cell::Integer(number) => match notation {
                Notation::Signed(_) if *number != 0 => format!("{number:+}"),
                _ => number.to_string(),
            },
            Cell::Number(number) => notation.of(*number),
            Cell::Flag(true) => "yes".to_owned(),
            Cell::Flag(false) => "no".to_owned(),
            Cell::Text(text) => crate::text::in_a_line(text).into_owned(),
            Cell::Interval { value, ends, rough } => {
                let value = notation.of(*value);
                let Some(ends) = ends else {
                    return value;
                };
                let [low, high] = ends.map(|end| notation.of(end));
                let mark = if *rough { "~" } else { "" };
                format!("{value} ({mark}{low} … {high})")
            }
        }
    }

    /// The cell as text for a CSV file. A missing value is empty, and numbers are written as in JSON.
    pub fn for_csv(&self) -> String {
        match self {
            Cell::None => String::new(),
            Cell::Integer(number) => number.to_string(),
            Cell::Number(number) | Cell::Interval { value: number, .. } => format!("{number:?}"),
            Cell::Flag(flag) => flag.to_string(),
            Cell::Text(text) => csv_cell(text),
        }
    }

    /// The two ends of an interval, as separate cells.
    pub fn ends(&self) -> [Cell; 2] {
        match self {
            Cell::Interval {
                ends: Some(ends), ..
            } => ends.map(Cell::Number),
            _ => [Cell::None, Cell::None],
        }
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Cell::None => to.serialize_none(),
            Cell::Integer(number) => to.serialize_i128(*number),
            Cell::Number(number) | Cell::Interval { value: number, .. } => {
                to.serialize_f64(*number)
            }
            Cell::Flag(flag) => to.serialize_bool(*flag),
            Cell::Text(text) => to.serialize_str(text),
        }
    }
}

macro_rules! whole_numbers {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Cell {
            fn from(number: $kind) -> Cell {
                Cell::Integer(number as i128)
            }
        }
    )*};
}
whole_numbers!(u8, u32, u64, usize, i64);

impl From<f64> for Cell {
    fn from(number: f64) -> Cell {
        Cell::Number(number)
    }
}

impl From<f32> for Cell {
    /// Converts to the `f64` with the same shortest decimal form as the `f32`.
    fn from(number: f32) -> Cell {
        let decimal = number.to_string().parse();
        Cell::Number(decimal.unwrap_or(f64::from(number)))
    }
}

impl From<bool> for Cell {
    fn from(flag: bool) -> Cell {
        Cell::Flag(flag)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        Cell::text(text)
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Cell {
        Cell::text(text)
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell::Text(text)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Cell {
        value.map_or(Cell::None, Into::into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects numbers that people compare: the number of significant digits does not depend on the size of a number,
    /// and only these two notations occur.
    #[test]
    fn significant_digits_are_counted() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.0"),
            (-0.0123, "-0.012"),
            (573.4, "573"),
            (1234.5, "1.2e3"),
            (4.4e-8, "4.4e-8"),
        ];
        for (value, shown) in cases {
            assert_eq!(significant(value, 2), shown);
        }
        assert_eq!(significant(4.4e-8, 1), "4e-8");
    }

    /// Protects confidence intervals, and the distinction between a missing value and zero in every format.
    #[test]
    fn cells_are_written_for_people_and_programs() {
        let of = |ends, rough| Cell::Interval {
            value: 1.0,
            ends,
            rough,
        };
        let notation = Notation::Fixed(1);
        let both = of(Some([0.5, 2.25]), true);
        assert_eq!(both.for_people(notation), "1.0 (~0.5 … 2.2)");
        assert_eq!(both.for_csv(), "1.0");
        assert_eq!(both.ends(), [Cell::Number(0.5), Cell::Number(2.25)]);
        assert_eq!(of(None, false).for_people(notation), "1.0");
        assert_eq!(of(None, false).ends(), [Cell::None, Cell::None]);
        assert_eq!(Cell::None.for_people(notation), "—");
        assert_eq!(Cell::None.for_csv(), "");
        assert_eq!(Cell::from(0.1f32).for_csv(), "0.1");
        assert_eq!(Cell::from("=1").for_csv(), "'=1");
        assert_eq!(Cell::from(-0.5).for_csv(), "-0.5");
        assert_eq!(Notation::Percent(1).of(0.5), "50.0");
    }
}

//! The form of a shard's rows: the permitted cells of the study's columns, spelled as the program writes them.
//!
//! A checksum detects damage, but anyone can compute a checksum. Each cell is therefore parsed by the type of its
//! column. A row is accepted only if its cells give the same text when they are written again. The comparison rejects
//! numbers that are not finite or outside the column's range, other spellings, and text in a column of numbers.

use super::Study;
use super::columns::{Column, Kind, Range};
use crate::report::Cell;

/// Maximum length of a number, in characters. The longest of all shortest forms is `-2.2250738585072014e-308`.
const LONGEST_NUMBER: usize = 24;

/// Maximum number of characters of a rejected cell that a message shows.
const SHOWN: usize = 40;

/// The columns of a row in the shards of a study.
pub(super) struct RowForm {
    columns: Vec<Column>,
}

impl RowForm {
    /// Creates the form of the rows of a study.
    pub fn of(study: &Study) -> RowForm {
        RowForm {
            columns: study.found_columns(),
        }
    }

    /// Rejects a text that is not a row of this point. Returns the reason.
    pub fn check(&self, text: &str, point: u64) -> Result<(), String> {
        let mut cells = text.split(',');
        if cells.next() != Some(point.to_string().as_str()) {
            return Err("it is of another point".to_owned());
        }
        let count = 1 + self.columns.len();
        let found = 1 + cells.clone().count();
        if found != count {
            return Err(format!("it has {found} cells, not {count}"));
        }
        for (column, cell) in self.columns.iter().zip(cells) {
            if !column.takes(cell) {
                let (name, what) = (&column.name, column.what());
                return Err(format!("{name} is {}, not {what}", shown(cell)));
            }
        }
        Ok(())
    }

    /// Whether a text is the beginning of a row of this point: complete cells, possibly followed by an incomplete
    /// number.
    pub fn is_begun(&self, text: &str, point: u64) -> bool {
        let index = point.to_string();
        let Some((first, rest)) = text.split_once(',') else {
            return index.starts_with(text);
        };
        if first != index {
            return false;
        }
        let (whole, last) = rest
            .rsplit_once(',')
            .map_or((None, rest), |(whole, last)| (Some(whole), last));
        let cells = || whole.into_iter().flat_map(|whole| whole.split(','));
        let Some(column) = self.columns.get(cells().count()) else {
            return false;
        };
        let mut whole = self.columns.iter().zip(cells());
        whole.all(|(column, cell)| column.takes(cell)) && column.takes_beginning(last)
    }
}

impl Column {
    /// Whether a text is a valid cell of this column.
    fn takes(&self, cell: &str) -> bool {
        if cell.is_empty() {
            return self.range.may_be_empty;
        }
        match self.kind {
            Kind::Whole => is_whole(cell, self.range),
            Kind::Real => is_real(cell, self.range),
            Kind::Text => cell.split(' ').all(|number| is_real(number, self.range)),
        }
    }

    /// Whether a text is the beginning of a valid cell of this column, whose last number may be truncated.
    fn takes_beginning(&self, cell: &str) -> bool {
        let (before, last) = match self.kind {
            Kind::Text => cell
                .rsplit_once(' ')
                .map_or((None, cell), |(before, last)| (Some(before), last)),
            Kind::Whole | Kind::Real => (None, cell),
        };
        let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '-' | '.' | 'e');
        before.is_none_or(|before| self.takes(before))
            && last.len() <= LONGEST_NUMBER
            && last.chars().all(is_of_number)
    }

    /// Describes the valid cells of the column, for a message.
    fn what(&self) -> String {
        // The message does not include the rounding tolerance.
        let [least, most] = [self.range.least, self.range.most].map(|end| end.round() + 0.0);
        let number = match self.kind {
            Kind::Whole => "a whole number",
            Kind::Real => "a number",
            Kind::Text => "numbers with a space between them, each",
        };
        let empty = if self.range.may_be_empty {
            ", or empty"
        } else {
            ""
        };
        match self.range.most == f64::MAX {
            true => format!("{number} from {least} on, as the program writes it{empty}"),
            false => format!("{number} from {least} to {most}, as the program writes it{empty}"),
        }
    }
}

fn is_whole(text: &str, range: Range) -> bool {
    let Some(number) = bounded(text).and_then(|text| text.parse::<u64>().ok()) else {
        return false;
    };
    range.holds(number as f64) && Cell::from(number).for_csv() == text
}

fn is_real(text: &str, range: Range) -> bool {
    let Some(number) = bounded(text).and_then(|text| text.parse::<f64>().ok()) else {
        return false;
    };
    range.holds(number) && Cell::from(number).for_csv() == text
}

/// The text; `None` if it is too long for a number.
fn bounded(text: &str) -> Option<&str> {
    (text.len() <= LONGEST_NUMBER).then_some(text)
}

impl Range {
    /// Whether a number is within the range; false for numbers that are not finite.
    fn holds(self, number: f64) -> bool {
        (self.least..=self.most).contains(&number)
    }
}

/// A cell as shown in a message. Long cells are shortened.
fn shown(cell: &str) -> String {
    let begin: String = cell.chars().take(SHOWN).collect();
    match begin.len() < cell.len() {
        true => format!("{begin:?}… ({} bytes)", cell.len()),
        false => format!("{begin:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::read;

    /// A study with a column of each kind: left, right, pan, six counts, figures with their errors, a gap, an echogram.
    fn form() -> RowForm {
        let study = "Study(scenes: [Scene(of: \"corner\")], settings: All(waves: [64], iterations: [2]), \
                     keep: Keep(response: Response(figures: [t30, d50, g], bands_hz: [1000], errors: true, \
                     echogram_ms: 50)))";
        RowForm::of(&read(study).unwrap())
    }

    const GOOD: [&str; 19] = [
        "7",
        "0.5",
        "1.5",
        "0.5",
        "2",
        "3",
        "59",
        "0",
        "128",
        "0",
        "0.75",
        "0.01",
        "0.5",
        "",
        "-3.25",
        "0.1",
        "4",
        "0.0005",
        "0.0 1e-7 0.25",
    ];

    fn with(at: usize, cell: &str) -> String {
        let mut cells = GOOD;
        cells[at] = cell;
        cells.join(",")
    }

    /// Protects tables from impossible numbers, and from text in place of numbers. Each error contains the name of the
    /// column.
    #[test]
    fn a_row_holds_what_its_columns_can_hold() {
        let form = form();
        assert_eq!(form.check(&GOOD.join(","), 7), Ok(()));
        let long = "0".repeat(100_000);
        for (at, name, cells) in [
            (
                1,
                "left",
                &[
                    "1e400",
                    "inf",
                    "nan",
                    "NaN",
                    "-0.5",
                    "64.1",
                    "",
                    "=cmd()",
                    "0x1",
                    "+0.5",
                    "00.5",
                    "0.50",
                    ".5",
                    "5",
                    " 0.5",
                    "0.5 ",
                    "1e0",
                    "5e-1",
                    long.as_str(),
                ][..],
            ),
            (3, "pan", &["1.0000001", "-2.0", "''"]),
            (
                4,
                "listener_hits",
                &["1.0", "-1", "65", "007", "1e1", "18446744073709551616", ""],
            ),
            (8, "zero_length_passes", &["129", "-0"]),
            (10, "t30_s_1000", &["-0.5", "1e9", "1000000000.0"]),
            (11, "t30_s_1000_error", &["-0.01", "1e300"]),
            (12, "d50_1000", &["1.5", "-0.5"]),
            (14, "g_db_1000", &["1e300", "-7000.0", "inf"]),
            (16, "gap_1000", &["6", "-1", "1.0", ""]),
            (17, "echogram_from_s", &["-0.0005", "1e9"]),
            (
                18,
                "echogram_1000",
                &[
                    "0.0  0.5",
                    "0.0 -1.0",
                    "0.5 nan",
                    " 0.5",
                    "0.5 ",
                    "0.0\u{a0}0.5",
                ],
            ),
        ] {
            for cell in cells {
                let refused = form.check(&with(at, cell), 7).expect_err(cell);
                assert!(
                    refused.starts_with(&format!("{name} is \"")),
                    "{cell}: {refused}"
                );
                assert!(refused.len() < 200, "{refused}");
            }
        }
        assert!(form.check(&GOOD.join(","), 8).is_err());
        assert!(form.check(&with(0, "07"), 7).is_err());
        assert!(
            form.check(&GOOD[..18].join(","), 7)
                .unwrap_err()
                .contains("18 cells, not 19")
        );
        assert!(form.check(&with(18, "0.5,0.5"), 7).is_err());
    }

    /// Protects results from an interruption, which may truncate a row at any byte, and from other data at the end of a
    /// file.
    #[test]
    fn a_row_may_be_cut_anywhere() {
        let (form, row) = (form(), GOOD.join(","));
        for end in 0..=row.len() {
            assert!(form.is_begun(&row[..end], 7), "{}", &row[..end]);
        }
        for text in [
            "8",
            "7,x",
            "7,nan",
            "7,0.5,=",
            "a",
            "7,0.5 ",
            "7,99.5,",
            &format!("{row},"),
            &format!("7,{}", "0".repeat(99)),
        ] {
            assert!(!form.is_begun(text, 7), "{text}");
        }
    }
}

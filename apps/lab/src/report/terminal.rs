//! Documents and tables for a terminal. Paragraphs have lines of at most [`WIDTH`](super::WIDTH) characters; tables
//! have their full width.

use super::table::Table;
use super::{Document, wrapped};
use comfy_table::{CellAlignment, ColumnConstraint, Width, presets};

/// Maximum width of a text column, in characters. Longer text is broken into lines.
const WIDEST_TEXT: u16 = 40;

impl Document {
    /// The document for a terminal.
    pub fn terminal(&self) -> String {
        let heading = |marks: &str, text: &str| wrapped(text, &format!("{marks} "));
        self.written(str::to_owned, heading, Table::terminal)
    }
}

impl Table {
    /// The table for a terminal.
    pub fn terminal(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::ASCII_MARKDOWN);
        table.set_header(self.shown().filter_map(|at| self.heads[at].shown()));
        for row in &self.rows {
            table.add_row(self.shown().map(|at| self.cell_for_people(row, at)));
        }
        for (column, at) in table.column_iter_mut().zip(self.shown()) {
            if self.heads[at].is_text {
                let widest = Width::Fixed(WIDEST_TEXT);
                column.set_constraint(ColumnConstraint::UpperBoundary(widest));
            } else {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        table.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::WIDEST_TEXT;
    use crate::report::{Cell, Column, Row, Table};

    struct Words(String);

    impl Row for Words {
        fn columns() -> Vec<Column<Words>> {
            let words = |row: &Words| Cell::from(&row.0);
            vec![
                Column::for_people("name", |_: &Words| "a-name-that-is-not-broken").text(),
                Column::for_people("first", words).text(),
                Column::for_people("number", |_: &Words| 1u32),
            ]
        }
    }

    /// Protects names from being broken, and terminals from long lines: each line ends with the column of numbers, and
    /// all lines have the same width.
    #[test]
    fn words_are_broken_into_lines_and_names_are_not() {
        for words in ["word ".repeat(60), "x".repeat(300)] {
            let text = Table::of([Words(words.clone())]).terminal();
            assert!(text.contains("| a-name-that-is-not-broken "), "{text}");
            let cell = |line: &str| line.split('|').nth(2).map(|cell| cell.chars().count());
            let most = usize::from(WIDEST_TEXT);
            assert!(text.lines().all(|line| cell(line) <= Some(most)), "{text}");
            assert_eq!(
                text.matches('x').count() + text.matches("word").count(),
                words.matches(['x', 'w']).count()
            );
        }
    }
}

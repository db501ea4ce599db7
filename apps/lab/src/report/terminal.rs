//! Documents and tables for a terminal of [`WIDTH`] columns.

use super::table::Table;
use super::{Block, Document, WIDTH, wrapped};
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Width, presets};

/// The space between two columns of a table, and at either end of a line, in characters.
const BETWEEN: usize = 3;

/// Minimum width of a column of text in characters, if its text is that long.
const LEAST_WORDS: usize = 18;

/// Maximum length of an unbroken word in characters.
const LONGEST_WORD: usize = 40;

impl Document {
    /// The document for a terminal: no line is wider than 100 columns.
    pub fn terminal(&self) -> String {
        let blocks: Vec<String> = self.blocks.iter().map(block).collect();
        blocks.join("\n\n")
    }
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(level, text) => wrapped(text, &format!("{} ", "#".repeat(*level))),
        Block::Paragraph(text) => wrapped(text, ""),
        Block::List(items) => {
            let items = items.iter().map(|item| wrapped(item, "- "));
            items.collect::<Vec<_>>().join("\n")
        }
        Block::Table(table) => table.terminal(),
    }
}

impl Table {
    /// The table for a terminal. Columns that do not fit side by side follow below; each part
    /// begins with the columns that identify a row.
    pub fn terminal(&self) -> String {
        let parts = self.parts();
        let parts: Vec<String> = parts.iter().map(|columns| self.part(columns)).collect();
        parts.join("\n\n")
    }

    /// The minimum width of a column, in characters.
    fn width(&self, column: usize) -> usize {
        let cells = self
            .rows
            .iter()
            .map(|row| self.cell_for_people(row, column));
        let head = &self.heads[column];
        let cells: Vec<String> = cells.chain(head.shown()).collect();
        let width = |text: &str| text.chars().count();
        let widest = cells.iter().map(|cell| width(cell)).max().unwrap_or(0);
        if !head.is_text {
            return widest;
        }
        let words = cells.iter().flat_map(|cell| cell.split_whitespace());
        let word = words.map(width).max().unwrap_or(0).min(LONGEST_WORD);
        word.max(widest.min(LEAST_WORDS))
    }

    /// The columns of each part.
    fn parts(&self) -> Vec<Vec<usize>> {
        let (keys, others): (Vec<usize>, Vec<usize>) =
            self.shown().partition(|&at| self.heads[at].is_key);
        let used = |columns: &[usize]| -> usize {
            let cells = columns.iter().map(|&at| self.width(at) + BETWEEN);
            cells.sum::<usize>() + 1
        };
        let mut parts = Vec::new();
        let mut part = keys.clone();
        for column in others {
            let is_first = part.len() == keys.len();
            part.push(column);
            if used(&part) > WIDTH && !is_first {
                part.pop();
                parts.push(std::mem::replace(&mut part, keys.clone()));
                part.push(column);
            }
        }
        parts.push(part);
        parts
    }

    fn part(&self, columns: &[usize]) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::ASCII_MARKDOWN);
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_width(WIDTH as u16);
        table.set_header(columns.iter().filter_map(|&at| self.heads[at].shown()));
        for row in &self.rows {
            table.add_row(columns.iter().map(|&at| self.cell_for_people(row, at)));
        }
        for (column, &at) in table.column_iter_mut().zip(columns) {
            let (alignment, constraint) = match self.heads[at].is_text {
                true => {
                    // Includes the space around a cell.
                    let least = self.width(at) + BETWEEN - 1;
                    let least = Width::Fixed(least as u16);
                    (CellAlignment::Left, ColumnConstraint::LowerBoundary(least))
                }
                false => (CellAlignment::Right, ColumnConstraint::ContentWidth),
            };
            column.set_cell_alignment(alignment);
            column.set_constraint(constraint);
        }
        table.to_string()
    }
}

#[cfg(test)]
mod tests {
    use crate::report::{Cell, Column, Row, Table, WIDTH};

    struct Wide(&'static str);

    impl Row for Wide {
        fn columns() -> Vec<Column<Wide>> {
            let number = |at: usize| {
                let heading = format!("heading {at}");
                Column::new(&heading, &heading, move |row: &Wide| {
                    format!("{} {at}", row.0)
                })
            };
            let mut columns: Vec<Column<Wide>> = (0..14).map(number).collect();
            columns[0] = Column::new("a", "a", |row: &Wide| Cell::from(row.0))
                .key()
                .text();
            columns
        }
    }

    struct Words(String);

    impl Row for Words {
        fn columns() -> Vec<Column<Words>> {
            let words = |row: &Words| Cell::from(&row.0);
            vec![
                Column::for_people("name", |_: &Words| "a-name-that-is-not-broken")
                    .key()
                    .text(),
                Column::for_people("first", words).text(),
                Column::for_people("second", words).text(),
                Column::for_people("number", |_: &Words| 1u32),
            ]
        }
    }

    fn fits(text: &str) -> bool {
        text.lines().all(|line| line.chars().count() <= WIDTH)
    }

    /// Protects terminals from wide tables, and readers from lost columns: each part fits, begins
    /// with the columns that identify a row, and all cells are present.
    #[test]
    fn a_wide_table_goes_on_below() {
        let text = Table::of([Wide("one"), Wide("two")]).terminal();
        assert!(fits(&text), "{text}");
        for part in text.split("\n\n") {
            assert!(part.contains("| a ") && part.contains("| two"), "{part}");
        }
        for at in 1..14 {
            assert!(text.contains(&format!("one {at} ")), "{text}");
            assert!(text.contains(&format!("heading {at} ")), "{text}");
        }
    }

    /// Protects names from being broken, and terminals from long sentences in cells.
    #[test]
    fn words_are_broken_into_lines_and_names_are_not() {
        let text = Table::of([Words("word ".repeat(60))]).terminal();
        assert!(fits(&text), "{text}");
        assert!(text.contains("| a-name-that-is-not-broken "), "{text}");
        let name = "x".repeat(300);
        assert!(fits(&Table::of([Words(name)]).terminal()));
    }
}

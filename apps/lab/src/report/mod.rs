//! Reports: the results of experiments as tables and documents.
//!
//! A [`Table`] has columns and rows. Each column is described once, beside the type of the rows. The description
//! contains the column's name in CSV and JSON, its heading in tables for people, its unit, its notation, and the
//! function that returns the cell of a row. CSV, JSON, Markdown and terminal text are written from this description. A
//! [`Document`] contains tables and the text around them. CSV and JSON contain every digit of a number. Terminal text
//! and Markdown contain the significant digits, with the unit in the heading.

mod cell;
mod markdown;
mod table;
mod terminal;

pub use cell::{Cell, significant};
pub use table::{Column, Row, Table};

use serde::Serialize;

/// Maximum number of characters in a line of terminal text.
const WIDTH: usize = 100;

/// The results of an experiment: data for [`Serialize`], and the texts and tables made from this data.
pub trait Report: Serialize {
    /// Name of the report's files, without extension.
    const NAME: &'static str;
    /// Whether the report has a plot.
    const HAS_PLOT: bool = false;

    /// The whole report as a document for people.
    fn document(&self) -> Document;

    /// All rows as one table, for CSV.
    fn table(&self) -> Table;

    /// The plot as SVG; an empty text for a report without a plot.
    ///
    /// # Errors
    /// If drawing fails. The error contains the reason.
    fn plot_svg(&self) -> Result<String, PlotError> {
        Ok(String::new())
    }
}

/// The reason why a plot cannot be drawn.
pub type PlotError = Box<dyn std::error::Error + Send + Sync>;

/// Headings, paragraphs, lists and tables, in order. The stored text is plain. Each output format escapes it.
#[derive(Clone, Debug, Default)]
pub struct Document {
    blocks: Vec<Block>,
}

#[derive(Clone, Debug)]
enum Block {
    /// A heading with its level, counted from 1.
    Heading(usize, String),
    Paragraph(String),
    List(Vec<String>),
    Table(Table),
}

impl Document {
    /// Adds a heading at a level, counted from 1.
    pub fn heading(&mut self, level: usize, text: impl Into<String>) {
        self.blocks.push(Block::Heading(level, text.into()));
    }

    /// Adds a paragraph. The output format breaks the text into lines.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Adds a list, unless it is empty.
    pub fn list(&mut self, items: Vec<String>) {
        if !items.is_empty() {
            self.blocks.push(Block::List(items));
        }
    }

    /// Adds a table of the given rows.
    pub fn table<R: Row>(&mut self, rows: impl IntoIterator<Item = R>) {
        self.blocks.push(Block::Table(Table::of(rows)));
    }

    /// The document as text. `heading` formats a heading from the marks of its level and its text.
    fn written(
        &self,
        escaped: fn(&str) -> String,
        heading: fn(&str, &str) -> String,
        table: fn(&Table) -> String,
    ) -> String {
        let block = |block: &Block| match block {
            Block::Heading(level, text) => heading(&"#".repeat(*level), text),
            Block::Paragraph(text) => wrapped(&escaped(text), ""),
            Block::List(items) => {
                let items = items.iter().map(|item| wrapped(&escaped(item), "- "));
                items.collect::<Vec<_>>().join("\n")
            }
            Block::Table(of) => table(of),
        };
        let blocks: Vec<String> = self.blocks.iter().map(block).collect();
        blocks.join("\n\n")
    }
}

/// Breaks a text at its spaces into lines of at most [`WIDTH`] characters. The first line begins with `mark`, the other
/// lines with spaces of the same width. A word that is too long for a line is split.
fn wrapped(text: &str, mark: &str) -> String {
    let indent = mark.chars().count();
    let mut lines = Vec::new();
    let mut line = mark.to_owned();
    let mut used = indent;
    for word in text.split_whitespace() {
        for piece in pieces(word, WIDTH - indent) {
            let width = piece.chars().count();
            if used > indent && used + 1 + width > WIDTH {
                lines.push(std::mem::replace(&mut line, " ".repeat(indent)));
                used = indent;
            }
            if used > indent {
                line.push(' ');
                used += 1;
            }
            line += &piece;
            used += width;
        }
    }
    lines.push(line);
    lines.join("\n")
}

/// Splits a word into pieces of at most `most` characters.
fn pieces(word: &str, most: usize) -> Vec<String> {
    let letters: Vec<char> = word.chars().collect();
    let pieces = letters.chunks(most);
    pieces.map(|piece| piece.iter().collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns;

    struct Pair(&'static str, Option<f64>);

    impl Row for Pair {
        fn columns() -> Vec<Column<Pair>> {
            let interval = |row: &Pair| {
                let value = row.1?;
                let ends = Some([value - 1.0, value + 1.0]);
                let rough = false;
                Some(Cell::Interval { value, ends, rough })
            };
            columns! { row: Pair;
                ("name", "what") => row.0, text();
                ("error_deg", "error") => interval(row).unwrap_or(Cell::None), interval().fixed(1).unit("°");
                ("answers") => row.1.map_or(3u32, |_| 3);
                (_, "said") => row.1.map_or("1/2", |_| "1/2"), text();
            }
        }
    }

    /// Protects every format: each shows its own columns, and all show the same values.
    #[test]
    fn a_table_is_written_in_every_format() {
        let table = Table::of([Pair("a|b", Some(2.25)), Pair("=c", None)]);
        let mut csv = Vec::new();
        table.write_csv(&mut csv).unwrap();
        let expected = "name,error_deg,error_deg_low,error_deg_high,answers\n\
                        a|b,2.25,1.25,3.25,3\n'=c,,,,3\n";
        assert_eq!(String::from_utf8(csv).unwrap(), expected);
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(json[0]["error_deg_high"], 3.25);
        assert_eq!(json[1]["error_deg"], serde_json::Value::Null);
        assert_eq!(json[1]["name"], "=c");
        let expected = "| what | error ° | said |\n| --- | ---: | --- |\n\
                        | a\\|b | 2.2 (1.2 … 3.2) | 1/2 |\n| =c | — | 1/2 |";
        assert_eq!(table.markdown(), expected);
    }

    /// Protects documents: blocks are separated, and text is escaped if the format requires it.
    #[test]
    fn a_document_is_escaped_and_broken_into_lines() {
        let mut document = Document::default();
        document.heading(2, "a *b*");
        document.paragraph(format!("<i> {}", "word ".repeat(40)));
        document.list(vec!["one".to_owned(), "two".to_owned()]);
        document.list(Vec::new());
        document.table([Pair("x", None)]);
        let text = document.markdown();
        assert!(text.starts_with("## a \\*b\\*\n\n&lt;i> word"), "{text}");
        assert!(text.contains("\n\n- one\n- two\n\n| what |"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        let long = wrapped(&"x".repeat(250), "- ");
        let widths: Vec<usize> = long.lines().map(|line| line.chars().count()).collect();
        assert_eq!(widths, [100, 100, 56]);
        assert!(long.lines().all(|line| line.starts_with(['-', ' '])));
    }
}

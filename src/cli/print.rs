//! What subcommands print with: JSON, tables, progress.

use crate::text;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::fmt;
use std::io::Write;

/// Prints a line, or a table; a reader that has gone away is an error like any other. What
/// would be no text on a terminal is spelled out.
pub fn line(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{}", text::in_lines(text))?;
    Ok(())
}

/// Prints text for people to read: lines wider than a terminal go on in the next. Tables stay as
/// they are.
pub fn prose(text: &str) -> anyhow::Result<()> {
    line(&folded(text))
}

/// The text with its lines broken at blanks so that they fit a terminal, but for those of tables.
fn folded(text: &str) -> String {
    let lines = text.split('\n').map(|line| match line.starts_with('|') {
        true => line.to_owned(),
        false => fold_line(line),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// One line, broken at blanks; what follows is as far in as its text is.
fn fold_line(line: &str) -> String {
    let words = line.trim_start_matches(' ');
    let indent = " ".repeat(line.len() - words.len());
    let (mut text, mut width) = (indent.clone(), indent.len());
    for (at, word) in words.split(' ').enumerate() {
        let needed = word.chars().count();
        if at > 0 && width + 1 + needed > WIDTH {
            text += "\n";
            text += &indent;
            width = indent.len();
        } else if at > 0 {
            text.push(' ');
            width += 1;
        }
        text += word;
        width += needed;
    }
    text
}

/// Tells something on standard error: every message of the program goes through here, and
/// none is longer than 10 lines and 1,000 characters.
pub fn tell(message: &str) {
    // No message is worth a failure when there is nowhere to write it.
    let _ = writeln!(std::io::stderr(), "{}", text::message(message));
}

/// Tells a record of JSON on standard error, for a program that drives this one.
#[cfg(feature = "demo")]
pub fn tell_record(json: &str) {
    // Whoever it is for may have gone.
    let _ = writeln!(std::io::stderr(), "{}", text::json_record(json));
}

/// Prints a value as indented JSON.
pub fn json(value: &impl Serialize) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(value)?;
    writeln!(std::io::stdout(), "{}", text::json(&json))?;
    Ok(())
}

/// Columns of a terminal that every table fits.
const WIDTH: usize = 100;

/// What stands between two columns, and at either end of a line, in characters.
const BETWEEN: usize = 3;

/// A table that fits a terminal: where its columns do not, the rest of them follows below, each
/// part beginning with the columns that say what a row is.
pub struct Wide {
    headings: Vec<String>,
    keys: usize,
    rows: Vec<Vec<String>>,
}

/// A table with these headings, every column to the right; the first `keys` of them say what a
/// row is.
pub fn table(keys: usize, headings: &[&str]) -> Wide {
    Wide {
        headings: headings.iter().map(|&heading| heading.to_owned()).collect(),
        keys,
        rows: Vec::new(),
    }
}

impl Wide {
    /// Adds a row below the others.
    pub fn add_row(&mut self, row: impl IntoIterator<Item = impl Into<String>>) {
        self.rows.push(row.into_iter().map(Into::into).collect());
    }

    /// Characters of the widest cell of a column.
    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| row.get(column));
        let cells = cells.chain(self.headings.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    }

    /// The columns of each part.
    fn parts(&self) -> Vec<Vec<usize>> {
        let keys: Vec<usize> = (0..self.keys.min(self.headings.len())).collect();
        let used = |columns: &[usize]| -> usize {
            let cells: usize = columns.iter().map(|&at| self.width(at) + BETWEEN).sum();
            cells + 1
        };
        let mut parts = Vec::new();
        let mut part = keys.clone();
        for column in keys.len()..self.headings.len() {
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

    fn part(&self, columns: &[usize]) -> Table {
        let of = |row: &Vec<String>| -> Vec<String> {
            let cells = columns.iter().filter_map(|&at| row.get(at));
            cells.cloned().collect()
        };
        let mut table = Table::new();
        table.load_style(presets::ASCII_MARKDOWN);
        // What is too wide even so is broken into lines.
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_width(WIDTH as u16);
        table.set_header(of(&self.headings));
        for row in &self.rows {
            table.add_row(of(row));
        }
        for column in table.column_iter_mut() {
            column.set_cell_alignment(CellAlignment::Right);
        }
        table
    }
}

impl fmt::Display for Wide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, columns) in self.parts().iter().enumerate() {
            let before = if index == 0 { "" } else { "\n\n" };
            write!(f, "{before}{}", self.part(columns))?;
        }
        Ok(())
    }
}

/// Prints a document of Markdown whose tables may be wider than a terminal, and so its
/// paragraphs, which are filled anew.
pub fn markdown(text: &str) -> anyhow::Result<()> {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let text = &paragraphs(text);
    for text in text.lines().chain([""]) {
        if let Some(cells) = text.strip_prefix('|') {
            let cells = cells.trim_end_matches('|').split('|');
            rows.push(cells.map(|cell| cell.trim().to_owned()).collect());
            continue;
        }
        if !rows.is_empty() {
            line(&from_markdown(std::mem::take(&mut rows)).to_string())?;
        }
        prose(text)?;
    }
    Ok(())
}

/// The document with each paragraph in one line.
fn paragraphs(text: &str) -> String {
    let mut out = String::new();
    let stands_alone = |line: &str| line.is_empty() || line.starts_with(['#', '|', '-', '!']);
    let mut joins = false;
    for line in text.lines() {
        let is_alone = stands_alone(line);
        if !out.is_empty() {
            out.push(if joins && !is_alone { ' ' } else { '\n' });
        }
        out.push_str(line);
        joins = !is_alone;
    }
    out
}

/// The rows of a table, of which the first are its headings and a line.
fn from_markdown(mut rows: Vec<Vec<String>>) -> Wide {
    let headings = rows.remove(0);
    let is_line = |row: &Vec<String>| row.iter().all(|cell| cell.starts_with(['-', ':']));
    rows.retain(|row| !is_line(row));
    Wide {
        headings,
        keys: 2,
        rows,
    }
}

/// A progress bar on standard error: on a terminal only, and not with `--quiet`.
pub fn progress(quiet: bool, total: u64, unit: &str) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    let template = format!("{{bar:40}} {{pos}}/{{len}} {unit} {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects terminals from long lines: all fit, no word is lost, tables and indents stay.
    #[test]
    fn prose_is_folded() {
        let words: Vec<String> = (0..60).map(|at| format!("word{at}")).collect();
        let long = words.join(" ");
        let table = format!("| {long} |");
        let text = folded(&format!("short\n\n{long}\n  {long}\n{table}"));
        let (prose, last) = text.rsplit_once('\n').unwrap();
        assert_eq!(last, table);
        assert!(
            prose.lines().all(|line| line.chars().count() <= WIDTH),
            "{text}"
        );
        assert_eq!(prose.split_whitespace().count(), 1 + 2 * words.len());
        let indented = prose.lines().filter(|line| line.starts_with("  word"));
        assert!(indented.count() > 2, "{text}");
        assert_eq!(folded("  a  b\n"), "  a  b\n");
        let text = paragraphs("# A\n\none\ntwo\n\n| a |\n| b |\nthree\nfour\n- x\n- y");
        assert_eq!(text, "# A\n\none two\n\n| a |\n| b |\nthree four\n- x\n- y");
    }

    /// Protects terminals from wide tables, and whoever reads them from lost columns: each part
    /// fits, begins with the columns that say what a row is, and all cells are there.
    #[test]
    fn a_wide_table_goes_on_below() {
        let headings: Vec<String> = (0..14).map(|at| format!("heading {at}")).collect();
        let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
        let mut wide = table(2, &headings);
        wide.add_row((0..14).map(|at| format!("cell {at} of one")));
        wide.add_row((0..14).map(|at| format!("{at}")));
        let text = wide.to_string();
        assert!(
            text.lines().all(|line| line.chars().count() <= WIDTH),
            "{text}"
        );
        for part in text.split("\n\n") {
            assert!(
                part.contains("heading 0 ") && part.contains("cell 1 of one"),
                "{part}"
            );
        }
        for at in 0..14 {
            assert!(text.contains(&format!("cell {at} of one")), "{text}");
        }
        let mut narrow = table(1, &["a", "b"]);
        narrow.add_row(["1", "2"]);
        assert_eq!(narrow.to_string(), "| a | b |\n|---|---|\n| 1 | 2 |");
        let mut long = table(1, &["a", "b"]);
        long.add_row(["1".to_owned(), "word ".repeat(60)]);
        assert!(
            long.to_string()
                .lines()
                .all(|line| line.chars().count() <= WIDTH)
        );
    }
}

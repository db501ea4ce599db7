//! Documents and tables as Markdown.

use super::Document;
use super::table::Table;
use crate::text::markdown as escaped;

impl Document {
    /// The document as Markdown. The text is escaped, so that it cannot create a tag, a link or a column.
    pub fn markdown(&self) -> String {
        let heading = |marks: &str, text: &str| format!("{marks} {}", escaped(text));
        self.written(escaped, heading, Table::markdown) + "\n"
    }
}

impl Table {
    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
        let headings = self.shown().filter_map(|at| self.heads[at].shown());
        let rule = self.shown().map(|at| match self.heads[at].is_text {
            true => "---".to_owned(),
            false => "---:".to_owned(),
        });
        let mut lines = vec![line(headings.collect()), line(rule.collect())];
        for row in &self.rows {
            let cells = self
                .shown()
                .map(|at| escaped(&self.cell_for_people(row, at)));
            lines.push(line(cells.collect()));
        }
        lines.join("\n")
    }
}

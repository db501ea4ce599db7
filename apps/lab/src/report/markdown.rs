//! Documents and tables as Markdown.

use super::table::Table;
use super::{Block, Document, wrapped};
use crate::text::markdown as escaped;

impl Document {
    /// The document as Markdown. Its text is escaped, so that it cannot make a tag, a link or a
    /// column.
    pub fn markdown(&self) -> String {
        let blocks: Vec<String> = self.blocks.iter().map(block).collect();
        blocks.join("\n\n") + "\n"
    }
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(level, text) => format!("{} {}", "#".repeat(*level), escaped(text)),
        Block::Paragraph(text) => wrapped(&escaped(text), ""),
        Block::List(items) => {
            let items = items.iter().map(|item| wrapped(&escaped(item), "- "));
            items.collect::<Vec<_>>().join("\n")
        }
        Block::Table(table) => table.markdown(),
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

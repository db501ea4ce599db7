//! Counts the empty cells of the tables, by reason.

use super::columns::{Column, gap_column_of};
use echomarch::response::Gap;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The number of empty cells of a column for one reason.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct EmptyCells {
    /// Name of the column.
    pub column: String,
    /// The reason: `nothing arrives`, `in a solid or outside the room`, `record too short`, `no late sound`, `too
    /// noisy`, or `not defined`.
    pub why: &'static str,
    /// Number of empty cells.
    pub cells: u64,
}

/// The reason reported for an empty cell if there is no column that states it.
const NOT_DEFINED: &str = "not defined";

/// Counts empty cells, row by row.
pub(super) struct EmptyCount {
    columns: Vec<Column>,
    /// For each column, the index of the column that states why its cells are empty.
    gaps: Vec<Option<usize>>,
    counts: BTreeMap<(usize, Option<Gap>), u64>,
}

impl EmptyCount {
    /// Creates a counter for rows of these columns.
    pub fn new(columns: Vec<Column>) -> EmptyCount {
        let place = |column: &Column| {
            let gap = gap_column_of(&column.name)?;
            columns.iter().position(|column| column.name == gap)
        };
        EmptyCount {
            gaps: columns.iter().map(place).collect(),
            columns,
            counts: BTreeMap::new(),
        }
    }

    /// Counts the empty cells of a row.
    pub fn add(&mut self, cells: &[impl AsRef<str>]) {
        for (at, cell) in cells.iter().enumerate() {
            if cell.as_ref().is_empty() {
                *self.counts.entry((at, self.reason(at, cells))).or_default() += 1;
            }
        }
    }

    /// The reason why the cell of a column is empty in a row.
    pub fn reason(&self, at: usize, cells: &[impl AsRef<str>]) -> Option<Gap> {
        let gap = (*self.gaps.get(at)?)?;
        let code = cells.get(gap)?.as_ref().parse().ok()?;
        Gap::of_code(code)
    }

    /// All counts, in the order of the columns.
    pub fn cells(&self) -> Vec<EmptyCells> {
        let counts = self.counts.iter();
        let cells = counts.map(|((at, gap), cells)| EmptyCells {
            column: self.columns[*at].name.clone(),
            why: gap.map_or(NOT_DEFINED, Gap::words),
            cells: *cells,
        });
        cells.collect()
    }
}

/// The counts as JSON: for each column, the reasons with their numbers of cells.
pub(super) fn json(cells: &[EmptyCells]) -> Value {
    let mut columns = Map::new();
    for EmptyCells { column, why, cells } in cells {
        let of_column = columns
            .entry(column.as_str())
            .or_insert_with(|| Map::new().into());
        if let Value::Object(reasons) = of_column {
            reasons.insert((*why).to_owned(), (*cells).into());
        }
    }
    columns.into()
}

#[cfg(test)]
mod tests {
    use super::super::columns::Kind;
    use super::*;

    /// Protects readers of a table: every empty cell has a reason.
    #[test]
    fn empty_cells_are_counted_by_reason() {
        let names = [
            "point",
            "t30_s_63",
            "t30_s_63_error",
            "g_db_1000",
            "exact_pan",
            "gap_63",
            "gap_1000",
        ];
        let columns = names.map(|name| Column::new(name, Kind::Real));
        let mut count = EmptyCount::new(columns.to_vec());
        count.add(&["0", "", "", "3", "0.5", "4", "0"]);
        count.add(&["1", "", "", "3", "", "4", "0"]);
        count.add(&["2", "", "", "", "0.5", "1", "1"]);
        let told: Vec<(String, &str, u64)> = count
            .cells()
            .into_iter()
            .map(|of| (of.column, of.why, of.cells))
            .collect();
        let expected = [
            ("t30_s_63", "nothing arrives", 1),
            ("t30_s_63", "too noisy", 2),
            ("t30_s_63_error", "nothing arrives", 1),
            ("t30_s_63_error", "too noisy", 2),
            ("g_db_1000", "nothing arrives", 1),
            ("exact_pan", "not defined", 1),
        ];
        assert_eq!(
            told,
            expected.map(|(column, why, cells)| (column.to_owned(), why, cells))
        );
        let json = json(&count.cells());
        assert_eq!(json["t30_s_63"]["too noisy"], 2);
    }
}

//! Tables of columns that are described once, and rows of typed cells.

use super::cell::{Cell, Notation};
use serde::ser::{SerializeMap, SerializeSeq};
use serde::{Serialize, Serializer};
use std::io::{self, Write};

/// A type whose values are the rows of a table.
pub trait Row: Sized {
    /// The columns, in order.
    fn columns() -> Vec<Column<Self>>;
}

/// The description of a column, independent of its rows.
#[derive(Clone, Debug)]
pub struct Head {
    /// The column's name in CSV and JSON; `None` for a column shown only to people.
    pub name: Option<String>,
    /// The column's heading on a terminal and in Markdown; `None` for a column of CSV and JSON only.
    pub heading: Option<String>,
    /// The unit of the numbers, shown after the heading.
    pub unit: &'static str,
    /// Whether the cells are text: left-aligned, and wrapped if long.
    pub is_text: bool,
    /// Whether CSV and JSON have two more cells with the ends of a confidence interval.
    pub is_interval: bool,
    /// The notation of the column's numbers.
    pub notation: Notation,
}

impl Head {
    /// The heading with the unit.
    pub fn shown(&self) -> Option<String> {
        let heading = self.heading.as_ref()?;
        Some(match self.unit {
            "" => heading.clone(),
            unit => format!("{heading} {unit}"),
        })
    }
}

/// A column of rows of one type.
pub struct Column<R> {
    head: Head,
    cell: Box<dyn Fn(&R) -> Cell>,
}

impl<R> Column<R> {
    fn with(name: Option<&str>, heading: Option<&str>, cell: Box<dyn Fn(&R) -> Cell>) -> Column<R> {
        Column {
            head: Head {
                name: name.map(str::to_owned),
                heading: heading.map(str::to_owned),
                unit: "",
                is_text: false,
                is_interval: false,
                notation: Notation::Plain,
            },
            cell,
        }
    }

    /// Creates a column with a name in CSV and JSON, and a heading in tables for people.
    pub fn new<C: Into<Cell>>(
        name: &str,
        heading: &str,
        cell: impl Fn(&R) -> C + 'static,
    ) -> Column<R> {
        Column::with(
            Some(name),
            Some(heading),
            Box::new(move |row| cell(row).into()),
        )
    }

    /// Creates a column of CSV and JSON only.
    pub fn for_programs<C: Into<Cell>>(name: &str, cell: impl Fn(&R) -> C + 'static) -> Column<R> {
        Column::with(Some(name), None, Box::new(move |row| cell(row).into()))
    }

    /// Creates a column that is shown only to people.
    pub fn for_people<C: Into<Cell>>(heading: &str, cell: impl Fn(&R) -> C + 'static) -> Column<R> {
        Column::with(None, Some(heading), Box::new(move |row| cell(row).into()))
    }

    /// Marks a column of text.
    #[must_use]
    pub fn text(mut self) -> Column<R> {
        self.head.is_text = true;
        self
    }

    /// Sets the unit of the numbers.
    #[must_use]
    pub fn unit(mut self, unit: &'static str) -> Column<R> {
        self.head.unit = unit;
        self
    }

    /// Marks a column whose cells are [`Cell::Interval`] or empty.
    #[must_use]
    pub fn interval(mut self) -> Column<R> {
        self.head.is_interval = true;
        self
    }

    /// Sets a fixed number of decimals.
    #[must_use]
    pub fn fixed(self, digits: usize) -> Column<R> {
        self.notation(Notation::Fixed(digits))
    }

    /// Sets a fixed number of decimals, with a sign.
    #[must_use]
    pub fn signed(self, digits: usize) -> Column<R> {
        self.notation(Notation::Signed(digits))
    }

    /// Shows shares from 0 to 1 in percent, with a fixed number of decimals.
    #[must_use]
    pub fn percent(self, digits: usize) -> Column<R> {
        self.notation(Notation::Percent(digits)).unit("%")
    }

    /// Sets the number of significant digits.
    #[must_use]
    pub fn significant(self, digits: usize) -> Column<R> {
        self.notation(Notation::Significant(digits))
    }

    fn notation(mut self, notation: Notation) -> Column<R> {
        self.head.notation = notation;
        self
    }
}

/// Returns the columns of a row type, in order. Each column has an expression for the cell of a row: `("name") => cell`
/// is a column of CSV and JSON, `(_, "heading") => cell` is a column for people, and `("name", "heading") => cell` is
/// both. Methods of [`Column`] follow after a comma. `..columns` adds further columns.
#[macro_export]
macro_rules! columns {
    ($row:ident: $kind:ty; $($items:tt)*) => {{
        let mut all = Vec::new();
        $crate::columns!(@add all, $row, $kind; $($items)*);
        all
    }};
    (@add $all:ident, $row:ident, $kind:ty;) => {};
    (@add $all:ident, $row:ident, $kind:ty; ..$more:expr; $($items:tt)*) => {
        $all.extend($more);
        $crate::columns!(@add $all, $row, $kind; $($items)*);
    };
    (@add $all:ident, $row:ident, $kind:ty;
        $heads:tt => $cell:expr $(, $($method:ident($($argument:expr),*)).+)?; $($items:tt)*) => {
        let column = $crate::columns!(@new $heads, move |$row: &$kind| $cell);
        $all.push(column$($(.$method($($argument),*))+)?);
        $crate::columns!(@add $all, $row, $kind; $($items)*);
    };
    (@new ($name:expr), $cell:expr) => {
        $crate::report::Column::for_programs($name, $cell)
    };
    (@new (_, $heading:expr), $cell:expr) => {
        $crate::report::Column::for_people($heading, $cell)
    };
    (@new ($name:expr, $heading:expr), $cell:expr) => {
        $crate::report::Column::new($name, $heading, $cell)
    };
}

/// Columns and rows, written as CSV, as JSON (with [`Serialize`], as a list of objects whose keys are the columns'
/// names), as Markdown or as terminal text.
#[derive(Clone, Debug)]
pub struct Table {
    pub(super) heads: Vec<Head>,
    pub(super) rows: Vec<Vec<Cell>>,
}

impl Table {
    /// Creates a table of the given rows.
    pub fn of<R: Row>(rows: impl IntoIterator<Item = R>) -> Table {
        let (heads, cells): (Vec<Head>, Vec<_>) = R::columns()
            .into_iter()
            .map(|column| (column.head, column.cell))
            .unzip();
        let row = |row: R| cells.iter().map(|cell| cell(&row)).collect();
        Table {
            heads,
            rows: rows.into_iter().map(row).collect(),
        }
    }

    /// The columns' names in CSV and JSON, in order. A confidence interval has three names: `NAME` for its value,
    /// `NAME_low` and `NAME_high` for its ends.
    pub fn names(&self) -> Vec<String> {
        let names = |head: &Head| -> Vec<String> {
            let Some(name) = &head.name else {
                return Vec::new();
            };
            let ends: &[&str] = match head.is_interval {
                true => &["", "_low", "_high"],
                false => &[""],
            };
            ends.iter().map(|end| format!("{name}{end}")).collect()
        };
        self.heads.iter().flat_map(names).collect()
    }

    /// The cells of a row, in the order of [`Table::names`].
    fn cells(&self, row: &[Cell]) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (head, cell) in self.heads.iter().zip(row) {
            if head.name.is_none() {
                continue;
            }
            cells.push(cell.clone());
            if head.is_interval {
                cells.extend(cell.ends());
            }
        }
        cells
    }

    /// Writes the table as CSV. The first line contains the columns' names, and a missing value is an empty cell.
    /// Numbers have enough digits to be restored exactly, and no text can begin a spreadsheet formula.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(self.names())?;
        for row in &self.rows {
            let cells = self.cells(row);
            writer.write_record(cells.iter().map(Cell::for_csv))?;
        }
        writer.flush()
    }

    /// The indices of the columns shown to people.
    pub(super) fn shown(&self) -> impl Iterator<Item = usize> {
        let heads = self.heads.iter().enumerate();
        heads.filter_map(|(index, head)| head.heading.as_ref().map(|_| index))
    }

    /// A cell as text for people, not yet escaped for any format.
    pub(super) fn cell_for_people(&self, row: &[Cell], column: usize) -> String {
        let notation = self.heads[column].notation;
        row[column].for_people(notation)
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let names = self.names();
        let mut list = to.serialize_seq(Some(self.rows.len()))?;
        for row in &self.rows {
            list.serialize_element(&Object(&names, &self.cells(row)))?;
        }
        list.end()
    }
}

/// A row as a JSON object.
struct Object<'a>(&'a [String], &'a [Cell]);

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(Some(self.0.len()))?;
        for (name, cell) in self.0.iter().zip(self.1) {
            map.serialize_entry(name, cell)?;
        }
        map.end()
    }
}

//! The tables of a joined study: CSV, Parquet, and a description of both.

use super::empty::{self, EmptyCells, EmptyCount};
use super::{Study, StudyError, VERSION};
use crate::report::Cell;
use echomarch::internals::file_output::{PartFile, check_inside, temporary_beside, write_inside};
use serde_json::json;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// The file that describes the tables.
const NOTE: &str = "study.json";

/// Tables that are written row by row, and get their final names when they are complete.
pub(super) struct Tables<'a> {
    study: &'a Study,
    folder: &'a Path,
    renderer: &'a str,
    csv: csv::Writer<File>,
    csv_part: PartFile,
    csv_path: PathBuf,
    #[cfg(feature = "parquet")]
    parquet: super::parquet_file::ParquetFile,
    /// Number of columns in a row.
    columns: usize,
    empty: EmptyCount,
}

impl<'a> Tables<'a> {
    /// Creates the tables of a study in its folder.
    pub fn create(
        study: &'a Study,
        folder: &'a Path,
        renderer: &'a str,
    ) -> Result<Tables<'a>, StudyError> {
        // The description is written last, so that it exists only if all files were written.
        check_inside(&folder.join(NOTE))?;
        let csv_path = folder.join("study.csv");
        let failed = |source| StudyError::output(&csv_path, source);
        let csv_part = temporary_beside(&csv_path).map_err(failed)?;
        let mut csv = csv::Writer::from_writer(csv_part.writer().map_err(failed)?);
        let columns = study.columns();
        let names = columns.iter().map(|column| column.name.as_str());
        csv.write_record(names)
            .map_err(|error| StudyError::output(&csv_path, error.into()))?;
        Ok(Tables {
            study,
            folder,
            renderer,
            csv,
            csv_part,
            #[cfg(feature = "parquet")]
            parquet: super::parquet_file::ParquetFile::create(
                &folder.join("study.parquet"),
                &columns,
                &about(study, renderer),
            )?,
            csv_path,
            columns: columns.len(),
            empty: EmptyCount::new(columns),
        })
    }

    /// Adds a row: the cells that identify a point, and the results of the point as written in its shard.
    pub fn row(&mut self, point: &[Cell], found: &str) -> Result<(), StudyError> {
        let cells = point.iter().map(Cell::for_csv);
        let found = found.split(',').map(str::to_owned);
        let cells: Vec<String> = cells.chain(found).collect();
        if cells.len() != self.columns {
            let (found, wanted) = (cells.len(), self.columns);
            let text = format!("a row has {found} columns, not {wanted}");
            return Err(StudyError::output(&self.csv_path, io::Error::other(text)));
        }
        self.empty.add(&cells);
        let written = self.csv.write_record(&cells);
        written.map_err(|error| StudyError::output(&self.csv_path, error.into()))?;
        #[cfg(feature = "parquet")]
        self.parquet.row(cells)?;
        Ok(())
    }

    /// Gives the files their final names. Returns their paths and the counts of empty cells.
    pub fn finish(self) -> Result<(Vec<PathBuf>, Vec<EmptyCells>), StudyError> {
        let empty = self.empty.cells();
        let Tables { csv, csv_path, .. } = self;
        let file = csv.into_inner();
        file.map_err(|error| StudyError::output(&csv_path, io::Error::other(error.to_string())))?;
        let named = self.csv_part.persist(&csv_path);
        named.map_err(|source| StudyError::output(&csv_path, source))?;
        echomarch::internals::file_input::note_output(&csv_path);
        let mut files = vec![csv_path];
        #[cfg(feature = "parquet")]
        files.push(self.parquet.finish()?);
        let note = self.folder.join(NOTE);
        let columns = self.study.columns().into_iter();
        let columns: Vec<String> = columns.map(|column| column.name).collect();
        let mut says = serde_json::Map::from_iter(
            about(self.study, self.renderer)
                .into_iter()
                .map(|(name, value)| (name.to_owned(), value.into())),
        );
        says.insert("points".to_owned(), self.study.points.into());
        says.insert("columns".to_owned(), json!(columns));
        says.insert("empty".to_owned(), empty::json(&empty));
        write_inside(&note, |out| {
            serde_json::to_writer_pretty(&mut *out, &says)?;
            out.write_all(b"\n")
        })?;
        files.push(note);
        Ok((files, empty))
    }
}

/// The description of the tables, which does not depend on the shards.
fn about(study: &Study, renderer: &str) -> Vec<(&'static str, String)> {
    vec![
        ("name", study.name.clone()),
        ("study", study.hash.clone()),
        ("version", VERSION.to_owned()),
        ("renderer", renderer.to_owned()),
    ]
}

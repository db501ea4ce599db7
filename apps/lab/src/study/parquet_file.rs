//! A joined study as a Parquet file with plain nullable columns in row groups.

use super::StudyError;
use super::columns::{Column, Kind};
use echomarch::internals::file_output::{PartFile, temporary_beside};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::convert::Infallible;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of rows that are kept in memory and written as one row group.
const ROWS_IN_GROUP: usize = 1 << 16;

/// The creator recorded in the file, without the machine and the time.
const CREATED_BY: &str = concat!("echomarch ", env!("CARGO_PKG_VERSION"));

/// A Parquet file that is written row by row, and gets its final name when it is complete.
pub(super) struct ParquetFile {
    path: PathBuf,
    part: PartFile,
    writer: SerializedFileWriter<File>,
    columns: Vec<Values>,
    rows: usize,
}

/// The unwritten values of a column: the existing values, and for each row 1 if it has a value or 0 if not.
enum Values {
    Whole(Vec<i64>, Vec<i16>),
    Real(Vec<f64>, Vec<i16>),
    Text(Vec<ByteArray>, Vec<i16>),
}

impl ParquetFile {
    /// Creates a file with these columns.
    pub fn create(
        path: &Path,
        columns: &[Column],
        about: &[(&'static str, String)],
    ) -> Result<ParquetFile, StudyError> {
        let begin = || -> io::Result<_> {
            let part = temporary_beside(path)?;
            let about = about.iter();
            let about = about.map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
            let properties = WriterProperties::builder()
                .set_created_by(CREATED_BY.to_owned())
                .set_key_value_metadata(Some(about.collect()))
                .build();
            let schema = schema(columns).map_err(io::Error::other)?;
            let writer = SerializedFileWriter::new(part.writer()?, schema, Arc::new(properties))
                .map_err(io::Error::other)?;
            Ok((part, writer))
        };
        let (part, writer) = begin().map_err(|source| StudyError::output(path, source))?;
        Ok(ParquetFile {
            path: path.to_owned(),
            part,
            writer,
            columns: columns.iter().map(Values::of).collect(),
            rows: 0,
        })
    }

    /// Adds a row of cells in the form of CSV.
    pub fn row(&mut self, cells: Vec<String>) -> Result<(), StudyError> {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            if !column.push(cell) {
                let text = "a cell in a column of numbers is not a number";
                return Err(StudyError::output(&self.path, io::Error::other(text)));
            }
        }
        self.rows += 1;
        if self.rows == ROWS_IN_GROUP {
            self.write_group()?;
        }
        Ok(())
    }

    /// Writes the remaining rows, and gives the file its final name.
    pub fn finish(mut self) -> Result<PathBuf, StudyError> {
        if self.rows > 0 {
            self.write_group()?;
        }
        let ParquetFile {
            path, part, writer, ..
        } = self;
        let done = writer
            .close()
            .map_err(io::Error::other)
            .and_then(|_| part.persist(&path));
        done.map_err(|source| StudyError::output(&path, source))?;
        echomarch::internals::file_input::note_output(&path);
        Ok(path)
    }

    fn write_group(&mut self) -> Result<(), StudyError> {
        let written = write_group(&mut self.writer, &mut self.columns);
        written.map_err(|error| StudyError::output(&self.path, io::Error::other(error)))?;
        self.rows = 0;
        Ok(())
    }
}

fn write_group(
    writer: &mut SerializedFileWriter<File>,
    columns: &mut [Values],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for values in columns {
        let Some(mut column) = group.next_column()? else {
            return Err(ParquetError::General("a column is missing".to_owned()));
        };
        values.write(&mut column)?;
        column.close()?;
    }
    group.close()?;
    Ok(())
}

impl Values {
    fn of(column: &Column) -> Values {
        match column.kind {
            Kind::Whole => Values::Whole(Vec::new(), Vec::new()),
            Kind::Real => Values::Real(Vec::new(), Vec::new()),
            Kind::Text => Values::Text(Vec::new(), Vec::new()),
        }
    }

    /// Adds a cell. Returns false if the cell does not fit this column.
    fn push(&mut self, cell: String) -> bool {
        fn add<T, E>(
            values: &mut Vec<T>,
            there: &mut Vec<i16>,
            cell: Option<Result<T, E>>,
        ) -> bool {
            let Ok(value) = cell.transpose() else {
                return false;
            };
            there.push(i16::from(value.is_some()));
            values.extend(value);
            true
        }
        let cell = (!cell.is_empty()).then_some(cell);
        match self {
            Values::Whole(values, there) => add(values, there, cell.map(|it| it.parse())),
            Values::Real(values, there) => add(values, there, cell.map(|it| it.parse())),
            Values::Text(values, there) => add(
                values,
                there,
                cell.map(|it| Ok::<_, Infallible>(it.into_bytes().into())),
            ),
        }
    }

    fn write(&mut self, column: &mut SerializedColumnWriter) -> Result<(), ParquetError> {
        match self {
            Values::Whole(values, there) => write::<Int64Type>(column, values, there),
            Values::Real(values, there) => write::<DoubleType>(column, values, there),
            Values::Text(values, there) => write::<ByteArrayType>(column, values, there),
        }
    }
}

fn write<T: DataType>(
    column: &mut SerializedColumnWriter,
    values: &mut Vec<T::T>,
    there: &mut Vec<i16>,
) -> Result<(), ParquetError> {
    let typed = column.typed::<T>();
    typed.write_batch(values, Some(there), None)?;
    values.clear();
    there.clear();
    Ok(())
}

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            Kind::Whole => (Physical::INT64, None),
            Kind::Real => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(field))
    };
    let fields = columns.iter().map(field);
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    let schema = Type::group_type_builder("study")
        .with_fields(fields)
        .build()?;
    Ok(Arc::new(schema))
}

#[cfg(test)]
mod tests {
    use crate::study::join;
    use crate::study::tests::{SMALL, read, shards, shards_of};
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use std::fs::File;

    /// Protects the Parquet file: it has the numbers of the CSV file, and null for each empty cell.
    #[test]
    fn the_table_is_read_back() {
        let study = read(SMALL).unwrap();
        let folder = shards(&study, 3);
        join(&study, folder.path(), &mut |_, _| ()).unwrap();
        let file = File::open(folder.path().join("study.parquet")).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let about = reader.metadata().file_metadata();
        let created = concat!("echomarch ", env!("CARGO_PKG_VERSION"));
        assert_eq!(about.created_by(), Some(created));
        let pairs = about.key_value_metadata().unwrap();
        let says = |key: &str| pairs.iter().find(|pair| pair.key == key)?.value.clone();
        assert_eq!(says("study").as_deref(), Some(study.hash()));
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().collect();
        assert_eq!(rows.len(), 60);
        let row = rows[37].as_ref().unwrap();
        let cell = |name: &str| {
            let mut cells = row.get_column_iter();
            cells.find(|(known, _)| *known == name).unwrap().1.clone()
        };
        assert_eq!(cell("point"), Field::Long(37));
        assert_eq!(cell("scene"), Field::Str("shoebox".to_owned()));
        assert_eq!(cell("listener_z_m"), Field::Double(5.0));
        assert_eq!(cell("left"), Field::Double(37.0 / 3.0));
        assert_eq!(cell("pan"), Field::Double(-0.25));
        // A figure whose cells are empty.
        let keep = "keep: Keep(pan: false, counts: false, response: Response(figures: [t30, g], bands_hz: [1000]))";
        let study = read(&SMALL.replace("keep: Keep(counts: false)", keep)).unwrap();
        let folder = shards_of(&study, 3, |point| format!("{point},,0.5,4"));
        join(&study, folder.path(), &mut |_, _| ()).unwrap();
        let file = File::open(folder.path().join("study.parquet")).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let row = reader.get_row_iter(None).unwrap().next().unwrap().unwrap();
        let cells: Vec<Field> = row
            .get_column_iter()
            .map(|(_, cell)| cell.clone())
            .collect();
        assert!(cells.ends_with(&[Field::Null, Field::Double(0.5), Field::Long(4)]));
    }
}

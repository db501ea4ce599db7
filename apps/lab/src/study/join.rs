//! Joins the shards of a study.

use super::lines::Header;
use super::read_shard::{Rows, verify};
use super::row_form::RowForm;
use super::shard::{folder_of, is_whole};
use super::tables::Tables;
use super::{BLOCK, EmptyCells, Shard, Study, StudyError, VERSION};
use echomarch::internals::file_output::{OutputError, prepare_folder};
use echomarch::scene::Scene;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Maximum number of shards listed in one message.
const MOST_NAMED: usize = 12;

/// The result of joining.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Joined {
    /// Number of rows in the tables.
    pub points: u64,
    /// Number of joined shards.
    pub shards: u32,
    /// Name of the renderer of all joined shards.
    pub renderer: String,
    /// The written files.
    pub files: Vec<PathBuf>,
    /// Empty cells of the tables, by column and reason.
    pub empty: Vec<EmptyCells>,
}

/// Joins the shards in a folder. The tables are written to the same folder, in the order of the study: `study.csv`,
/// with the feature `parquet` also `study.parquet`, and their description `study.json`. The bytes of the tables do not
/// depend on the number of shards or on the machines that computed them. `progress` receives the number of completed
/// steps and the total. Each point is one step of checking and one step of writing.
///
/// # Errors
/// [`StudyError::NotWhole`] with every shard that is missing, duplicated, damaged, or of another study, version or
/// renderer; [`StudyError::Output`].
pub fn join(
    study: &Study,
    folder: &Path,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Joined, StudyError> {
    let all = 2 * study.points;
    let found = found(study, folder, &mut |done| {
        progress(done.min(study.points), all)
    })?;
    let (shards, renderer) = chosen(study, folder, found)?;
    let of = shards.len() as u32;
    prepare_folder(folder)?;
    let rows: Vec<Rows> = shards.into_iter().map(Rows::of).collect();
    let (files, empty) = write(study, folder, &renderer, rows, &mut |done| {
        progress(study.points + done, all);
    })?;
    Ok(Joined {
        points: study.points,
        shards: of,
        renderer,
        files,
        empty,
    })
}

/// The path of a whole shard, with its header or the reason why it is rejected.
type Found = (PathBuf, Result<Header, String>);

/// Returns every file with the name of a shard, in the order of the names.
fn found(
    study: &Study,
    folder: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<Vec<Found>, StudyError> {
    let place = folder_of(folder);
    let files = std::fs::read_dir(&place).map_err(|_| StudyError::NotWhole {
        folder: folder.to_owned(),
        problems: vec![format!("there is no folder {}", place.display())],
    })?;
    let files = files.flatten().map(|file| file.path());
    let mut files: Vec<PathBuf> = files.filter(|path| is_whole(path)).collect();
    files.sort();
    let mut before = 0;
    let read = files.into_iter().map(|path| {
        let header = verify(&path, study, &mut |points| progress(before + points));
        before += header.as_ref().map_or(0, |header| header.points);
        (path, header)
    });
    Ok(read.collect())
}

/// Returns the shards in order, and their renderer. Fails if the shards do not form the study.
fn chosen(
    study: &Study,
    folder: &Path,
    found: Vec<Found>,
) -> Result<(Vec<PathBuf>, String), StudyError> {
    let ours = |header: &&Header| header.study == study.hash && header.version == VERSION;
    let headers = || found.iter().filter_map(|(_, header)| header.as_ref().ok());
    let of = most_common(headers().filter(ours).map(|header| header.of));
    let renderer = most_common(headers().filter(ours).map(|header| header.renderer.clone()));
    // If there is no shard of this study, use the most common shard count of the other files.
    let of = of.or_else(|| most_common(headers().map(|header| header.of)));
    let (of, renderer) = (of.unwrap_or(1), renderer.unwrap_or_default());
    let mut problems = Vec::new();
    problems.extend(several_counts(
        headers().filter(ours).map(|header| header.of),
    ));
    let mut taken: BTreeMap<u32, PathBuf> = BTreeMap::new();
    for (path, header) in found {
        let name = || path.file_name().unwrap_or_default().to_string_lossy();
        let why = match header {
            Err(why) => Some(why),
            Ok(header) => {
                refusal(study, of, &renderer, &header).or_else(|| match taken.get(&header.shard) {
                    None => {
                        taken.insert(header.shard, path.clone());
                        None
                    }
                    Some(other) => {
                        let other = other.file_name().unwrap_or_default().to_string_lossy();
                        let number = header.shard;
                        Some(format!("shard {number}/{of} exists twice, also as {other}"))
                    }
                })
            }
        };
        if let Some(why) = why {
            problems.push(format!("{}: {why}", name()));
        }
    }
    let missing: Vec<u32> = (1..=of)
        .filter(|number| !taken.contains_key(number))
        .collect();
    if !missing.is_empty() {
        problems.insert(0, missing_text(&missing, of));
    }
    if problems.is_empty() {
        return Ok((taken.into_values().collect(), renderer));
    }
    if let Some(more) = problems.len().checked_sub(MOST_NAMED + 1) {
        problems.truncate(MOST_NAMED);
        problems.push(format!("and {} more", more + 1));
    }
    Err(StudyError::NotWhole {
        folder: folder.to_owned(),
        problems,
    })
}

/// Returns advice for a folder with shards of several shard counts.
fn several_counts(of: impl Iterator<Item = u32>) -> Option<String> {
    let counts: BTreeSet<u32> = of.collect();
    let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
    (counts.len() > 1).then(|| {
        format!(
            "there are parts of a study cut into {} shards: remove the files of all but one of these, or use another folder",
            counts.join(" and into ")
        )
    })
}

/// Returns the reason for rejecting an undamaged shard; `None` if it is accepted.
fn refusal(study: &Study, of: u32, renderer: &str, header: &Header) -> Option<String> {
    // The header was checked, so the shard's numbers are valid.
    let shard = Shard::new(header.shard, header.of).ok()?;
    let expected = Header::new(study, shard, renderer);
    header.differs(&expected).or_else(|| {
        let number = header.shard;
        (header.of != of).then(|| format!("it is shard {number} of {}, not of {of}", header.of))
    })
}

/// Returns the most common value. Of equally common values, returns the smallest.
fn most_common<T: Ord>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: BTreeMap<T, usize> = BTreeMap::new();
    for value in values {
        *counts.entry(value).or_default() += 1;
    }
    let most = counts.values().copied().max()?;
    let first = counts.into_iter().find(|(_, count)| *count == most);
    first.map(|(value, _)| value)
}

/// Lists the numbers of the missing shards. Consecutive numbers are written as ranges.
fn missing_text(missing: &[u32], of: u32) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for &number in missing {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let shown = ranges.iter().take(MOST_NAMED).map(|(first, last)| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    });
    let mut text: Vec<String> = shown.collect();
    if ranges.len() > MOST_NAMED {
        text.push("and more".to_owned());
    }
    let (text, are) = (text.join(", "), missing.len());
    format!("{are} of {of} shards are missing: {text}")
}

fn write(
    study: &Study,
    folder: &Path,
    renderer: &str,
    mut shards: Vec<Rows>,
    progress: &mut dyn FnMut(u64),
) -> Result<(Vec<PathBuf>, Vec<EmptyCells>), StudyError> {
    let mut tables = Tables::create(study, folder, renderer)?;
    let count = shards.len() as u64;
    let form = RowForm::of(study);
    let mut posed: Option<((u64, u64), Scene)> = None;
    for index in 0..study.points {
        let rows = &mut shards[(index / BLOCK % count) as usize];
        let row = rows
            .next(&form, index)
            .map_err(|error| OutputError::new(rows.path(), error))?;
        let point = study.point(index);
        let key = (point.variant, point.time);
        let scene = match posed.take() {
            Some((known, scene)) if known == key => scene,
            _ => study
                .posed(point.variant, point.time)
                .map_err(|refused| StudyError::Point {
                    index,
                    what: study.label(&point),
                    source: Box::new(refused.into()),
                })?,
        };
        let (_, scene) = posed.insert((key, scene));
        let found = row.split_once(',').map_or("", |(_, found)| found);
        tables.row(&study.point_cells(&point, scene), found)?;
        progress(index + 1);
    }
    tables.finish()
}

//! The names of the files of several pairs of source and listener.

use super::pairs::NamedPair;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The names of the output files by pair.
pub struct FileNames {
    /// The end of each pair's file names, before the extension; empty if there is only one pair.
    ends: Vec<String>,
}

impl FileNames {
    /// File names with the names of sources and listeners. If two pairs would have the same files, the names contain
    /// the numbers of sources and listeners instead.
    pub fn of(pairs: &[NamedPair]) -> FileNames {
        if pairs.len() < 2 {
            return FileNames {
                ends: vec![String::new(); pairs.len()],
            };
        }
        let named = pairs.iter().map(|pair| end(&pair.source, &pair.listener));
        let named: Vec<String> = named.collect();
        let ends = match are_distinct(&named) {
            true => named,
            false => pairs.iter().map(of_numbers).collect(),
        };
        FileNames { ends }
    }

    /// The file of the pair with this index for a file given on the command line: `ir-SOURCE-LISTENER.wav` for `ir.wav`
    /// if there are several pairs, otherwise the given file.
    pub fn file(&self, given: &Path, pair: usize) -> PathBuf {
        let end = self.ends.get(pair).map_or("", String::as_str);
        let (Some(stem), false) = (given.file_stem(), end.is_empty()) else {
            return given.to_owned();
        };
        let mut name = stem.to_owned();
        name.push(end);
        if let Some(extension) = given.extension() {
            name.push(".");
            name.push(extension);
        }
        given.with_file_name(name)
    }

    /// The files of all pairs for a file given on the command line.
    pub fn all(&self, given: &Path) -> impl Iterator<Item = PathBuf> {
        (0..self.ends.len()).map(|pair| self.file(given, pair))
    }
}

fn end(source: &str, listener: &str) -> String {
    format!("-{}-{}", safe(source), safe(listener))
}

fn of_numbers(pair: &NamedPair) -> String {
    let [source, listener] = pair.numbers;
    format!("-{source}-{listener}")
}

/// The name with `_` instead of all characters that have a meaning in paths or in a shell.
fn safe(name: &str) -> String {
    let is_safe = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    let letters = name.chars();
    letters.map(|c| if is_safe(c) { c } else { '_' }).collect()
}

/// Whether these names belong to different files, also in file systems that ignore case.
fn are_distinct(names: &[String]) -> bool {
    let mut known = HashSet::new();
    names.iter().all(|name| known.insert(name.to_lowercase()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the folder and the extension of a file, and a name from becoming a path.
    #[test]
    fn names_of_sources_and_listeners_are_safe_in_file_names() {
        let ends = vec![end("../tuba", "row 3"), end("Flöte", "1")];
        let names = FileNames { ends };
        let file = |given: &str, pair| names.file(Path::new(given), pair);
        assert_eq!(file("out/ir.wav", 0), Path::new("out/ir-___tuba-row_3.wav"));
        assert_eq!(file("a.b.csv", 1), Path::new("a.b-Flöte-1.csv"));
        let only = FileNames {
            ends: vec![String::new()],
        };
        assert_eq!(only.file(Path::new("ir.wav"), 0), Path::new("ir.wav"));
    }

    /// Protects files from being overwritten by the file of another pair.
    #[test]
    fn names_that_differ_only_in_case_are_not_distinct() {
        let names = |ends: [(&str, &str); 2]| ends.map(|(from, to)| end(from, to)).to_vec();
        assert!(are_distinct(&names([("a", "b"), ("a", "c")])));
        assert!(!are_distinct(&names([("a", "b"), ("A", "b")])));
        assert!(!are_distinct(&names([("a-b", "c"), ("a", "b-c")])));
        assert!(!are_distinct(&names([("a b", "c"), ("a_b", "c")])));
    }
}

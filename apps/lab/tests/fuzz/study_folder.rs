//! Results folders with untrusted shards and working files, whose checksums are either unchanged or corrected.

use super::Target;
use super::shard_file::with_sums;
use echomarch::Tracer;
use echomarch::gl::Context;
use echomarch_lab::study::{Shard, Study, Worker, compute, join};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

const STUDY: &str = "Study(scenes: [Scene(of: \"corner\")], settings: All(waves: [4], iterations: [1]), \
                     seeds: Range(from: 1, count: 20))";

const TOKENS: &[&str] = &[
    "end ",
    "\t",
    "\n",
    ",",
    "nan",
    "inf",
    "1e400",
    "=cmd()",
    "format",
    "study",
    "version",
    "renderer",
    "shard",
    "of",
    "points",
    "echomarch shard 1",
    "\u{1b}",
    "00000000",
];

const FIRST: &str = "00001-of-00002";

/// A study, a worker for it, and a folder with its two shards.
struct Place {
    folder: tempfile::TempDir,
    worker: Worker<'static>,
    study: &'static Study,
    /// The bytes of both shards, as the program writes them.
    whole: [Vec<u8>; 2],
}

impl Place {
    fn new() -> Place {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("study.ron");
        std::fs::write(&file, STUDY).expect("a file");
        // Each thread leaks one study, which stays valid until the process ends.
        let study: &Study = Box::leak(Box::new(Study::from_file(&file).expect("a study")));
        let context = Context::headless(&Default::default()).expect("OpenGL");
        let mut worker = Worker::new(study, Tracer::new(&context).expect("a tracer"));
        let out = folder.path().join("out");
        let whole = [1, 2].map(|number| {
            let shard = Shard::new(number, 2).expect("a shard");
            compute(&mut worker, shard, &out, &mut |_| ()).expect("a shard");
            std::fs::read(shard.file(&out)).expect("its file")
        });
        Place {
            folder,
            worker,
            study,
            whole,
        }
    }

    /// Creates a new results folder, with these files among its shards.
    fn out(&self, files: &[(&str, &[u8])]) -> PathBuf {
        let out = self.folder.path().join("out");
        std::fs::remove_dir_all(&out).expect("the folder");
        std::fs::create_dir_all(out.join("shards")).expect("a folder");
        for (name, bytes) in files {
            std::fs::write(out.join("shards").join(name), bytes).expect("a file");
        }
        out
    }
}

thread_local! {
    static PLACE: RefCell<Place> = RefCell::new(Place::new());
}

/// The files of a folder with their contents, sorted by name.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    let files = entries
        .map(|entry| entry.path())
        .filter(|path| !path.is_dir());
    let mut files: Vec<_> = files
        .map(|path| (path.clone(), std::fs::read(&path).unwrap_or_default()))
        .collect();
    files.sort();
    files
}

fn corpus() -> Vec<Vec<u8>> {
    PLACE.with_borrow(|place| {
        let first = place.whole[0].clone();
        let half = first[..first.len() / 2].to_vec();
        let without_end = first[..first.len() - 80].to_vec();
        vec![first, half, without_end]
    })
}

/// The fuzz target of corrupted whole shards.
pub fn shards() -> Target {
    Target {
        name: "shards",
        corpus: corpus(),
        tokens: TOKENS,
        one: |data| {
            join_one(data);
            join_one(&with_sums(data));
        },
    }
}

/// Joins a corrupted shard with a valid one. A table must contain only finite numbers, and a rejected shard must leave
/// no other file.
fn join_one(data: &[u8]) {
    PLACE.with_borrow(|place| {
        let second = place.whole[1].as_slice();
        let out = place.out(&[
            ("00001-of-00002.shard", data),
            ("00002-of-00002.shard", second),
        ]);
        let before = contents(&place.folder.path().join("out/shards"));
        match join(place.study, &out, &mut |_, _| ()) {
            Err(error) => {
                assert!(error.is_bad_input(), "{error}");
                assert!(contents(&out).is_empty());
            }
            Ok(joined) => {
                let table = std::fs::read_to_string(&joined.files[0]).expect("a table");
                check_table(&table);
            }
        }
        assert_eq!(contents(&out.join("shards")), before);
    });
}

/// Checks the last nine columns of a table, which contain results: three numbers, and six counts of 4 waves.
fn check_table(table: &str) {
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 20);
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let found = &cells[cells.len() - 9..];
        for (at, cell) in found.iter().enumerate() {
            let number: f64 = cell.parse().expect(row);
            let least = if at == 2 { -1.0 } else { 0.0 };
            assert!((least..=4.0).contains(&number), "{row}");
            assert!(at < 3 || number.fract() == 0.0, "{row}");
        }
    }
}

/// The fuzz target of corrupted working files.
pub fn work_files() -> Target {
    Target {
        name: "work_files",
        corpus: corpus(),
        tokens: TOKENS,
        one: |data| {
            work_one(data);
            work_one(&with_sums(data));
            #[cfg(unix)]
            links_lead_nowhere(data);
        },
    }
}

/// Continues a corrupted working file. A rejected file must stay unchanged, and an accepted file must become a shard
/// with all lines.
fn work_one(data: &[u8]) {
    PLACE.with_borrow_mut(|place| {
        let out = place.out(&[("00001-of-00002.work", data)]);
        let before = contents(&out.join("shards"));
        let first = Shard::new(1, 2).expect("a shard");
        match compute(&mut place.worker, first, &out, &mut |_| ()) {
            Err(error) => {
                assert!(error.is_bad_input(), "{error}");
                assert_eq!(contents(&out.join("shards")), before);
            }
            Ok(()) => {
                let [(path, bytes)] = &contents(&out.join("shards"))[..] else {
                    panic!("a shard alone");
                };
                assert!(path.ends_with(format!("{FIRST}.shard")));
                let lines = |bytes: &[u8]| bytes.iter().filter(|byte| **byte == b'\n').count();
                assert_eq!(lines(bytes), lines(&place.whole[0]));
            }
        }
    });
}

/// Places an untrusted file as a symbolic or a hard link under each name that the program uses. The file must keep its
/// bytes, whatever is computed and joined.
#[cfg(unix)]
fn links_lead_nowhere(data: &[u8]) {
    PLACE.with_borrow_mut(|place| {
        let second = place.whole[1].clone();
        let out = place.out(&[("00002-of-00002.shard", &second)]);
        let victim = place.folder.path().join("victim");
        std::fs::write(&victim, data).expect("a file");
        let names = [
            "shards/00001-of-00002.work",
            "study.csv",
            "study.json",
            "study.parquet",
        ];
        let name = out.join(names[data.len() % names.len()]);
        match data.len() / names.len() % 2 {
            0 => std::os::unix::fs::symlink(&victim, &name),
            _ => std::fs::hard_link(&victim, &name),
        }
        .expect("a link");
        let first = Shard::new(1, 2).expect("a shard");
        let computed = compute(&mut place.worker, first, &out, &mut |_| ());
        assert_eq!(computed.is_err(), name.starts_with(out.join("shards")));
        let joined = join(place.study, &out, &mut |_, _| ());
        let is_link = name.is_symlink();
        assert!(joined.is_ok() || computed.is_err() || is_link);
        assert_eq!(std::fs::read(&victim).expect("the file"), data);
        let others = contents(place.folder.path());
        assert_eq!(others.len(), 2, "{others:?}");
    });
}

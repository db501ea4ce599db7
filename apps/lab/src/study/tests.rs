//! Tests of reading and joining studies without OpenGL. The tests write the shards themselves.

use super::build::study as build;
use super::check::Checker;
use super::file::StudyFile;
use super::lines::{Header, end_text, line};
use super::points::Point;
use super::shard::folder_of;
use super::{Shard, Study, StudyError, join};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A study of 60 points, each with three numbers.
pub(super) const SMALL: &str = r#"Study(
    name: "small",
    scenes: [Scene(of: "corner"), Scene(of: "shoebox")],
    listeners: Grid(from: (0, 0, 5), to: (2, 0, 7), counts: (3, 1, 2)),
    seeds: Range(from: 4, count: 5),
    keep: Keep(counts: false),
)"#;

const RENDERER: &str = "made up; 1.0";

/// Reads a study from a text. The scenes of the study are in `folder`.
fn read_in(text: &str, folder: &Path) -> Result<Study, StudyError> {
    let file = StudyFile::from_ron(text, "study")?;
    build(&file, &Checker { origin: "study" }, folder)
}

pub(super) fn read(text: &str) -> Result<Study, StudyError> {
    read_in(text, Path::new(""))
}

fn refusal(text: &str) -> String {
    read(text).expect_err(text).to_string()
}

/// A row whose numbers are computed from the index of its point.
fn row(index: u64) -> String {
    format!("{index},{:?},0.5,-0.25", index as f64 / 3.0)
}

/// The text of a whole shard, with the rows that `row` returns.
fn made_up(header: &Header, row: fn(u64) -> String) -> String {
    let shard = Shard::new(header.shard, header.of).unwrap();
    let mut text = line(&header.text());
    for place in 0..header.points {
        let index = shard.point(place);
        text += &line(&row(index));
    }
    let end = end_text(Sha256::new_with_prefix(&text));
    text + &line(&end)
}

/// Writes all `of` shards of a study to a new folder.
pub(super) fn shards(study: &Study, of: u32) -> tempfile::TempDir {
    shards_of(study, of, row)
}

/// Writes all `of` shards of a study to a new folder, with the rows that `row` returns.
pub(super) fn shards_of(study: &Study, of: u32, row: fn(u64) -> String) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder_of(folder.path())).unwrap();
    for shard in Shard::all(of) {
        let header = Header::new(study, shard, RENDERER);
        std::fs::write(shard.file(folder.path()), made_up(&header, row)).unwrap();
    }
    folder
}

fn joined(study: &Study, folder: &Path) -> Result<Vec<Vec<u8>>, String> {
    let joined = join(study, folder, &mut |_, _| ()).map_err(|error| error.to_string())?;
    assert_eq!(joined.points, study.points());
    let read = |file: &PathBuf| std::fs::read(file).unwrap();
    Ok(joined.files.iter().map(read).collect())
}

/// Protects the order of the points in every table: the seed changes fastest, and the scene slowest.
#[test]
fn points_are_in_the_order_of_the_axes() {
    let study = read(SMALL).unwrap();
    assert_eq!(study.points(), 2 * 6 * 5);
    let expected = Point {
        index: 37,
        variant: 1,
        time: 0,
        case: 0,
        source: 0,
        listener: 1,
        seed: 6,
    };
    assert_eq!(study.point(37), expected);
    let at = study.listener_of(&expected).unwrap();
    assert_eq!(at.to_array(), [1.0, 0.0, 5.0]);
}

/// Invalid fields, with the expected error for each.
const WRONG: &[(&str, &str)] = &[
    ("seeds: List([])", "seeds must be 1 to"),
    ("seeds: Range(from: 4294967295, count: 2)", "seeds.count"),
    (
        "settings: All(waves: [0])",
        "settings.waves[1] must be from 1",
    ),
    (
        "settings: All(iterations: [8, 4096])",
        "settings.iterations[2]",
    ),
    ("settings: All(profiles: [])", "settings.profiles"),
    ("times: List([0, -1])", "times[2] must be from 0 to 86400"),
    ("times: Range(from: 0, to: 1, count: 1)", "times.count"),
    (
        "times: Geometric(from: 0, to: 1, count: 3)",
        "0 between them",
    ),
    (
        "listener_radius: 0",
        "listener_radius must be metres above 0",
    ),
    ("listeners: List([(0, 1e9, 0)])", "listeners[1]"),
    (
        "listeners: Grid(from: (0, 0, 0), to: (1, 0, 1), counts: (2, 2, 2))",
        "listeners.counts[2]",
    ),
    (
        "sources: Path(through: [(0, 0, 0)], count: 3)",
        "sources.through must be 2 points or more",
    ),
    (
        "listeners: Grid(from: (0, 0, 0), to: (1, 1, 1), counts: (9999999, 9999999, 9999999))",
        "more than can be counted",
    ),
    (
        "keep: Keep(pan: false, counts: false)",
        "keep must be something",
    ),
    (
        "keep: Keep(response: Response(accuracy: 2))",
        "keep.response.accuracy must be a share of 0.001 to 0.05 (0.1 % to 5 %), not 2",
    ),
    (
        "settings: All(waves: [512, 1024]), keep: Keep(pan: false, counts: false, response: Response(accuracy: 0.05))",
        "settings.waves must be one number where only responses with an accuracy are kept",
    ),
    (
        "keep: Keep(response: Response(bands_hz: [440]))",
        "keep.response.bands_hz[1]",
    ),
    (
        "keep: Keep(response: Response(seconds: 100))",
        "keep.response.seconds must be from 0.001 to 60",
    ),
    (
        "keep: Keep(response: Response(figures: [g, g]))",
        "each once",
    ),
    (
        "settings: All(profiles: [thesis]), keep: Keep(response: Response())",
        "of hybrid or march where responses are kept, not thesis",
    ),
];

/// Protects the checks of a study: each error contains the invalid field and its valid range.
#[test]
fn every_field_is_checked() {
    let with = |more: &str| format!("Study(scenes: [Scene(of: \"corner\")], {more})");
    for (more, told) in WRONG {
        let said = refusal(&with(more));
        assert!(
            said.starts_with("study: ") && said.contains(told),
            "{more}: {said}"
        );
    }
    let said = refusal(&with("seeds: Some"));
    assert!(said.starts_with("study:1:"), "{said}");
    assert!(refusal(&with("colour: 1")).contains("colour"));
    let misplaced = refusal(&with("settings: All(accuracy: 0.05)"));
    assert!(
        misplaced.ends_with("is in keep: Keep(response: Response(accuracy: 0.02))"),
        "{misplaced}"
    );
    assert!(refusal("Study(scenes: [])").contains("scenes must be 1 to"));
    let unknown = refusal("Study(scenes: [Scene(of: \"corner\", values: {\"width\": List([1])})])");
    assert!(
        unknown.contains("scenes[1]: scene \"corner\" has no value named \"width\""),
        "{unknown}"
    );
}

/// Protects the errors of a malformed study: they contain the correct form, without Rust terms.
#[test]
fn a_study_is_refused_in_its_own_words() {
    let with = |more: &str| format!("Study(scenes: [Scene(of: \"corner\")], {more})");
    for (text, told) in [
        (
            "",
            "study:1:1: the file is empty: a study file begins with Study(…)",
        ),
        ("Study(scenes: [", "the file ends before Study(…) is closed"),
        (
            "Scene(surfaces: [])",
            "this is a scene; a study names it: Study(scenes: [Scene(of: ",
        ),
        (
            "Study(scenes: [Scene(of: \"crner\")])",
            "scenes[1]: there is no scene \"crner\"",
        ),
        (
            "Study(scenes: [Scene(of: \"crner\")])",
            "did you mean corner?",
        ),
        (
            "Study(scenes: [Scene(of: \"corner\", values: {\"door\": 3})])",
            "expected a list of numbers here: List([3])",
        ),
        (
            &with("settings: All(profiles: [hybird])"),
            "there is no profile \"hybird\"; there are: hybrid, march, thesis; did you mean hybrid?",
        ),
        (
            &with("settings: All(waves: [\"4096\"])"),
            "65536, 65_536 or 1e6",
        ),
        (&with("settings: All(waves: [0.5])"), "65536, 65_536 or 1e6"),
    ] {
        let said = refusal(text);
        assert!(said.contains(told), "{text}: {said}");
    }
}

/// Protects counts: a study accepts every form that the command line accepts, and all forms give the same study.
#[test]
fn counts_are_written_as_on_the_command_line() {
    let hash = |waves: &str| {
        let text =
            format!("Study(scenes: [Scene(of: \"corner\")], settings: All(waves: [{waves}]))");
        read(&text).unwrap().hash().to_owned()
    };
    assert_eq!(hash("10000"), hash("1e4"));
    assert_eq!(hash("10000"), hash("10_000"));
    assert_ne!(hash("10000"), hash("1e5"));
}

/// Protects readers of tables: the waves that responses with an accuracy trace are a result of their own, beside the waves
/// of the settings.
#[test]
fn waves_of_responses_with_an_accuracy_are_results() {
    let names = |keep: &str| {
        let study = read(&SMALL.replace("counts: false", keep)).unwrap();
        let names = study.found_columns().into_iter().map(|column| column.name);
        names
            .filter(|name| name.contains("waves"))
            .collect::<Vec<_>>()
    };
    assert!(names("counts: false, response: Response()").is_empty());
    let accurate = names("counts: false, response: Response(accuracy: 0.02)");
    assert_eq!(accurate, ["response_waves"]);
}

/// Protects the choice of diffraction in a study: it reaches the responses, and it changes the hash. A study that states
/// the default has the hash of a study without the choice.
#[test]
fn a_study_can_have_diffraction() {
    let with = |response: &str| {
        read(&SMALL.replace("counts: false", &format!("response: Response({response})"))).unwrap()
    };
    let diffracts = |study: &Study| study.keep.response.as_ref().unwrap().0.diffraction;
    let (plain, off, on) = (
        with(""),
        with("diffraction: false"),
        with("diffraction: true"),
    );
    assert_eq!([&plain, &off, &on].map(diffracts), [false, false, true]);
    assert_eq!(plain.hash(), off.hash());
    assert_ne!(plain.hash(), on.hash());
}

/// Protects against joining shards that do not belong together: the hash changes with everything that determines the
/// results, and with nothing else.
#[test]
fn the_hash_is_of_what_decides_the_results() {
    let hash = |text: &str| read(text).unwrap().hash().to_owned();
    let small = hash(SMALL);
    assert_eq!(small.len(), 64);
    let same = SMALL
        .replace("\n    ", " ")
        .replace("seeds:", "/* so many */ seeds:");
    assert_eq!(hash(&same), small);
    for (from, to) in [
        ("count: 5", "count: 6"),
        ("shoebox", "obstacles"),
        ("(2, 0, 7)", "(2, 0, 8)"),
        ("counts: false", "counts: true"),
        ("\"small\"", "\"other\""),
    ] {
        assert_ne!(hash(&SMALL.replace(from, to)), small, "{to}");
    }
    // The hash covers the text of a scene file, independent of its folder, and the text of its base scene.
    let text = SMALL.replace("corner", "mine.ron");
    let mine = |base: &str| {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let surfaces = "[Surface(shape: Room(size: (9, 9, 20)), material: \"brick\")]";
        let ends = "source: Source(position: (0, 0, 0)), listener: Listener(position: (1, 0, 0), radius: 1)";
        write(
            "base.ron",
            &format!("Scene(surfaces: {surfaces}, {ends}) // {base}"),
        );
        write(
            "mine.ron",
            "Scene(base: \"base.ron\", listener: Listener(position: (2, 0, 0), radius: 1))",
        );
        read_in(&text, folder.path()).unwrap().hash().to_owned()
    };
    assert_eq!(mine("a"), mine("a"));
    assert_ne!(mine("a"), mine("b"));
}

/// Protects the tables: any number of shards gives the same bytes, in any order of their files.
#[test]
fn any_number_of_shards_joins_to_the_same_bytes() {
    let study = read(SMALL).unwrap();
    let whole = joined(&study, shards(&study, 1).path()).unwrap();
    for of in [2, 3, 4, 9] {
        let folder = shards(&study, of);
        assert_eq!(joined(&study, folder.path()).unwrap(), whole, "{of}");
    }
    let csv = std::str::from_utf8(&whole[0]).unwrap();
    let mut lines = csv.lines();
    let names = "point,scene,profile,directions,waves,iterations,source_x_m,source_y_m,source_z_m,\
                 listener_x_m,listener_y_m,listener_z_m,seed,left,right,pan";
    assert_eq!(lines.next(), Some(names));
    assert_eq!(
        lines.nth(37),
        Some(
            "37,shoebox,hybrid,random,65536,8,-3.5,0.5,-5.0,1.0,0.0,5.0,6,12.333333333333334,0.5,-0.25"
        )
    );
    assert_eq!(csv.lines().count(), 61);
}

/// A change to a folder of shards, with the expected error.
type Change<'a> = (&'a dyn Fn(&Path), &'a [&'a str]);

/// Returns the error of joining four shards after a change to their folder.
fn refused(study: &Study, change: &dyn Fn(&Path)) -> String {
    let folder = shards(study, 4);
    change(folder.path());
    let said = joined(study, folder.path()).expect_err("it was joined");
    assert!(!folder.path().join("study.csv").exists());
    said
}

/// Protects against incomplete results: the error lists every shard that is missing, duplicated, or not of this study.
#[test]
fn shards_that_do_not_belong_are_named() {
    let study = read(SMALL).unwrap();
    let second = |folder: &Path| Shard::new(2, 4).unwrap().file(folder);
    let rewrite = |folder: &Path, from: &str, to: &str| {
        let shard = Shard::new(2, 4).unwrap();
        let header = Header::new(&study, shard, RENDERER)
            .text()
            .replace(from, to);
        let header = Header::parse(&header).unwrap();
        std::fs::write(second(folder), made_up(&header, row)).unwrap();
    };
    let cases: [Change; 7] = [
        (
            &|folder| std::fs::remove_file(second(folder)).unwrap(),
            &["1 of 4 shards are missing: 2"],
        ),
        (
            &|folder| {
                let copy = folder_of(folder).join("copy.shard");
                std::fs::copy(second(folder), copy).unwrap();
            },
            &["copy.shard: shard 2/4 exists twice", "00002-of-00004.shard"],
        ),
        (
            &|folder| rewrite(folder, study.hash(), "0123"),
            &["00002-of-00004.shard: it is of study \"0123\""],
        ),
        (
            &|folder| rewrite(folder, "\"version\":\"0.", "\"version\":\"9."),
            &["it is of version \"9."],
        ),
        (
            &|folder| rewrite(folder, RENDERER, "another"),
            &["it is of renderer \"another\", not \"made up; 1.0\""],
        ),
        (
            &|folder| {
                let header = Header::new(&study, Shard::new(2, 3).unwrap(), RENDERER);
                std::fs::write(second(folder), made_up(&header, row)).unwrap();
            },
            &[
                "it is shard 2 of 3, not of 4",
                "missing: 2",
                "cut into 3 and into 4 shards: remove",
            ],
        ),
        (
            &|folder| {
                let text = std::fs::read(second(folder)).unwrap();
                std::fs::write(second(folder), &text[..text.len() / 2]).unwrap();
            },
            &["00002-of-00004.shard: it is cut off"],
        ),
    ];
    for (change, told) in cases {
        let said = refused(&study, change);
        for told in told {
            assert!(said.contains(told), "{told}: {said}");
        }
    }
}

/// Protects results from damage: every changed or missing byte of a shard is detected.
#[test]
fn no_byte_of_a_shard_can_change() {
    let study = read(SMALL).unwrap();
    let folder = shards(&study, 4);
    let path = Shard::new(4, 4).unwrap().file(folder.path());
    let whole = std::fs::read(&path).unwrap();
    let is_taken = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        super::read_shard::verify(&path, &study, &mut |_| ()).is_ok()
    };
    assert!(is_taken(&whole));
    for at in 0..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        assert!(!is_taken(&changed), "byte {at} was changed");
        assert!(!is_taken(&whole[..at]), "cut off at byte {at}");
    }
    assert!(!is_taken(&[&whole[..], b"\n"].concat()));
}

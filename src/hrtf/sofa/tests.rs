//! Tests with valid and with rejected SOFA files.

use super::*;
use crate::hrtf::{Hrir, HrirError};
use crate::test_common::sofa::{SofaFile, Variable};
use glam::DVec3;

fn read(file: &SofaFile) -> Result<HrirSet, SofaProblem> {
    from_bytes(file.bytes())
}

/// The error message for a file.
fn refused(file: &SofaFile) -> String {
    read(file).expect_err("a bad file").to_string()
}

/// The largest sample, and its time in samples at 48 kHz.
fn peak(hrir: &Hrir) -> (f32, f64) {
    let by_size = |a: &(usize, &f32), b: &(usize, &f32)| a.1.total_cmp(b.1);
    let (index, sample) = hrir
        .samples
        .iter()
        .enumerate()
        .max_by(by_size)
        .expect("samples");
    (*sample, index as f64 + hrir.delay_s * 48_000.0)
}

/// Protects directions, ears, levels and differences of delays: sound from the left arrives 24 samples earlier at the
/// left ear.
#[test]
fn measured_directions_have_their_responses() {
    let set = read(&SofaFile::simple()).expect("a good file");
    assert_eq!((set.rate_hz(), set.directions().len()), (48_000, 26));
    for (from, left, right) in [
        (DVec3::X, 24.0, 24.0),
        (DVec3::Y, 12.0, 36.0),
        (DVec3::NEG_Y, 36.0, 12.0),
        (DVec3::Z, 24.0, 24.0),
        (DVec3::new(0.0, 1.0, 1.0), 16.0, 32.0),
    ] {
        for (hrir, place) in set.pair(from).iter().zip([left, right]) {
            let (level, at) = peak(hrir);
            // The mean delay over all directions is 24 samples, and `at` is relative to this mean.
            assert!((at - (place - 24.0)).abs() < 0.3, "{from}: {at} {place}");
            // A position is rounded to whole samples, but its level is not.
            assert!((f64::from(level) - (1.0 - place / 64.0)).abs() < 0.5 / 64.0);
        }
    }
}

/// Protects Data.Delay in samples, with one row for all measurements and with one row for each.
#[test]
fn delays_move_the_responses() {
    let itd = |file: SofaFile| {
        let [left, right] = read(&file).expect("a good file").pair(DVec3::X);
        peak(&right).1 - peak(&left).1
    };
    let file = SofaFile::simple();
    assert!(itd(file.clone()).abs() < 1e-6);
    let one = Variable::new(&[1.0, 4.5], &[1, 2]);
    assert!((itd(file.clone().with("Data.Delay", one)) - 3.5).abs() < 1e-6);
    let each: Vec<f64> = (0..26).flat_map(|_| [7.0, 2.0]).collect();
    let each = Variable::new(&each, &[26, 2]);
    assert!((itd(file.clone().with("Data.Delay", each)) + 5.0).abs() < 1e-6);
    assert!(itd(file.without("Data.Delay")).abs() < 1e-6);
}

/// Protects cartesian positions, listeners that are turned or moved, and receivers in reverse order.
#[test]
fn geometry_is_that_of_the_file() {
    let file = SofaFile::simple();
    let louder_left = |file: &SofaFile, from: DVec3| {
        let [left, right] = read(file).expect("a good file").pair(from);
        peak(&left).0 > peak(&right).0 + 0.2
    };
    assert!(louder_left(&file, DVec3::Y));
    let vector = |numbers: [f64; 3]| Variable::new(&numbers, &[1, 3]).with("Type", "cartesian");
    // The listener looks to its former left: the former front is to its right.
    let turned = file.clone().with("ListenerView", vector([0.0, 1.0, 0.0]));
    assert!(louder_left(&turned, DVec3::X));
    let spherical = Variable::new(&[90.0, 0.0, 1.0], &[1, 3]).with("Type", "spherical");
    let turned = file.clone().with("ListenerView", spherical);
    assert!(louder_left(&turned, DVec3::X));
    // Upside down, left becomes right.
    let hanging = file.clone().with("ListenerUp", vector([0.0, 0.0, -1.0]));
    assert!(louder_left(&hanging, DVec3::NEG_Y));
    let receivers = [0.0, -0.09, 0.0, 0.0, 0.09, 0.0];
    let swapped = file
        .clone()
        .with("ReceiverPosition", Variable::new(&receivers, &[2, 3]));
    assert!(louder_left(&swapped, DVec3::NEG_Y));
    let mut moved = file.clone();
    let cartesian: Vec<f64> = read(&file)
        .expect("a good file")
        .directions()
        .iter()
        .flat_map(|direction| (*direction * 2.0 + DVec3::new(5.0, 6.0, 7.0)).to_array())
        .collect();
    moved = moved
        .with("ListenerPosition", vector([5.0, 6.0, 7.0]))
        .with(
            "SourcePosition",
            Variable::new(&cartesian, &[26, 3])
                .with("Type", "cartesian")
                .with("Units", "metre"),
        );
    assert!(louder_left(&moved, DVec3::Y));
}

/// Protects files with several distances: the farthest is used.
#[test]
fn the_farthest_distance_counts() {
    let click = |level: f64| vec![0.0, level, 0.0, 0.0];
    let measured: Vec<_> = [0.3, 0.9, 0.6]
        .into_iter()
        .map(|level| ([30.0, 10.0], [click(level), click(level)]))
        .collect();
    let positions = [30.0, 10.0, 0.5, 30.0, 10.0, 3.0, 30.0, 10.0, 1.0];
    let positions = Variable::new(&positions, &[3, 3]).with("Type", "spherical");
    let set = read(&SofaFile::new(48_000.0, &measured).with("SourcePosition", positions));
    let set = set.expect("a good file");
    assert_eq!(set.directions().len(), 1);
    assert!((peak(&set.pair(DVec3::X)[0]).0 - 0.9).abs() < 1e-3);
}

/// Protects from files of another convention and from invalid numbers: each is rejected with a message that states the
/// problem.
#[test]
fn what_is_wrong_is_told() {
    let file = SofaFile::simple();
    let global = |name, value| {
        let mut file = file.clone();
        file.globals.insert(name, value);
        refused(&file)
    };
    let other = global("SOFAConventions", "SimpleFreeFieldSOS");
    assert_eq!(
        other,
        "its SOFAConventions is \"SimpleFreeFieldSOS\", but only \"SimpleFreeFieldHRIR\" is supported"
    );
    assert!(global("DataType", "TF").contains("DataType is \"TF\""));
    let mut bare = file.clone();
    bare.globals.clear();
    assert!(refused(&bare).contains("its Conventions is missing"));
    for name in ["Data.IR", "Data.SamplingRate", "SourcePosition"] {
        let said = refused(&file.clone().without(name));
        assert_eq!(said, format!("it has no variable {name}"));
    }
    let with = |name, numbers: &[f64], shape: &[u64]| {
        refused(&file.clone().with(name, Variable::new(numbers, shape)))
    };
    let said = with("Data.IR", &[0.0; 26 * 3 * 4], &[26, 3, 4]);
    assert!(said.contains("Data.IR has the shape 26 × 3 × 4"), "{said}");
    assert_eq!(
        with("Data.IR", &[0.0; 208], &[26, 2, 4]),
        "all samples are 0"
    );
    let said = with("Data.IR", &[f64::NAN; 208], &[26, 2, 4]);
    assert!(said.contains("has the sample NaN"), "{said}");
    assert!(with("Data.SamplingRate", &[0.0], &[1]).contains("at 0 Hz"));
    assert!(with("Data.SamplingRate", &[44_100.5], &[1]).contains("not a whole number"));
    assert!(with("Data.SamplingRate", &[f64::NAN], &[1]).contains("not a whole number"));
    let said = with("SourcePosition", &[f64::NAN; 78], &[26, 3]);
    assert!(said.contains("has no valid direction"), "{said}");
    assert!(with("SourcePosition", &[1.0; 75], &[25, 3]).contains("25 × 3"));
    assert!(with("ListenerView", &[0.0, 0.0, 2.0], &[1, 3]).contains("does not define axes"));
    assert!(with("Data.Delay", &[1e9, 0.0], &[1, 2]).contains("has a delay of"));
    let unit = Variable::new(&[48.0], &[1]).with("Units", "kilohertz");
    let said = refused(&file.clone().with("Data.SamplingRate", unit));
    assert!(said.contains("its unit is \"kilohertz\""), "{said}");
}

/// A file of `tests/sofa`, written by the HDF5 library itself (see `make.py` there).
macro_rules! written_by_hdf5 {
    ($name:literal) => {
        (
            $name,
            include_bytes!(concat!("../../../tests/sofa/", $name, ".sofa")).to_vec(),
        )
    };
}

/// Protects files of every HDF5 version, contiguous and chunked, compressed and with checksums: all give the same
/// responses. Unsupported storage is reported as unsupported, not as damage.
#[test]
fn files_of_other_hdf5_versions_are_read_or_named() {
    for (name, bytes) in [
        written_by_hdf5!("earliest-gzip"),
        written_by_hdf5!("v110-chunked"),
        written_by_hdf5!("v112-gzip"),
        written_by_hdf5!("v112-endless"),
        written_by_hdf5!("latest-whole"),
        written_by_hdf5!("latest-chunked"),
    ] {
        let set = from_bytes(bytes).expect(name);
        assert_eq!(
            (set.rate_hz(), set.directions().len()),
            (48_000, 3),
            "{name}"
        );
        for (from, level) in [(DVec3::X, 0.25), (DVec3::Y, 0.5), (DVec3::Z, 0.75)] {
            let [left, right] = set.pair(from).map(|hrir| peak(&hrir));
            assert!(
                (left.0 - level).abs() < 1e-3 && (right.0 - level).abs() < 1e-3,
                "{name}"
            );
            assert!((right.1 - left.1 - 1.0).abs() < 0.01, "{name}");
        }
    }
    for (name, bytes) in [
        written_by_hdf5!("latest-gzip"),
        written_by_hdf5!("v112-endless-twice"),
    ] {
        let said = from_bytes(bytes).expect_err(name).to_string();
        let told = "Data.IR is stored in a form of HDF5 that is not supported (";
        assert!(
            said.starts_with(told) && said.ends_with("h5repack"),
            "{said}"
        );
    }
}

/// Protects memory and the program from files that are not SOFA, are truncated, or declare huge sizes.
#[test]
fn damaged_and_huge_files_are_refused() {
    let bytes = SofaFile::simple().bytes();
    for end in (0..bytes.len()).step_by(bytes.len() / 40) {
        let refused = from_bytes(bytes[..end].to_vec());
        assert!(refused.is_err(), "{end} of {}", bytes.len());
    }
    let told = |bytes: &[u8]| from_bytes(bytes.to_vec()).expect_err("no SOFA file");
    assert!(matches!(told(b"RIFF nothing"), SofaProblem::NotHdf5 { .. }));
    assert!(matches!(told(b""), SofaProblem::NotHdf5 { .. }));
    // An HDF5 file declares its sizes before its numbers: these few bytes declare 16 TiB of zeros.
    let mut huge = hdf5_pure::FileBuilder::new();
    for (name, value) in &SofaFile::simple().globals {
        huge.set_attr(name, hdf5_pure::AttrValue::AsciiString((*value).into()));
    }
    huge.create_dataset("Data.IR")
        .with_f64_data(&[0.0; 2])
        .with_shape(&[1, 2, 1])
        .with_chunks(&[1, 2, 1]);
    let mut bytes = huge.finish().expect("a good file");
    let one = [1_u64, 2, 1].map(u64::to_le_bytes).concat();
    let at = bytes.windows(24).position(|window| window == one);
    let at = at.expect("the shape");
    bytes[at..at + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
    let said = told(&bytes);
    assert!(
        matches!(
            said,
            SofaProblem::Set {
                source: HrirError::BadCount { .. }
            } | SofaProblem::Damaged { .. }
        ),
        "{said}"
    );
}

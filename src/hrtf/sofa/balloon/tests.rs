//! Tests of directivities from valid and from rejected SOFA files.

use super::*;
use crate::test_common::sofa::{SofaFile, Variable};

/// Third-octave frequencies in hertz, from 100 Hz to 10 kHz.
fn frequencies() -> Vec<f64> {
    (20..=40)
        .map(|third| 10_f64.powf(f64::from(third) / 10.0))
        .collect()
}

/// Amplitude of a source that is omnidirectional at low frequencies, and a cardioid from 1 kHz on.
fn amplitude(cosine: f64, hertz: f64) -> f64 {
    let share = 1.0 - 0.5 * (hertz / 900.0).min(1.0);
    3.0 * (share + (1.0 - share) * cosine)
}

/// A source measured every 10°, with both poles.
fn horn() -> SofaFile {
    let mut measured = Vec::new();
    for elevation in (-90..=90).step_by(10) {
        for azimuth in (0..360).step_by(10) {
            let angles = [f64::from(azimuth), f64::from(elevation)];
            let [left, up] = angles.map(f64::to_radians);
            let cosine = left.cos() * up.cos();
            let of = |hertz: &f64| amplitude(cosine, *hertz);
            measured.push((angles, frequencies().iter().map(of).collect()));
        }
    }
    SofaFile::directivity(&frequencies(), &measured)
}

fn read(file: &SofaFile) -> Result<Balloon, SofaProblem> {
    from_bytes("horn.sofa", file.bytes())
}

fn refused(file: &SofaFile) -> String {
    read(file).expect_err("a bad file").to_string()
}

/// Ratio of the energies of a band to two directions, in decibels.
fn ratio_db(balloon: &Balloon, band: usize, [one, other]: [DVec3; 2]) -> f64 {
    let [one, other] = [one, other].map(|direction| balloon.factor(direction)[band]);
    10.0 * (one / other).log10()
}

/// Protects levels by direction and octave: the mean energy of the frequencies in an octave, with the nearest octave
/// below the lowest frequency.
#[test]
fn an_octave_has_the_mean_of_its_energies() {
    let balloon = read(&horn()).expect("a good file");
    assert_eq!(
        (balloon.name(), balloon.directions().len()),
        ("horn.sofa", 17 * 36 + 2)
    );
    // The octaves of 125 Hz to 8 kHz have three frequencies each, that of 63 Hz has none.
    let mean = |band: usize, cosine: f64| {
        let thirds = frequencies().into_iter().skip(3 * band.max(1) - 3).take(3);
        thirds
            .map(|hertz| amplitude(cosine, hertz).powi(2))
            .sum::<f64>()
            / 3.0
    };
    for band in 0..BAND_COUNT {
        for degrees in [30_f64, 90.0, 120.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            for aside in [DVec3::Y, DVec3::Z, -DVec3::Y] {
                let found = ratio_db(&balloon, band, [cos * DVec3::X + sin * aside, DVec3::X]);
                let expected = 10.0 * (mean(band, cos) / mean(band, 1.0)).log10();
                assert!(
                    (found - expected).abs() < 0.01,
                    "{band}, {degrees}: {found} dB"
                );
            }
        }
    }
}

/// Protects the geometry: receivers are relative to a listener that is moved and turned, and directions are relative to
/// a source that is moved and turned.
#[test]
fn directions_are_those_from_the_source() {
    let vector = |numbers: [f64; 3]| Variable::new(&numbers, &[1, 3]).with("Type", "cartesian");
    let front = |file: &SofaFile, direction: DVec3| {
        let balloon = read(file).expect("a good file");
        ratio_db(&balloon, 4, [direction, -direction]) > 20.0
    };
    assert!(front(&horn(), DVec3::X));
    let turned = horn().with("SourceView", vector([0.0, 1.0, 0.0]));
    assert!(front(&turned, DVec3::NEG_Y));
    let rolled = turned.with("SourceUp", vector([-1.0, 0.0, 0.0]));
    assert!(front(&rolled, DVec3::NEG_Z));
    let array = horn().with("ListenerView", vector([0.0, -1.0, 0.0]));
    assert!(front(&array, DVec3::NEG_Y));
    let moved = horn()
        .with("SourcePosition", vector([5.0, -6.0, 7.0]))
        .with("ListenerPosition", vector([5.0, -6.0, 7.0]));
    assert!(front(&moved, DVec3::X));
}

/// Protects arrays that are moved between measurements, and several measurements of the same directions: the mean
/// energy counts.
#[test]
fn measurements_may_have_their_own_positions() {
    let positions = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]].concat();
    let file = |amplitudes: &[f64], positions: &[f64], shape: &[u64]| {
        let count = amplitudes.len() as u64;
        SofaFile::directivity(&[1000.0], &[([0.0; 2], vec![1.0])])
            .with("Data.Real", Variable::new(amplitudes, &[count, 1, 1]))
            .with("Data.Imag", Variable::new(amplitudes, &[count, 1, 1]))
            .with(
                "ReceiverPosition",
                Variable::new(positions, shape).with("Type", "cartesian"),
            )
    };
    // The array has one receiver, which is turned about the source between two measurements.
    let by_measurement: Vec<f64> = (0..3)
        .flat_map(|axis| [positions[axis], positions[3 + axis]])
        .collect();
    let turned = read(&file(&[1.0, 2.0], &by_measurement, &[1, 3, 2])).expect("a good file");
    assert_eq!(turned.directions(), [DVec3::X, DVec3::NEG_X]);
    let ratio = ratio_db(&turned, 4, [DVec3::NEG_X, DVec3::X]);
    assert!((ratio - 20.0 * 2_f64.log10()).abs() < 1e-6, "{ratio}");
    let notes = read(&file(&[1.0, 2.0], &positions[..3], &[1, 3])).expect("a good file");
    assert_eq!(notes.directions(), [DVec3::X]);
}

/// Protects the second convention: the mean energy of both ears, by the frequencies of their responses. The test file
/// is louder on the near side of each ear, so its mean is the same on both sides.
#[test]
fn responses_of_a_head_are_a_directivity() {
    let balloon = read(&SofaFile::simple()).expect("a good file");
    assert_eq!(balloon.directions().len(), 26);
    let energy = |left: f64| {
        let level = |place: f64| (1.0 - place.round() / 64.0).powi(2);
        level(24.0 - 12.0 * left) + level(24.0 + 12.0 * left)
    };
    let expected = 10.0 * (energy(1.0) / energy(0.0)).log10();
    for band in 0..BAND_COUNT {
        assert!(ratio_db(&balloon, band, [DVec3::Y, DVec3::NEG_Y]).abs() < 1e-9);
        // The levels of the test file are rounded to whole samples.
        let found = ratio_db(&balloon, band, [DVec3::Y, DVec3::X]);
        assert!(
            (found - expected).abs() < 0.2,
            "{band}: {found} dB, {expected} dB"
        );
    }
}

/// Protects the program from files that are not directivities, of wrong shapes, units and sizes, and with bad numbers.
/// Each error names the variable and the problem.
#[test]
fn bad_files_are_refused() {
    let vector = |numbers: [f64; 3]| Variable::new(&numbers, &[1, 3]).with("Type", "cartesian");
    let mut other = horn();
    other.globals.insert("SOFAConventions", "SingleRoomSRIR");
    assert_eq!(
        refused(&other),
        "its SOFAConventions is \"SingleRoomSRIR\", but only \"FreeFieldDirectivityTF or SimpleFreeFieldHRIR\" is \
         supported"
    );
    let few = |frequencies: &[f64], real: f64| {
        let all: Vec<f64> = frequencies.iter().map(|_| real).collect();
        SofaFile::directivity(frequencies, &[([0.0; 2], all.clone()), ([90.0, 0.0], all)])
    };
    assert!(read(&few(&[500.0], 1.0)).is_ok());
    let cases = [
        (horn().without("Data.Imag"), "it has no variable Data.Imag"),
        (horn().without("N"), "it has no variable N"),
        (
            horn().with("N", Variable::new(&[1.0], &[1])),
            "N has the shape 1, not one number for each frequency",
        ),
        (
            few(&[500.0], 1.0).with("N", Variable::new(&[0.5], &[1]).with("Units", "kilohertz")),
            "N cannot be used: its unit is \"kilohertz\", not \"hertz\"",
        ),
        (
            few(&[20.0, 20_000.0], 1.0),
            "N cannot be used: no frequency is in the octave bands of 63 Hz to 8 kHz",
        ),
        (
            few(&[f64::NAN], 1.0),
            "N cannot be used: no frequency is in the octave bands of 63 Hz to 8 kHz",
        ),
        (
            horn().with("Data.Real", Variable::new(&[1.0], &[1])),
            "Data.Real has the shape 1, not measurements × receivers × frequencies",
        ),
        (
            horn().with("Data.Imag", Variable::new(&[1.0], &[1, 1, 1])),
            "Data.Imag has the shape 1 × 1 × 1, not that of Data.Real",
        ),
        (
            horn().with("ReceiverPosition", Variable::new(&[1.0; 6], &[2, 3])),
            "ReceiverPosition has the shape 2 × 3, not receivers × 3, for one or all measurements",
        ),
        (
            horn().with("SourceView", vector([0.0, 0.0, 2.0])),
            "SourceView cannot be used: with the vector up it does not define axes",
        ),
        (
            horn().with("SourcePosition", vector([f64::NAN, 0.0, 0.0])),
            "measurement 0 has the direction",
        ),
        (
            few(&[500.0], f64::NAN),
            "measurement 0 has the energy NaN at 63 Hz",
        ),
        (
            few(&[500.0], 0.0),
            "the energy at 63 Hz is 0 in all directions",
        ),
    ];
    for (file, told) in cases {
        let said = refused(&file);
        assert!(said.starts_with(told), "{said}");
    }
}

/// Protects memory: files with too many directions or frequencies are rejected.
#[test]
fn large_files_are_refused_before_they_are_read() {
    let shaped = |shape: [u64; 3]| {
        let numbers = vec![0.0; shape.iter().product::<u64>() as usize];
        let data = Variable::new(&numbers, &shape);
        horn()
            .with("Data.Real", data.clone())
            .with("Data.Imag", data)
    };
    let many = read(&shaped([2, 40_000, 1])).expect_err("too many directions");
    let expected = BalloonError::BadCount { count: 80_000 };
    assert!(matches!(many, SofaProblem::Balloon { source } if source == expected));
    let said = refused(&shaped([1, 1, 70_000]));
    assert_eq!(
        said,
        "Data.Real cannot be used: it has 70000 frequencies: there must be 1 to 65536"
    );
    let none = refused(&shaped([0, 5, 5]));
    assert!(none.starts_with("0 measured directions"), "{none}");
}

/// Protects from damage: a file that is cut off anywhere, or has a changed byte, gives a directivity or an error.
#[test]
fn damaged_files_do_not_stop_the_program() {
    let angles = |azimuth: u32| ([f64::from(90 * azimuth), 0.0], vec![1.0, 2.0]);
    let measured: Vec<_> = (0..4).map(angles).collect();
    let bytes = SofaFile::directivity(&[500.0, 1000.0], &measured).bytes();
    assert!(from_bytes("good", bytes.clone()).is_ok());
    for at in (0..bytes.len()).step_by(61) {
        assert!(from_bytes("cut off", bytes[..at].to_vec()).is_err(), "{at}");
        let mut changed = bytes.clone();
        changed[at] ^= 0xff;
        // Some bytes are unused, and some are data.
        let _ = from_bytes("changed", changed);
    }
}

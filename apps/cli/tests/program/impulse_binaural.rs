//! `echomarch impulse --format binaural` on the command line.

use crate::common::cli::{argument, refuse, succeed};
use crate::common::sofa::{SofaFile, Variable};
use std::path::Path;

/// A source to the left of a listener in a strongly absorbing room: only the direct sound, and echoes 20 dB below it.
const SCENE: &str = r#"Scene(
    surfaces: [Surface(shape: Room(size: (12, 5, 9)), material: "wall")],
    materials: {"wall": Material(absorption: 0.9)},
    source: Source(position: (-3, 0, 0)),
    listener: Listener(position: (0, 0, 0), radius: 0.3),
)"#;

fn write(folder: &Path, name: &str, bytes: &[u8]) -> String {
    let file = folder.join(name);
    std::fs::write(&file, bytes).unwrap();
    argument(&file).to_owned()
}

/// Protects the WAV file: it has two channels at the requested rate. For a source at the left, the sound at the left
/// ear is earlier and louder, as the SOFA file specifies. A second run gives the same result.
#[test]
fn the_near_ear_hears_first_and_more() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(folder.path(), "room.ron", SCENE.as_bytes());
    let sofa = write(folder.path(), "head.sofa", &SofaFile::simple().bytes());
    let wav = folder.path().join("ir.wav");
    let made = |rate: &str| {
        let call = ["impulse", &scene, "-o", argument(&wav), "--rate", rate];
        let how = ["--format", "binaural", "--sofa", &sofa];
        let few = ["--waves", "4096", "--seconds", "0.1"];
        succeed(&[&call[..], &how, &few].concat());
        let mut reader = hound::WavReader::open(&wav).unwrap();
        assert_eq!(reader.spec().channels, 2);
        assert_eq!(reader.spec().sample_rate.to_string(), rate);
        reader
            .samples::<f32>()
            .map(Result::unwrap)
            .collect::<Vec<f32>>()
    };
    for rate in ["48000", "44100"] {
        let samples = made(rate);
        let hertz: f64 = rate.parse().unwrap();
        let ears = [0, 1].map(|ear| {
            let channel: Vec<f32> = samples.iter().skip(ear).step_by(2).copied().collect();
            let by_size = |a: &usize, b: &usize| channel[*a].total_cmp(&channel[*b]);
            let at = (0..channel.len()).max_by(by_size).unwrap();
            (at as f64 / hertz, f64::from(channel[at]))
        });
        // The distance is 3 m. The impulses of the SOFA file are 12 samples at 48 kHz before and after the mean.
        let expected = |late: f64| 3.0 / 343.0 + late / 48e3;
        assert!((ears[0].0 - expected(-12.0)).abs() < 30e-6, "{ears:?}");
        assert!((ears[1].0 - expected(12.0)).abs() < 30e-6, "{ears:?}");
        // The levels are 1 − 12/64 and 1 − 36/64. A peak between two samples is slightly lower.
        assert!((ears[0].1 * 3.0 / 0.8125 - 1.0).abs() < 0.2, "{ears:?}");
        assert!((ears[1].1 * 3.0 / 0.4375 - 1.0).abs() < 0.2, "{ears:?}");
    }
    assert!(made("48000") == made("48000"));
}

/// Protects users who mistype arguments or give a file that is not a SOFA file: the program exits with code 2, prints
/// one sentence, and writes no WAV file.
#[test]
fn bad_sofa_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let wav = folder.path().join("ir.wav");
    let call = |more: &[&str], told: &str| {
        let begin = ["impulse", "shoebox", "-o", argument(&wav)];
        refuse(&[&begin[..], more].concat(), told);
    };
    call(&["--format", "binaural"], "--format binaural needs --sofa");
    let with = |name: &str, bytes: &[u8], told: &str| {
        let file = write(folder.path(), name, bytes);
        call(&["--format", "binaural", "--sofa", &file], told);
    };
    let good = SofaFile::simple();
    let file = write(folder.path(), "good.sofa", &good.bytes());
    call(
        &["--sofa", &file],
        "--sofa has no effect on impulse: it is for --format binaural",
    );
    call(
        &["--format", "binaural", "--sofa", "nowhere.sofa"],
        "the SOFA file nowhere.sofa: No such file",
    );
    with("text.sofa", b"not HDF5 at all", "it is not a SOFA file");
    let bytes = good.bytes();
    with("half.sofa", &bytes[..bytes.len() / 2], "half.sofa: ");
    let mut other = good.clone();
    other.globals.insert("SOFAConventions", "GeneralFIR");
    with(
        "other.sofa",
        &other.bytes(),
        "its SOFAConventions is \"GeneralFIR\"",
    );
    let slow = good.with("Data.SamplingRate", Variable::new(&[100.0], &[1]));
    with("slow.sofa", &slow.bytes(), "at 100 Hz");
    let huge = folder.path().join("huge.sofa");
    let sparse = std::fs::File::create(&huge).unwrap();
    sparse.set_len(1 << 40).unwrap();
    call(
        &["--format", "binaural", "--sofa", argument(&huge)],
        "it is larger than",
    );
    assert!(!wav.exists());
}

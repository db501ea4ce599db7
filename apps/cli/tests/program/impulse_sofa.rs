//! `echomarch impulse -o FILE.sofa` on the command line.

use crate::common::cli::{argument, refuse, succeed};
use hdf5_pure::File;

/// A source and two listeners in a small room.
const SCENE: &str = r#"Scene(
    surfaces: [Surface(shape: Room(size: (5, 3, 4)), material: "wall")],
    materials: {"wall": Material(absorption: 0.6)},
    source: Source(position: (-1, 0, 0)),
    listeners: [
        Listener(name: "front", position: (0, 0, -1), radius: 0.3),
        Listener(name: "back", position: (1, 0, 1), radius: 0.3),
    ],
)"#;

/// Protects users who read all pairs from one file: each measurement has the samples of the pair's WAV file.
#[test]
fn a_sofa_file_has_the_samples_of_all_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("room.ron"), SCENE).unwrap();
    for output in ["ir.sofa", "ir.wav"] {
        let (scene, output) = (path("room.ron"), path(output));
        let call = ["impulse", argument(&scene), "-o", argument(&output)];
        let how = ["--format", "ambisonic", "--rate", "44100"];
        let few = ["--waves", "4096", "--seconds", "0.1"];
        succeed(&[&call[..], &how, &few].concat());
    }
    let file = File::open(path("ir.sofa")).unwrap();
    let responses = file.dataset("Data.IR").unwrap();
    assert_eq!(responses.shape().unwrap(), [2, 4, 4410]);
    let samples = responses.read_f64().unwrap();
    for (pair, listener) in ["front", "back"].into_iter().enumerate() {
        let mut wav = hound::WavReader::open(path(&format!("ir-1-{listener}.wav"))).unwrap();
        let interleaved: Vec<f32> = wav.samples::<f32>().map(Result::unwrap).collect();
        for channel in 0..4 {
            let own = interleaved.iter().skip(channel).step_by(4).copied();
            let own: Vec<f64> = own.map(f64::from).collect();
            let start = (pair * 4 + channel) * 4410;
            assert_eq!(samples[start..start + 4410], own, "{listener} {channel}");
        }
    }
}

/// Protects users who mistype the name or ask for too much: both are refused before anything is traced.
#[test]
fn a_file_with_another_ending_is_refused() {
    let told = "must end in .wav or .sofa";
    refuse(&["impulse", "shoebox", "-o", "ir.netcdf"], told);
    let long = ["--seconds", "60", "--rate", "192000"];
    let wide = ["--format", "ambisonic", "--ambisonic-order", "7"];
    let call = ["impulse", "shoebox", "-o", "ir.sofa"];
    refuse(&[&call[..], &long, &wide].concat(), "have 737280000");
}

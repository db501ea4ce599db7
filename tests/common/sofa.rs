//! SOFA files for tests, written with the library that reads them.

use hdf5_pure::{AttrValue, FileBuilder};
use std::collections::BTreeMap;

/// A variable with its values, shape and attributes.
#[derive(Clone)]
pub struct Variable {
    pub numbers: Vec<f64>,
    pub shape: Vec<u64>,
    pub attributes: Vec<(&'static str, &'static str)>,
}

impl Variable {
    pub fn new(numbers: &[f64], shape: &[u64]) -> Variable {
        Variable {
            numbers: numbers.to_vec(),
            shape: shape.to_vec(),
            attributes: Vec::new(),
        }
    }

    pub fn with(mut self, attribute: &'static str, value: &'static str) -> Variable {
        self.attributes.push((attribute, value));
        self
    }
}

/// The contents of a SOFA file.
#[derive(Clone)]
pub struct SofaFile {
    pub globals: BTreeMap<&'static str, &'static str>,
    pub variables: BTreeMap<&'static str, Variable>,
}

impl SofaFile {
    /// A file of the convention SimpleFreeFieldHRIR. `measured` contains azimuth and elevation in degrees for each
    /// direction, and the samples of both ears.
    pub fn new(rate_hz: f64, measured: &[([f64; 2], [Vec<f64>; 2])]) -> SofaFile {
        let samples = measured.first().map_or(0, |(_, ears)| ears[0].len());
        let rows = measured.len() as u64;
        let position = |(angles, _): &([f64; 2], [Vec<f64>; 2])| [angles[0], angles[1], 1.5];
        let positions: Vec<f64> = measured.iter().flat_map(position).collect();
        let responses: Vec<f64> = measured
            .iter()
            .flat_map(|(_, ears)| ears.iter().flatten().copied())
            .collect();
        let spherical = Variable::new(&positions, &[rows, 3])
            .with("Type", "spherical")
            .with("Units", "degree, degree, metre");
        let cartesian = |numbers: &[f64], shape: &[u64]| {
            let variable = Variable::new(numbers, shape).with("Type", "cartesian");
            variable.with("Units", "metre")
        };
        let rate = Variable::new(&[rate_hz], &[1]).with("Units", "hertz");
        SofaFile {
            globals: BTreeMap::from([
                ("Conventions", "SOFA"),
                ("Version", "2.1"),
                ("SOFAConventions", "SimpleFreeFieldHRIR"),
                ("SOFAConventionsVersion", "1.0"),
                ("DataType", "FIR"),
            ]),
            variables: BTreeMap::from([
                (
                    "Data.IR",
                    Variable::new(&responses, &[rows, 2, samples as u64]),
                ),
                ("Data.SamplingRate", rate),
                ("Data.Delay", Variable::new(&[0.0, 0.0], &[1, 2])),
                ("SourcePosition", spherical),
                ("ListenerPosition", cartesian(&[0.0; 3], &[1, 3])),
                ("ListenerView", cartesian(&[1.0, 0.0, 0.0], &[1, 3])),
                ("ListenerUp", cartesian(&[0.0, 0.0, 1.0], &[1, 3])),
                (
                    "ReceiverPosition",
                    cartesian(&[0.0, 0.09, 0.0, 0.0, -0.09, 0.0], &[2, 3, 1]),
                ),
            ]),
        }
    }

    /// A file of the convention FreeFieldDirectivityTF with one measurement: receivers 2 m around the source, at
    /// `frequencies` in hertz. `measured` contains azimuth and elevation in degrees for each receiver, and its
    /// amplitude at each frequency. All phases are 0.
    pub fn directivity(frequencies: &[f64], measured: &[([f64; 2], Vec<f64>)]) -> SofaFile {
        let rows = measured.len() as u64;
        let position = |(angles, _): &([f64; 2], Vec<f64>)| [angles[0], angles[1], 2.0];
        let positions: Vec<f64> = measured.iter().flat_map(position).collect();
        let amplitudes: Vec<f64> = measured.iter().flat_map(|(_, all)| all.clone()).collect();
        let shape = [1, rows, frequencies.len() as u64];
        let vector = |numbers: [f64; 3]| {
            let variable = Variable::new(&numbers, &[1, 3]).with("Type", "cartesian");
            variable.with("Units", "metre")
        };
        let receivers = Variable::new(&positions, &[rows, 3, 1])
            .with("Type", "spherical")
            .with("Units", "degree, degree, metre");
        SofaFile {
            globals: BTreeMap::from([
                ("Conventions", "SOFA"),
                ("Version", "2.1"),
                ("SOFAConventions", "FreeFieldDirectivityTF"),
                ("SOFAConventionsVersion", "1.1"),
                ("DataType", "TF"),
            ]),
            variables: BTreeMap::from([
                ("Data.Real", Variable::new(&amplitudes, &shape)),
                (
                    "Data.Imag",
                    Variable::new(&vec![0.0; amplitudes.len()], &shape),
                ),
                (
                    "N",
                    Variable::new(frequencies, &[frequencies.len() as u64]).with("Units", "hertz"),
                ),
                ("ReceiverPosition", receivers),
                ("SourcePosition", vector([0.0; 3])),
                ("SourceView", vector([1.0, 0.0, 0.0])),
                ("SourceUp", vector([0.0, 0.0, 1.0])),
                ("ListenerPosition", vector([0.0; 3])),
                ("ListenerView", vector([1.0, 0.0, 0.0])),
                ("ListenerUp", vector([0.0, 0.0, 1.0])),
            ]),
        }
    }

    /// A head with a response for each of 26 directions. Each response is an impulse in each ear, louder and earlier at
    /// the ear on the side of the source.
    pub fn simple() -> SofaFile {
        let mut measured = vec![([0.0, 90.0], [impulse(24.0), impulse(24.0)])];
        for elevation in [-45.0_f64, 0.0, 45.0] {
            for azimuth in (0..360).step_by(45) {
                let azimuth = f64::from(azimuth);
                let left = azimuth.to_radians().sin() * elevation.to_radians().cos();
                let ears = [impulse(24.0 - 12.0 * left), impulse(24.0 + 12.0 * left)];
                measured.push(([azimuth, elevation], ears));
            }
        }
        measured.push(([0.0, -90.0], [impulse(24.0), impulse(24.0)]));
        SofaFile::new(48_000.0, &measured)
    }

    /// Returns the file with a variable added or replaced.
    pub fn with(mut self, name: &'static str, variable: Variable) -> SofaFile {
        self.variables.insert(name, variable);
        self
    }

    /// Returns the file without a variable.
    pub fn without(mut self, name: &str) -> SofaFile {
        self.variables.remove(name);
        self
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut file = FileBuilder::new();
        for (name, value) in &self.globals {
            file.set_attr(name, AttrValue::AsciiString((*value).into()));
        }
        for (name, variable) in &self.variables {
            let dataset = file.create_dataset(name);
            dataset
                .with_f64_data(&variable.numbers)
                .with_shape(&variable.shape);
            for (attribute, value) in &variable.attributes {
                dataset.set_attr(attribute, AttrValue::AsciiString((*value).into()));
            }
        }
        file.finish().expect("a good file")
    }
}

/// Returns 64 samples with an impulse at sample `place`. An earlier impulse is louder.
fn impulse(place: f64) -> Vec<f64> {
    let mut samples = vec![0.0; 64];
    samples[place.round() as usize] = 1.0 - place / 64.0;
    samples
}

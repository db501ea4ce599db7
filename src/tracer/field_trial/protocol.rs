//! The messages between parent and child. The parent sends one line of RON. The child sends a mark, one line of RON,
//! and the samples in binary form.

use super::super::TraceError;
use crate::scene::WaveDomain;
use serde::{Deserialize, Serialize};

/// The mark before the answer. The mark is needed because drivers may write to standard output too.
const MARK: &[u8] = b"\nechomarch field trial\n";

/// The texts to try.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    pub fields: Vec<RequestedField>,
    /// Fragment shaders that contain the fields.
    pub programs: Vec<String>,
}

#[derive(Debug, Serialize, Deserialize)]
pub struct RequestedField {
    pub file: String,
    pub text: String,
    /// In metres.
    pub size: [f32; 3],
    pub lipschitz: f32,
    pub bend: Option<f32>,
    pub waves: WaveDomain,
}

/// The result of a trial.
#[derive(Debug, Serialize, Deserialize)]
pub enum Answer {
    /// All fields can be used. The results are in the order of the fields.
    Passed(Vec<TriedField>),
    /// A field cannot be used, for this reason.
    Refused(TraceError),
    /// The renderer failed.
    Failed(String),
}

#[derive(Debug, Serialize, Deserialize)]
pub struct TriedField {
    pub evaluation_seconds: f64,
    /// Samples along each side.
    pub side: usize,
    /// Whether the derivative of the text agrees with the values of the text; `None` if not tested.
    pub derivative_agrees: Option<bool>,
}

/// An answer as bytes, followed by the values of all fields' samples.
pub fn written(answer: &Answer, values: &[f32]) -> Result<Vec<u8>, ron::Error> {
    let mut bytes = MARK.to_vec();
    bytes.extend(ron::to_string(answer)?.into_bytes());
    bytes.push(b'\n');
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    Ok(bytes)
}

/// Reads an answer back; `None` if it is incomplete.
pub fn read(bytes: &[u8]) -> Option<(Answer, Vec<f32>)> {
    let at = bytes.windows(MARK.len()).position(|part| part == MARK)?;
    let bytes = &bytes[at + MARK.len()..];
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let answer = ron::de::from_bytes(&bytes[..end]).ok()?;
    let (values, rest) = bytes[end + 1..].as_chunks::<4>();
    let values = values.iter().map(|value| f32::from_le_bytes(*value));
    rest.is_empty().then(|| (answer, values.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a child's answer: it is separated from a driver's output, and an incomplete answer is rejected.
    #[test]
    fn an_answer_is_read_as_it_was_written() {
        let tried = TriedField {
            evaluation_seconds: 2.5e-7,
            side: 65,
            derivative_agrees: Some(true),
        };
        let answer = Answer::Passed(vec![tried]);
        let values = [0.1, -1e-30, f32::MAX];
        let mut bytes = b"MESA: warning\n".to_vec();
        bytes.extend(written(&answer, &values).unwrap());
        let (read_answer, read_values) = read(&bytes).unwrap();
        assert_eq!(format!("{read_answer:?}"), format!("{answer:?}"));
        assert_eq!(read_values, values);
        assert!(read(&bytes[..bytes.len() - 1]).is_none() && read(b"").is_none());
        let error = TraceError::FieldNotFinite {
            file: "a \"b\".glsl".into(),
            place: glam::Vec3::X,
            value: f32::NEG_INFINITY,
        };
        let told = error.to_string();
        let bytes = written(&Answer::Refused(error), &[]).unwrap();
        match read(&bytes) {
            Some((Answer::Refused(error), _)) => assert_eq!(error.to_string(), told),
            other => panic!("{other:?}"),
        }
    }
}

//! Recomputes the checksums of a shard file. Anyone can do so, and correct checksums therefore do not prove correct
//! numbers.

use sha2::{Digest, Sha256};

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Returns the file with correct checksums in all lines. A last line that begins with `end ` is also corrected. Text
/// that is not UTF-8, and bytes after the last line end, stay unchanged.
pub fn with_sums(file: &[u8]) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(file) else {
        return file.to_vec();
    };
    let mut summed = String::new();
    for line in text.split_inclusive('\n') {
        let Some(line) = line.strip_suffix('\n') else {
            summed += line;
            break;
        };
        let said = line.rsplit_once('\t').map_or(line, |(said, _)| said);
        let said = match said.starts_with("end ") {
            true => format!("end {}", hex(&Sha256::digest(summed.as_bytes()))),
            false => said.to_owned(),
        };
        let sum = hex(&Sha256::digest(said.as_bytes())[..4]);
        summed += &format!("{said}\t{sum}\n");
    }
    summed.into_bytes()
}

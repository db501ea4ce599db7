//! Arrays in NumPy files (`.npy`, versions 1 to 3 of the format).
//!
//! The crates that read these files bring a parser generator with a C compiler for their header, a Python literal with
//! three known keys. It takes a few lines to read.

/// The first bytes of each file.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Maximum length of a header in bytes. NumPy itself refuses longer ones by default.
const LONGEST_HEADER: usize = 10_000;

/// An array with three axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array3 {
    /// Number of elements along each axis.
    pub shape: [usize; 3],
    /// The elements. The last axis varies fastest.
    pub values: Vec<f32>,
}

/// Reads an array of 32-bit or 64-bit floats with three axes and at most `limit` elements.
///
/// # Errors
/// The reason why the file cannot be used.
pub(super) fn read(bytes: &[u8], limit: usize) -> Result<Array3, String> {
    let (header, data) = parts(bytes).ok_or("it is not a NumPy file: write it by numpy.save")?;
    let header = Header::parse(header)?;
    let within = |count: &usize| *count <= limit;
    let product = |all: usize, side: &usize| all.checked_mul(*side).filter(within);
    let Some(count) = header.shape.iter().try_fold(1, product) else {
        let [x, y, z] = header.shape;
        return Err(format!(
            "it has {x} × {y} × {z} samples, but at most {limit} are read: use larger cells"
        ));
    };
    let width = header.kind.width();
    let Some(data) = data.get(..count * width) else {
        let found = data.len() / width;
        return Err(format!("it ends after {found} of {count} samples"));
    };
    let values = data
        .chunks_exact(width)
        .map(|bytes| header.kind.number(bytes));
    let values: Vec<f32> = values.collect();
    Ok(Array3 {
        shape: header.shape,
        values: match header.is_fortran {
            true => in_c_order(&values, header.shape),
            false => values,
        },
    })
}

/// The text of the header, and the bytes after it.
fn parts(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (version, rest) = rest.split_first_chunk::<2>()?;
    let (length, rest) = match version[0] {
        1 => {
            let (length, rest) = rest.split_first_chunk::<2>()?;
            (u16::from_le_bytes(*length).into(), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk::<4>()?;
            (usize::try_from(u32::from_le_bytes(*length)).ok()?, rest)
        }
        _ => return None,
    };
    if length > LONGEST_HEADER {
        return None;
    }
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

/// The type of the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    LittleF32,
    BigF32,
    LittleF64,
    BigF64,
}

impl Kind {
    /// Bytes of an element.
    fn width(self) -> usize {
        match self {
            Kind::LittleF32 | Kind::BigF32 => 4,
            Kind::LittleF64 | Kind::BigF64 => 8,
        }
    }

    /// The number of [`Kind::width`] bytes; NaN for any other number of bytes.
    fn number(self, bytes: &[u8]) -> f32 {
        fn of<const N: usize>(bytes: &[u8]) -> [u8; N] {
            bytes.try_into().unwrap_or([0xff; N])
        }
        match self {
            Kind::LittleF32 => f32::from_le_bytes(of(bytes)),
            Kind::BigF32 => f32::from_be_bytes(of(bytes)),
            Kind::LittleF64 => f64::from_le_bytes(of(bytes)) as f32,
            Kind::BigF64 => f64::from_be_bytes(of(bytes)) as f32,
        }
    }
}

/// The header: `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 5), }`.
struct Header {
    kind: Kind,
    is_fortran: bool,
    shape: [usize; 3],
}

impl Header {
    fn parse(text: &str) -> Result<Header, String> {
        let missing = |key: &str| format!("its header has no {key}");
        let kind = match after(text, "'descr'")
            .map(quoted)
            .ok_or_else(|| missing("descr"))?
        {
            Some("<f4") => Kind::LittleF32,
            Some(">f4") => Kind::BigF32,
            Some("<f8") => Kind::LittleF64,
            Some(">f8") => Kind::BigF64,
            _ => {
                let why = "its elements are not floats of 32 or 64 bits: save distances as float32";
                return Err(why.to_owned());
            }
        };
        let order = after(text, "'fortran_order'").ok_or_else(|| missing("fortran_order"))?;
        let shape = after(text, "'shape'").ok_or_else(|| missing("shape"))?;
        let shape = shape
            .strip_prefix('(')
            .and_then(|rest| rest.split_once(')'));
        let (shape, _) = shape.ok_or_else(|| missing("shape"))?;
        let sides = shape
            .split(',')
            .map(str::trim)
            .filter(|side| !side.is_empty());
        let sides: Result<Vec<usize>, _> = sides.map(str::parse).collect();
        let shape = sides.ok().and_then(|sides| sides.try_into().ok());
        Ok(Header {
            kind,
            is_fortran: order.starts_with("True"),
            shape: shape.ok_or("its header must state the sizes of three axes: x, y, z")?,
        })
    }
}

/// The text after a key and its colon.
fn after<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(key)?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// The content of the quotes at the start of the text.
fn quoted(text: &str) -> Option<&str> {
    let rest = text.strip_prefix('\'')?;
    Some(rest.split_once('\'')?.0)
}

/// Reorders elements whose first axis varies fastest.
fn in_c_order(values: &[f32], [x, y, z]: [usize; 3]) -> Vec<f32> {
    let mut ordered = Vec::with_capacity(values.len());
    for i in 0..x {
        for j in 0..y {
            ordered.extend((0..z).map(|k| values[(k * y + j) * x + i]));
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of version 1 with this header and these bytes.
    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    /// Protects arrays of all supported kinds: the header is that of `numpy.save`, in both orders of the axes.
    #[test]
    fn both_orders_and_both_widths_give_the_same_array() {
        let numbers: Vec<f32> = (0..24).map(|n| n as f32 - 3.5).collect();
        let single: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let c = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4), }          \n";
        let read_c = read(&file(c, &single), 24).unwrap();
        assert_eq!((read_c.shape, &read_c.values), ([2, 3, 4], &numbers));
        let at = |i: usize, j: usize, k: usize| f64::from(numbers[(i * 3 + j) * 4 + k]);
        let mut turned = Vec::new();
        for k in 0..4 {
            for j in 0..3 {
                turned.extend([0, 1].into_iter().flat_map(|i| at(i, j, k).to_be_bytes()));
            }
        }
        let fortran = "{'descr': '>f8', 'fortran_order': True, 'shape': (2, 3, 4), }\n";
        assert_eq!(read(&file(fortran, &turned), 24).unwrap(), read_c);
    }

    /// Protects the process from damaged and hostile files: each is refused with a reason, and no size in a header is
    /// allocated before it is checked.
    #[test]
    fn damaged_files_are_refused() {
        let header = |kind: &str, shape: &str| {
            format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}")
        };
        let cases: [(Vec<u8>, &str); 7] = [
            (b"no array".to_vec(), "not a NumPy file"),
            (file("{}", &[]), "no descr"),
            (file(&header("<i4", "(2, 2, 2)"), &[0; 32]), "not floats"),
            (file(&header("<f4", "(2, 2)"), &[0; 16]), "three axes"),
            (
                file(&header("<f4", "(2, 2, 2)"), &[0; 31]),
                "ends after 7 of 8",
            ),
            (file(&header("<f4", "(4, 4, 4)"), &[0; 256]), "at most 63"),
            (
                file(&header("<f8", "(4294967296, 4294967296, 2)"), &[]),
                "at most 63",
            ),
        ];
        for (bytes, told) in cases {
            let why = read(&bytes, 63).unwrap_err();
            assert!(why.contains(told), "{why}");
        }
    }
}

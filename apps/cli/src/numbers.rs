//! Parses numbers in the forms that people type: `65536`, `65_536`, `1e6`.

use std::str::FromStr;

/// The largest whole number up to which all whole numbers are exact in `f64`.
const MOST_EXACT: f64 = 9_007_199_254_740_992.0;

/// Parses a count: digits, optionally grouped by underscores, or scientific notation with a whole value.
pub fn count<T: TryFrom<u64>>(said: &str) -> Result<T, String> {
    let text = ungrouped(said)?;
    let whole = match text.parse::<u64>() {
        Ok(whole) => whole,
        Err(_) => of_power(&text)?,
    };
    T::try_from(whole).map_err(|_| format!("{said} is too large"))
}

/// Returns the whole number that a text in scientific notation denotes, such as `1e6` or `2.5e3`.
fn of_power(text: &str) -> Result<u64, String> {
    if !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(format!("{text} is too large"));
    }
    match text.parse::<f64>() {
        Ok(number) if (0.0..=MOST_EXACT).contains(&number) && number.fract() == 0.0 => {
            Ok(number as u64)
        }
        Ok(number) if number < 0.0 => Err("it must be a whole number of 0 or more".to_owned()),
        _ => Err("it must be a whole number, such as 65536, 65_536 or 1e6".to_owned()),
    }
}

/// Parses a number that may have decimals.
pub fn real<T: FromStr>(said: &str) -> Result<T, String> {
    let text = ungrouped(said)?;
    let refused = |_| "it must be a number without a unit, such as 0.5".to_owned();
    text.parse().map_err(refused)
}

/// Parses a level: `-6`, `-6dB` or `-6 dB`.
pub fn decibels(said: &str) -> Result<f64, String> {
    let lower = said.to_ascii_lowercase();
    let number = lower.strip_suffix("db").map_or(&*lower, str::trim_end);
    real(number).map_err(|_| "it must be a number of decibels, such as -6 or -6dB".to_owned())
}

/// Rounds to one decimal. Returns 0 instead of −0.
pub fn tenths(value: f64) -> f64 {
    (10.0 * value).round() / 10.0 + 0.0
}

/// Removes underscores from the text. Each underscore must be between two digits.
fn ungrouped(said: &str) -> Result<String, String> {
    let bytes = said.as_bytes();
    let is_digit = |at: Option<usize>| {
        at.and_then(|at| bytes.get(at))
            .is_some_and(u8::is_ascii_digit)
    };
    for (at, _) in said.match_indices('_') {
        if !is_digit(at.checked_sub(1)) || !is_digit(Some(at + 1)) {
            return Err("an underscore must be between two digits".to_owned());
        }
    }
    Ok(said.replace('_', ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects counts: every notation gives the same count, and any other text is rejected.
    #[test]
    fn counts_are_read_in_every_form() {
        let forms = [
            ("65536", 65_536),
            ("65_536", 65_536),
            ("1e6", 1_000_000),
            ("1E6", 1_000_000),
            ("2.5e3", 2500),
            ("1_0e1", 100),
            ("4095.0", 4095),
        ];
        for (said, meant) in forms {
            assert_eq!(count::<u32>(said), Ok(meant), "{said}");
        }
        for said in [
            "", "_1", "1_", "1__0", "1.5", "-1", "1e-1", "nan", "inf", "1e20", "4e10", "ten",
        ] {
            assert!(count::<u32>(said).is_err(), "{said:?}");
        }
        assert_eq!(count::<u64>("4e10"), Ok(40_000_000_000));
        let refused = |said| count::<u64>(said).unwrap_err();
        assert!(refused("18446744073709551616").ends_with("is too large"));
        assert_eq!(refused("-1"), "it must be a whole number of 0 or more");
        assert!(refused("44.1k").contains("1e6"));
    }

    /// Protects numbers with a decimal point. The caller checks the range.
    #[test]
    fn reals_are_read_in_every_form() {
        assert_eq!(real("1_000.5"), Ok(1000.5f32));
        assert_eq!(real("-1e-3"), Ok(-0.001f64));
        for said in ["", "1_.5", "_", "0x10"] {
            assert!(real::<f64>(said).is_err(), "{said:?}");
        }
        assert!(real::<f64>("2s").is_err_and(|why| why.contains("without a unit")));
    }

    /// Protects levels with their unit.
    #[test]
    fn levels_are_read_with_and_without_decibels() {
        for said in ["-6", "-6dB", "-6 dB", "-6.0DB"] {
            assert_eq!(decibels(said), Ok(-6.0), "{said}");
        }
        for said in ["", "dB", "-6m", "--full"] {
            assert!(
                decibels(said).is_err_and(|why| why.contains("-6dB")),
                "{said:?}"
            );
        }
    }
}

//! The accuracy of a response as it is requested on the command line, and the progress towards it.

use super::super::exit::BadInput;
use super::super::numbers::{count, real};
use clap::Args;
use echomarch::response::{Accuracy, ResponseSettings, Round};
use echomarch::tracer::Settings;

/// Options of the effort for a response.
#[derive(Args, Debug)]
pub struct AccuracyOptions {
    /// Standard error of EDT, T20 and T30, 0.1% to 5%, with the sign %. C50, C80 and G have a tenth of a decibel for
    /// each per cent. The number of waves grows until all figures have this error [default: 2%, unless --waves is given]
    #[arg(long, allow_negative_numbers = true, value_name = "PERCENT", value_parser = percent)]
    accuracy: Option<f64>,
    /// Number of sound waves, 1 to 16777216; the maximum number with --accuracy [default: as many as --accuracy takes,
    /// at most 100 million waves times iterations]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    waves: Option<u32>,
    /// Time limit for each source: waves are added for --accuracy only as far as the time is predicted to suffice. The
    /// result then depends on the speed of the machine [default: no limit]
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    time_limit: Option<f64>,
}

/// Parses a share in per cent: `2%` or `2 %`. A number without the sign could be a share or per cent.
pub fn percent(said: &str) -> Result<f64, String> {
    let number = |text: &str| {
        let number = real::<f64>(text).ok().filter(|number| number.is_finite());
        number
            .ok_or_else(|| "it must be a number of per cent with the sign %, such as 2%".to_owned())
    };
    if let Some(per_cent) = said.strip_suffix('%') {
        return number(per_cent.trim_end()).map(|per_cent| per_cent / 100.0);
    }
    let of_share = (1e6 * number(said)?).round() / 1e4;
    // The greatest accuracy is 5 %.
    let as_share = match of_share <= 5.0 {
        true => format!("{of_share}% for a share of {said}, "),
        false => String::new(),
    };
    Err(format!("write {as_share}{said}% for {said} per cent"))
}

impl AccuracyOptions {
    /// The number of waves if they are given without an accuracy.
    pub fn exact_waves(&self) -> Option<u32> {
        self.waves.filter(|_| self.accuracy.is_none())
    }

    /// The requested accuracy; `None` for a given number of waves.
    pub fn accuracy(&self) -> anyhow::Result<Option<Accuracy>> {
        if self.exact_waves().is_some() {
            return match self.time_limit {
                Some(_) => Err(BadInput(
                    "--time-limit needs --accuracy: without it, exactly --waves waves are traced"
                        .into(),
                )
                .into()),
                None => Ok(None),
            };
        }
        let mut accuracy = Accuracy::default();
        accuracy.share = self.accuracy.unwrap_or(accuracy.share);
        accuracy.most_waves = self.waves;
        accuracy.time_limit_s = self.time_limit;
        if let Some(waves) = self.waves {
            Settings::default().with_waves(waves).validate()?;
        }
        Ok(Some(accuracy))
    }
}

/// The progress of a response after a round: the figures that are not accurate yet.
pub fn of_round(settings: &ResponseSettings, round: &Round) -> String {
    let (Some(accuracy), Some(next)) = (&settings.accuracy, round.next_waves) else {
        return String::new();
    };
    let figures = round.responses.iter().map(|response| &response.figures);
    let share = accuracy.share;
    let worst = figures.max_by(|a, b| a.waves_for(share).total_cmp(&b.waves_for(share)));
    let open = worst.map_or_else(String::new, |worst| worst.inaccurate(share));
    match open.is_empty() {
        true => format!("({next} waves)"),
        false => format!("({next} waves; open: {open})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the notation of accuracies: a number without a sign of per cent, which could be a share, is refused.
    #[test]
    fn accuracies_are_per_cent() {
        assert_eq!(percent("2%"), Ok(0.02));
        assert_eq!(percent("0.5 %"), Ok(0.005));
        let refused = percent("0.05");
        let expected = "write 5% for a share of 0.05, 0.05% for 0.05 per cent";
        assert_eq!(refused, Err(expected.to_owned()));
        assert_eq!(percent("5"), Err("write 5% for 5 per cent".to_owned()));
        assert!(percent("2").is_err_and(|message| message.ends_with("2% for 2 per cent")));
        for wrong in ["two%", "5pct", "inf", "nan%", ""] {
            assert!(percent(wrong).is_err_and(|message| message.ends_with("such as 2%")));
        }
    }
}

//! The choice of sources and listeners.

use super::super::exit::BadInput;
use echomarch::internals::text::which_it_has;
use echomarch::scene::{Pair, Scene, SceneError};

/// A source and a listener of a scene, with their names.
pub struct NamedPair<'a> {
    /// The names of the source and the listener, or their numbers from 1.
    pub source: String,
    pub listener: String,
    /// The numbers of the source and the listener, from 1.
    pub numbers: [usize; 2],
    pub pair: Pair<'a>,
}

/// The first source and the first listener. Commands that have no options to choose them use this pair
/// (docs/scene-format.md).
///
/// # Errors
/// [`SceneError::NoSuchNumber`] if the scene has no source or no listener.
pub fn first(scene: &Scene) -> Result<Pair<'_>, SceneError> {
    scene.pair(0, 0)
}

/// Returns the pairs of the sources and listeners that were chosen by name or number. Without a choice, returns all
/// pairs.
pub fn chosen<'a>(
    scene: &'a Scene,
    source: Option<&str>,
    listener: Option<&str>,
) -> Result<Vec<NamedPair<'a>>, BadInput> {
    let (sources, listeners) = (scene.source_labels(), scene.listener_labels());
    let from = choose("source", &sources, source)?;
    let to = choose("listener", &listeners, listener)?;
    let both = from
        .iter()
        .flat_map(|from| to.iter().map(move |to| (*from, *to)));
    let pair = |(from, to): (usize, usize)| {
        let pair = scene.pair(from, to);
        Ok(NamedPair {
            source: sources[from].clone(),
            listener: listeners[to].clone(),
            numbers: [from + 1, to + 1],
            pair: pair.map_err(|error| BadInput(error.to_string()))?,
        })
    };
    both.map(pair).collect()
}

/// Returns the index of the listener that was chosen by name or number. Without a choice, returns the first listener.
pub fn listener(scene: &Scene, wanted: Option<&str>) -> Result<usize, BadInput> {
    let chosen = choose("listener", &scene.listener_labels(), wanted)?;
    Ok(chosen[0])
}

/// Returns the chosen indices. A name takes precedence over a number.
fn choose(what: &str, labels: &[String], wanted: Option<&str>) -> Result<Vec<usize>, BadInput> {
    let Some(wanted) = wanted else {
        return Ok((0..labels.len()).collect());
    };
    let by_number = || {
        wanted
            .parse::<usize>()
            .ok()?
            .checked_sub(1)
            .filter(|at| *at < labels.len())
    };
    match labels
        .iter()
        .position(|label| label == wanted)
        .or_else(by_number)
    {
        Some(index) => Ok(vec![index]),
        None => {
            let refused = format!("the scene has no {what} {wanted:?}");
            Err(BadInput(which_it_has(&refused, wanted, labels)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the choice by name and by number, and the message for an unknown name.
    #[test]
    fn names_count_before_numbers() {
        let labels = ["2", "2", "flute"].map(str::to_owned);
        assert_eq!(choose("source", &labels, None).unwrap(), [0, 1, 2]);
        // The second source has no name, so its label is "2". The first source has the name "2", which takes
        // precedence.
        assert_eq!(choose("source", &labels, Some("2")).unwrap(), [0]);
        assert_eq!(choose("source", &labels, Some("3")).unwrap(), [2]);
        assert_eq!(choose("source", &labels, Some("flute")).unwrap(), [2]);
        let refused = choose("source", &labels, Some("drum")).unwrap_err();
        assert!(
            refused
                .0
                .contains("no source \"drum\"; it has: 2, 2, flute")
        );
        assert!(choose("source", &labels, Some("0")).is_err());
    }
}

//! The sounds of the sources.

use super::super::exit::BadInput;
use echomarch::Error;
use echomarch::audio::{Sound, SoundSpec};
use echomarch::internals::text::which_it_has;
use echomarch::scene::Scene;
use std::str::FromStr;

/// A sound for all sources, or `NAME=SOUND` for one source. NAME is the name of the source, or its number if it has no
/// name. A file name may also contain `=`, so the text is split only if NAME is a source of the scene.
#[derive(Clone, Debug)]
pub struct SourceSound {
    text: String,
    for_all: Option<SoundSpec>,
    for_one: Option<(String, SoundSpec)>,
}

impl FromStr for SourceSound {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole: Result<SoundSpec, _> = text.parse();
        let one = text
            .split_once('=')
            .and_then(|(name, sound)| Some((name.trim().to_owned(), sound.parse().ok()?)));
        match (whole, one) {
            (Err(error), None) => Err(error.to_string()),
            (whole, for_one) => Ok(SourceSound {
                text: text.to_owned(),
                for_all: whole.ok(),
                for_one,
            }),
        }
    }
}

/// Returns the sound of each source of a scene. By default each source has a different voice.
pub fn of_sources(scene: &Scene, typed: &[SourceSound]) -> Result<Vec<SoundSpec>, BadInput> {
    let names = scene.source_labels();
    let voice = |seed: usize| SoundSpec::Speech { seed: seed as u64 };
    let mut specs: Vec<SoundSpec> = (0..names.len()).map(voice).collect();
    let own = |sound: &SourceSound| {
        let (name, spec) = sound.for_one.clone()?;
        let source = names.iter().position(|known| *known == name)?;
        Some((source, spec))
    };
    for sound in typed.iter().filter(|sound| own(sound).is_none()) {
        match &sound.for_all {
            Some(spec) if !is_missing_file(sound) => specs.fill(spec.clone()),
            _ => return Err(unknown_source(scene, sound)),
        }
    }
    for (source, spec) in typed.iter().filter_map(own) {
        specs[source] = spec;
    }
    Ok(specs)
}

/// Loads the sounds of all sources.
pub fn load(specs: &[SoundSpec]) -> Result<Vec<Sound>, Error> {
    let load = |spec: &SoundSpec| Sound::load(spec, Sound::SAMPLE_RATE).map_err(Error::from);
    specs.iter().map(load).collect()
}

/// The names of the sounds, for the report.
pub fn names(specs: &[SoundSpec]) -> String {
    let mut names: Vec<String> = specs.iter().map(SoundSpec::to_string).collect();
    names.dedup();
    names.join(", ")
}

/// Whether the text is of the form `NAME=FILE`, and no file has this whole text as its name.
fn is_missing_file(sound: &SourceSound) -> bool {
    let missing = |spec: &SoundSpec| matches!(spec, SoundSpec::Wav { path } if !path.exists());
    sound.for_one.is_some() && sound.for_all.as_ref().is_some_and(missing)
}

fn unknown_source(scene: &Scene, sound: &SourceSound) -> BadInput {
    let names = scene.source_labels();
    let typed = sound.for_one.as_ref().map_or("", |(name, _)| name);
    let refused = format!(
        "--sound {:?} is neither a sound nor the sound of a source of {:?}",
        sound.text, scene.name
    );
    BadInput(which_it_has(&refused, typed, &names))
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::glam::Vec3;
    use echomarch::scene::Source;

    fn sounds(typed: &[&str]) -> Result<String, String> {
        let mut scene = Scene::builtin("open-field").expect("a built-in scene");
        scene.sources.push(Source::at(Vec3::ZERO).named("flute"));
        let typed: Result<Vec<SourceSound>, String> =
            typed.iter().map(|text| text.parse()).collect();
        let specs = of_sources(&scene, &typed?).map_err(|refused| refused.0)?;
        Ok(names(&specs))
    }

    /// Protects the choice of sounds: a different voice for each source by default, one sound for all sources, or one
    /// sound for one source.
    #[test]
    fn each_source_has_its_sound() {
        assert_eq!(sounds(&[]).unwrap(), "speech:0, speech:1");
        assert_eq!(sounds(&["noise:3"]).unwrap(), "noise:3");
        let unnamed = sounds(&["1=noise:7", "flute=noise:3"]).unwrap();
        assert_eq!(unnamed, "noise:7, noise:3");
        let own = sounds(&["flute=sine:440", "noise:3"]).unwrap();
        assert_eq!(own, "noise:3, sine:440");
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a=b.wav");
        std::fs::write(&file, "").unwrap();
        let file = file.to_str().unwrap();
        assert_eq!(sounds(&[file]).unwrap(), file);
        for wrong in ["flut=noise", "flut=none.wav"] {
            let refused = sounds(&[wrong]).unwrap_err();
            let said = "it has: 1, flute; did you mean flute?";
            assert!(refused.ends_with(said), "{refused}");
        }
        assert!(
            sounds(&["drum=noise"])
                .unwrap_err()
                .contains("it has: 1, flute")
        );
        assert!(sounds(&["hum"]).is_err());
    }
}

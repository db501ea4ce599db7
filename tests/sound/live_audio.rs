//! The callback of live output, driven without a device: no allocations, no clicks, correct levels and channels.

use crate::common::tracer;
use crate::measures::{largest_step, rms};
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use echomarch::Scene;
use echomarch::audio::live::probe::{self, Recorder};
use echomarch::audio::live::{LiveError, Remote, Renderer};
use echomarch::audio::{AudioError, PanningLaw, Sound};
use echomarch::auralisation::{Heard, Player, Spec};
use echomarch::response::ListenerAxes;
use echomarch::response::{Response, ResponseSettings};
use tempfile::TempDir;

/// Aborts the test on any allocation or deallocation within `assert_no_alloc`.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

fn sound(text: &str) -> Sound {
    Sound::parse(text, Sound::SAMPLE_RATE).unwrap()
}

/// Writes a WAV file of these samples and returns its path.
fn wav(folder: &TempDir, samples: impl Iterator<Item = f32>) -> String {
    let path = folder.path().join("clip.wav");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: Sound::SAMPLE_RATE,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for sample in samples {
        writer.write_sample(sample).unwrap();
    }
    writer.finalize().unwrap();
    path.to_str().unwrap().to_owned()
}

fn renderer(text: &str) -> (Renderer, Remote) {
    Renderer::new(Some(sound(text)), Sound::SAMPLE_RATE, PanningLaw::Linear)
}

/// Renders `frames` frames in blocks as a device requests them.
fn render(renderer: &mut Renderer, frames: usize) -> Vec<f32> {
    let mut out = vec![f32::NAN; 2 * frames];
    for block in out.chunks_mut(2 * 441) {
        assert_no_alloc(|| renderer.fill(block));
    }
    out
}

fn channel(stereo: &[f32], which: usize) -> Vec<f32> {
    stereo.iter().skip(which).step_by(2).copied().collect()
}

#[test]
fn the_callback_allocates_nothing_while_everything_changes() {
    let (mut renderer, mut remote) = renderer("sine:440");
    let sounds = ["noise", "speech", "sine:997", "speech:2", "noise:5"];
    let mut floats = vec![0.0f32; 2 * 1024];
    let mut integers = vec![0i16; 6 * 300];
    let mut freed = 0;
    for i in 0..2000usize {
        remote.set_panning(i as f64 % 7.0, i as f64 % 5.0);
        remote.set_volume((i % 11) as f32 / 10.0);
        remote.set_law([PanningLaw::Linear, PanningLaw::ConstantPower][i % 2]);
        if i % 3 == 0 {
            remote.set_sound(sound(sounds[i / 3 % sounds.len()]), Sound::SAMPLE_RATE);
        }
        assert_no_alloc(|| {
            renderer.fill(&mut floats);
            renderer.fill_device(&mut integers, 6);
        });
        freed += remote.collect();
        assert!(floats.iter().all(|s| s.abs() <= 1.0));
    }
    assert!(freed > 500, "{freed}");
}

/// Protects the callback of a stream with a clip that loops and a recording: it allocates nothing, and the recording
/// equals the output.
#[test]
fn a_stream_with_a_clip_and_a_recording_allocates_nothing() {
    let folder = TempDir::new().unwrap();
    // The clip's end does not match its start, and the clip loops within a few blocks.
    let clip = wav(&folder, (0..3000).map(|i| i as f32 / 3000.0));
    let (renderer, mut remote) = renderer("sine:440");
    let mut play = probe::player::<f32>(renderer, &remote, 2);
    let mut block = vec![0.0f32; 2 * 1024];
    let mut played = Vec::new();
    for (round, text) in [clip.as_str(), "speech", clip.as_str()].iter().enumerate() {
        let file = folder.path().join(format!("{round}.wav"));
        let recorder = Recorder::start(&mut remote, &file, Sound::SAMPLE_RATE).unwrap();
        assert!(remote.set_sound(sound(text), Sound::SAMPLE_RATE));
        played.clear();
        for i in 0..50 {
            remote.set_panning(f64::from(i), 5.0);
            assert_no_alloc(|| play(&mut block));
            played.extend_from_slice(&block);
        }
        assert_eq!(recorder.finish().unwrap(), 50 * 1024);
        let mut reader = hound::WavReader::open(&file).unwrap();
        let written: Vec<f32> = reader.samples().map(Result::unwrap).collect();
        assert!(written == played, "round {round}");
        // The callback returns the tap of a finished recording.
        assert_no_alloc(|| play(&mut block));
        assert!(remote.collect() >= 2);
    }
    assert!(remote.levels() != [0.0, 0.0]);
}

/// Protects the callback while several sources are played in full: updates, fades of late parts, and the change from
/// the balance and back allocate nothing. Loud sound stays within full scale, nothing clicks, and unused objects are
/// returned.
#[test]
fn the_callback_plays_sources_in_full_and_allocates_nothing() {
    let scene = Scene::builtin("shoebox").unwrap();
    let settings = ResponseSettings::default().with_seconds(0.2).with_order(2);
    let mut tracer = tracer();
    let near = Response::trace(&mut tracer, &scene, &settings).unwrap();
    let mut further = scene.clone();
    further.sources[0].position.x += 0.1;
    let far = Response::trace(&mut tracer, &further, &settings).unwrap();
    let spec = Spec::of(&scene, Sound::SAMPLE_RATE).with_longest(0.2);
    let axes = ListenerAxes::of(&scene.listeners[0]).unwrap();
    let (mut renderer, mut remote) = renderer("sine:440");
    let sounds = vec![sound("sine:300"), sound("sine:500")];
    let (player, mut told) = Player::new(sounds, spec, 0.2).unwrap();
    assert_eq!(told.source_count(), 2);
    assert!(remote.set_stereo(Some(Box::new(player)), Sound::SAMPLE_RATE));
    let mut played = Vec::new();
    for round in 0..120 {
        if round % 10 < 8 {
            let response = [&near, &far][round / 10 % 2];
            let heard = Heard::new(response, &axes, spec, 1).unwrap();
            assert!(told.hear(round % 2, heard, 0.02).unwrap());
        }
        if round == 100 {
            assert!(remote.set_stereo(None, Sound::SAMPLE_RATE));
        }
        played.extend(render(&mut renderer, 1470));
        remote.collect();
    }
    assert!(played.iter().all(|sample| sample.abs() <= 1.0));
    let left = channel(&played, 0);
    let loud = |from: usize| left[from..].iter().take(9600).any(|s| s.abs() > 0.05);
    assert!(loud(48_000) && loud(160_000));
    // A sine of 500 Hz at full scale has steps of 0.065.
    let step = largest_step(&left);
    assert!(step < 0.1, "a step of {step}");
}

#[test]
fn it_rises_from_silence_to_what_the_mixer_would_give() {
    let (mut renderer, remote) = renderer("sine:1000");
    remote.set_panning(1.0, 3.0);
    let out = render(&mut renderer, 4800);
    let mut mono = vec![0.0; 4800];
    sound("sine:1000").fill(&mut mono);
    assert!(out[..20].iter().all(|s| s.abs() < 0.01));
    for (pair, mono) in out.chunks(2).zip(&mono).skip(960) {
        assert!((pair[0] - 0.25 * mono).abs() < 1e-6);
        assert!((pair[1] - 0.75 * mono).abs() < 1e-6);
    }
}

/// A step may be at most the sum of the sine's own step and the step of a 20 ms glide.
#[test]
fn gains_that_jump_do_not_click() {
    let (mut renderer, remote) = renderer("sine:100");
    let mut out = render(&mut renderer, 4800);
    for (left, right, volume) in [
        (1.0, 0.0, 1.0),
        (0.0, 1.0, 1.0),
        (0.0, 1.0, 0.0),
        (1.0, 0.0, 1.0),
    ] {
        remote.set_panning(left, right);
        remote.set_volume(volume);
        // A jump in the middle of the previous glide.
        out.extend(render(&mut renderer, 300));
        remote.set_law(PanningLaw::ConstantPower);
        out.extend(render(&mut renderer, 4800));
    }
    let own = Sound::SINE_AMPLITUDE * 100.0 * std::f32::consts::TAU / Sound::SAMPLE_RATE as f32;
    let glide = Sound::SINE_AMPLITUDE / (Sound::SAMPLE_RATE as f32 / 50.0);
    for which in [0, 1] {
        let step = largest_step(&channel(&out, which));
        println!("largest step {step:.5}, allowed {:.5}", own + glide);
        assert!(step <= own + glide + 1e-6);
        assert!(step > own * 0.9, "the sine must be audible");
    }
}

#[test]
fn sounds_that_change_do_not_click() {
    let (mut renderer, mut remote) = renderer("sine:100");
    remote.set_panning(1.0, 0.0);
    let mut out = render(&mut renderer, 5000);
    for text in ["sine:150", "sine:90", "sine:120"] {
        // Two changes at once: the second waits until the fade to the first has ended.
        assert!(remote.set_sound(sound("sine:60"), Sound::SAMPLE_RATE));
        assert!(remote.set_sound(sound(text), Sound::SAMPLE_RATE));
        out.extend(render(&mut renderer, 5123));
    }
    assert_eq!(remote.collect(), 6);
    let own = Sound::SINE_AMPLITUDE * 150.0 * std::f32::consts::TAU / Sound::SAMPLE_RATE as f32;
    let fade = 2.0 * Sound::SINE_AMPLITUDE / (Sound::SAMPLE_RATE as f32 / 50.0);
    let step = largest_step(&channel(&out, 0));
    println!("largest step {step:.5}, allowed {:.5}", own + fade);
    assert!(step <= own + fade + 1e-6);
    // At the end the most recent sound plays, from its own start.
    let mut last = vec![0.0; 5123];
    sound("sine:120").fill(&mut last);
    let tail = channel(&out[out.len() - 2000..], 0);
    let found = (0..2000)
        .map(|lag| &last[last.len() - 1000 - lag..][..1000])
        .any(|piece| piece.iter().zip(&tail).all(|(a, b)| (a - b).abs() < 1e-6));
    assert!(found);
}

/// Protects the first sound from clicking: it rises from the silence before it.
#[test]
fn a_sound_where_there_was_none_does_not_click() {
    let (mut renderer, mut remote) = Renderer::new(None, Sound::SAMPLE_RATE, PanningLaw::Linear);
    remote.set_panning(1.0, 0.0);
    assert!(render(&mut renderer, 4800).iter().all(|&s| s == 0.0));
    let mut late = sound("sine:100");
    // A quarter of a period: it starts at its peak.
    late.seek(120);
    assert!(remote.set_sound(late, Sound::SAMPLE_RATE));
    let step = largest_step(&channel(&render(&mut renderer, 4800), 0));
    let own = Sound::SINE_AMPLITUDE * 100.0 * std::f32::consts::TAU / Sound::SAMPLE_RATE as f32;
    let fade = Sound::SINE_AMPLITUDE / (Sound::SAMPLE_RATE as f32 / 50.0);
    println!("largest step {step:.5}, allowed {:.5}", own + fade);
    assert!(step <= own + fade + 1e-6);
    assert!(step > own * 0.9, "the sine must be audible");
}

#[test]
fn a_sound_for_another_rate_is_not_played() {
    let (mut renderer, mut remote) = renderer("sine:440");
    let before = render(&mut renderer, 4800);
    let other = Sound::parse("noise", 44_100).unwrap();
    assert!(remote.set_sound(other, 44_100));
    let after = render(&mut renderer, 4800);
    assert_eq!(remote.collect(), 1);
    assert!((rms(&before[2000..]) / rms(&after[2000..]) - 1.0).abs() < 0.02);
}

#[test]
fn the_levels_are_those_of_the_last_moment() {
    let (mut renderer, remote) = renderer("sine:1000");
    remote.set_panning(1.0, 3.0);
    render(&mut renderer, 4800 + 2400);
    let [left, right] = remote.levels();
    let full = Sound::SINE_AMPLITUDE / 2f32.sqrt();
    assert!((left / (0.25 * full) - 1.0).abs() < 1e-3, "{left}");
    assert!((right / (0.75 * full) - 1.0).abs() < 1e-3, "{right}");
    remote.set_volume(0.0);
    render(&mut renderer, 3 * 2400);
    assert_eq!(remote.levels(), [0.0, 0.0]);
}

#[test]
fn every_number_of_channels_gets_its_share() {
    let stereo = {
        let (mut renderer, remote) = renderer("speech");
        remote.set_panning(1.0, 3.0);
        render(&mut renderer, 30_000)
    };
    for channels in [1, 2, 5] {
        let (mut renderer, remote) = renderer("speech");
        remote.set_panning(1.0, 3.0);
        let mut out = vec![1.0f32; 30_000 * channels];
        for block in out.chunks_mut(700 * channels) {
            assert_no_alloc(|| renderer.fill_device(block, channels));
        }
        for (frame, pair) in out.chunks(channels).zip(stereo.chunks(2)) {
            match frame {
                [only] => assert!((only - (pair[0] + pair[1]) / 2.0).abs() < 1e-6),
                [left, right, others @ ..] => {
                    assert!((left - pair[0]).abs() < 1e-6 && (right - pair[1]).abs() < 1e-6);
                    assert!(others.iter().all(|&s| s == 0.0));
                }
                [] => unreachable!(),
            }
        }
    }
}

#[test]
fn integers_are_scaled() {
    let (mut renderer, remote) = renderer("sine:1000");
    remote.set_panning(1.0, 0.0);
    let mut out = vec![0i16; 2 * 4800];
    assert_no_alloc(|| renderer.fill_device(&mut out, 2));
    let peak = out.iter().map(|s| s.unsigned_abs()).max().unwrap();
    assert!((i32::from(peak) - 16_384).abs() <= 1, "{peak}");
}

/// Protects a sound beyond full scale from wrapping to the other sign.
#[test]
fn integers_never_wrap() {
    let folder = TempDir::new().unwrap();
    let square = |i: u32| {
        if (i / 100).is_multiple_of(2) {
            2.0
        } else {
            -2.0
        }
    };
    let clip = wav(&folder, (0..9600).map(square));
    let (mut renderer, remote) = renderer(&clip);
    remote.set_panning(1.0, 0.0);
    let mut out = vec![0i16; 2 * 2400];
    assert_no_alloc(|| renderer.fill_device(&mut out, 2));
    let (mut narrow, mut wide) = (vec![0i16; 2 * 2400], vec![0i32; 2 * 2400]);
    renderer.fill_device(&mut narrow, 2);
    renderer.fill_device(&mut wide, 2);
    for i in 0..2400 {
        let is_up = square(i) > 0.0;
        let i = 2 * i as usize;
        assert_eq!(narrow[i], if is_up { i16::MAX } else { i16::MIN });
        assert_eq!(wide[i], if is_up { i32::MAX } else { i32::MIN });
    }
}

#[test]
fn errors_are_sentences() {
    let error = LiveError::from(AudioError::BadSampleRate { sample_rate_hz: 3 });
    assert!(error.to_string().contains("3 Hz"), "{error}");
    let error = LiveError::UnknownDevice {
        name: "Kitchen".to_owned(),
        known: "Attic, Cellar".to_owned(),
    };
    let text = error.to_string();
    assert!(text.contains("`Kitchen`") && text.contains("Attic, Cellar"));
}

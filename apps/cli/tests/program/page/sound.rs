//! The page's sound: recorded from its own audio graph, stopped, played with a refused text, and played in browsers
//! that lack a required feature.

use super::{FLAGS, Stage, TIMEOUT, escaped, on_page, wait, write_text};
use crate::webdriver::Browser;
use std::time::{Duration, Instant};

/// The levels of both channels in decibels over the last 32,768 samples (0.7 s at 48 kHz) that the page played,
/// recorded from its own audio graph.
const RECORD: &str = "
    const { context, output } = echomarch.sound();
    if (window.recorded !== context) {
        const splitter = context.createChannelSplitter(2);
        output.connect(splitter);
        window.recorders = [0, 1].map((channel) => {
            const analyser = new AnalyserNode(context, { fftSize: 32768 });
            splitter.connect(analyser, channel);
            return analyser;
        });
        window.recorded = context;
        window.since = context.currentTime;
    }
    if (context.currentTime - window.since < arguments_seconds) return null;
    return window.recorders.map((recorder) => {
        const samples = new Float32Array(recorder.fftSize);
        recorder.getFloatTimeDomainData(samples);
        return 10 * Math.log10(samples.reduce((sum, s) => sum + s * s, 0) / samples.length + 1e-12);
    });";

/// Records for `seconds` seconds from this call on, and returns the final levels.
fn levels(browser: &Browser, seconds: f64) -> [f64; 2] {
    browser.run(
        "if (window.recorders) window.since = echomarch.sound().context.currentTime; return 0",
    );
    let script = RECORD.replace("arguments_seconds", &seconds.to_string());
    let began = Instant::now();
    loop {
        let told = browser.run(&script);
        if let Some(levels) = told.as_array() {
            return [0, 1].map(|channel: usize| levels[channel].as_f64().unwrap());
        }
        assert!(began.elapsed() < TIMEOUT, "the sound's clock stands still");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A side of the listener: left or right.
#[derive(Clone, Copy, Debug)]
enum Side {
    Left,
    Right,
}

/// Loads a page with a source 6 m to the right of a listener that looks along -z, and starts the sound.
fn play_at_the_right(stage: &Stage, browser: &Browser, listen: &str) {
    let link = format!(
        "#scene=open-field&waves=16384&listen={listen}&sound=noise&listener=0,0,0,0,0&source=6,0,-1"
    );
    stage.load(browser, &link);
    browser.click("#play");
    wait(
        browser,
        "return echomarch.sound() != null && echomarch.levels()[1] > -60",
    );
}

/// Turns the listener by 180°, so that the source is at the left.
fn turn_round(browser: &Browser) {
    browser.run("echomarch.page.stand(0, 0, 0, Math.PI, 0); return 0");
}

/// Waits until `side` is louder, then checks it in a recording.
fn check_side(browser: &Browser, side: Side, what: &str) {
    /// Minimum difference between the channels in decibels. The pan of a source at the side differs by at least 10 dB.
    const LOUDER_DB: f64 = 6.0;
    let difference = |[left, right]: [f64; 2]| match side {
        Side::Left => left - right,
        Side::Right => right - left,
    };
    wait(
        browser,
        match side {
            Side::Left => "const [l, r] = echomarch.levels(); return l > r + 3",
            Side::Right => "const [l, r] = echomarch.levels(); return r > l + 3",
        },
    );
    let recorded = levels(browser, 2.0);
    println!("{what}, {side:?}: {recorded:.1?} dB");
    assert!(difference(recorded) > LOUDER_DB, "{what}: {recorded:?}");
}

/// Protects the direction of sound: it comes from the side of the source in full listening and with the balance, and
/// changes when the listener turns around.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_plays_the_source_where_it_is() {
    on_page(|stage, browser| {
        for listen in ["full", "balance"] {
            play_at_the_right(stage, browser, listen);
            check_side(browser, Side::Right, listen);
            turn_round(browser);
            check_side(browser, Side::Left, listen);
        }
    });
}

/// A talker behind a pillar of concrete, which sound passes and bends around.
const PILLAR: &str = "Scene(
    surfaces: [Surface(shape: Cylinder(radius: 1, height: 6), material: \"concrete\")],
    source: Source(position: (0, 0, -3)),
    listener: Listener(position: (0.3, 0, 3), radius: 0.3))";

/// Protects the switches of the parts of full sound: a key changes which kinds of paths are heard and drawn, and the link
/// contains the choice.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn keys_switch_parts_of_the_sound() {
    on_page(|stage, browser| {
        let link = format!(
            "#waves=4096&sound=noise&diffraction=on&text={}",
            escaped(PILLAR)
        );
        stage.load(browser, &link);
        browser.click("#play");
        browser.wait_for("#kinds", "2 diffracted");
        browser.wait_for("#kinds", "1 transmitted");
        // Three paths, each with its kind and the number of its points.
        wait(
            browser,
            "return echomarch.paths().length > 3 * 2 + 2 * 2 * 3",
        );
        browser.click("h1");
        browser.press("4");
        wait(
            browser,
            "const text = document.getElementById('kinds').textContent; \
             return text.includes('transmitted') && !text.includes('diffracted')",
        );
        browser.press("5");
        browser.wait_for(
            "#kinds",
            "nothing arrives: look for a wall or a closed door",
        );
        assert_eq!(browser.run("return echomarch.paths().length"), 0);
        browser.press("8");
        browser.wait_for("#kinds", "1 added");
        wait(
            browser,
            "return ['diffraction=off', 'transmission=off', 'late=on', 'least=-30']\
             .every((choice) => echomarch.address().includes(choice))",
        );
    });
}

/// Protects the switches from an effect on the other parts: a part that is switched off and on again leaves the late part
/// as loud as before, also on a busy machine, whose traces are slow.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn switching_a_part_leaves_the_late_part() {
    // A response of the whole length has a late part of 28.5 dB, because nothing absorbs.
    const IS_WHOLE: &str = "
        const late = document.getElementById('kinds').textContent.match(/late ([\\d.]+) dB/);
        return late !== null && Number(late[1]) > 27";
    on_page(|stage, browser| {
        stage.load(browser, "#scene=shoebox&waves=4096&sound=noise&motion=off");
        browser.click("#play");
        wait(browser, IS_WHOLE);
        browser.click("h1");
        for (key, is_off) in [
            ("7", "!text.includes('late')"),
            ("6", "!text.includes('mirrored')"),
        ] {
            browser.press(key);
            let is_off = format!(
                "const text = document.getElementById('kinds').textContent; return {is_off}"
            );
            wait(browser, &is_off);
            browser.press(key);
            wait(browser, IS_WHOLE);
        }
    });
}

/// Protects the sound while a text is edited: while the text is invalid, another sound can be chosen and plays in the
/// last valid scene. The listener's position still takes effect.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_refused_text_does_not_hold_up_the_ears() {
    on_page(|stage, browser| {
        play_at_the_right(stage, browser, "full");
        check_side(browser, Side::Right, "before");
        write_text(browser, "Scene(surfaces: [");
        browser.wait_for("#error", "1:");
        browser
            .run("document.getElementById('sound').dispatchEvent(new Event('change')); return 0");
        turn_round(browser);
        check_side(browser, Side::Left, "with a refused text");
    });
}

/// Protects the page from unnecessary updates: it makes none while the sound is stopped. When the sound is resumed, it
/// corresponds to the listener's current position.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_sound_that_was_stopped_goes_on_where_one_stands() {
    const COUNT: &str = "
        const sound = echomarch.sound();
        window.told = 0;
        window.pictures = 0;
        const count = () => { window.pictures += 1; requestAnimationFrame(count); };
        requestAnimationFrame(count);
        const stand = sound.stand.bind(sound);
        sound.stand = (standing) => { window.told += 1; stand(standing); };
        return 0";
    on_page(|stage, browser| {
        play_at_the_right(stage, browser, "full");
        check_side(browser, Side::Right, "before");
        browser.click("#play");
        let is_stopped = "return echomarch.sound().context.state === 'suspended' \
                          && document.getElementById('play').textContent === 'Play sound'";
        wait(browser, is_stopped);
        browser.run(COUNT);
        turn_round(browser);
        wait(browser, "return window.pictures > 5");
        assert_eq!(browser.run("return window.told"), 0);
        browser.click("#play");
        check_side(browser, Side::Left, "after it was stopped");
        assert!(browser.run("return window.told").as_u64() > Some(0));
    });
}

/// Protects users who edit a scene: the changed scene is heard without its waves first, whose shaders take seconds to
/// compile. The figures of the previous scene disappear at once.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_changed_scene_is_heard_before_its_waves() {
    const WATCH: &str = "
        window.said = { hits: [], full: [], kinds: [] };
        for (const [id, said] of Object.entries(window.said)) {
            const element = document.getElementById(id);
            new MutationObserver(() => said.push(element.textContent)).observe(element, { childList: true });
        }
        return 0";
    on_page(|stage, browser| {
        stage.load(
            browser,
            "#scene=shoebox&waves=4096&sound=noise&diffraction=on",
        );
        browser.click("#play");
        browser.wait_for("#kinds", "late");
        wait(browser, "return echomarch.page.frame().length > 0");
        browser.run(WATCH);
        let text = browser.run("return document.getElementById('text').value");
        let ball = "surfaces: [Surface(shape: Torus(ring: 0.3, tube: 0.1)), ";
        let changed = text.as_str().unwrap().replacen("surfaces: [", ball, 1);
        write_text(browser, &changed);
        wait(
            browser,
            "const { hits, full, kinds } = window.said; \
             return hits.includes('computing …') && full.includes('computing …') \
             && kinds.findIndex((text) => text.includes('mirrored') && text.includes('late part computing …')) >= 0 \
             && /late [\\d.]+ dB/.test(kinds.at(-1)) && hits.at(-1) !== 'computing …'",
        );
    });
}

/// Protects users who stand inside a solid from unexplained silence: the page names the solid, as the program does.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_listener_inside_a_solid_is_told() {
    on_page(|stage, browser| {
        let link = format!("#waves=1024&text={}", escaped(PILLAR));
        stage.load(browser, &link);
        assert!(browser.text("#message").is_empty());
        browser.run("echomarch.page.stand(0, 0, 0.2, 0, 0); return 0");
        browser.wait_for(
            "#message",
            "m inside surface 1 (CappedCylinder): few waves reach it",
        );
        browser.run("echomarch.page.stand(0, 0, 3, 0, 0); return 0");
        wait(browser, "return document.getElementById('message').hidden");
    });
}

/// Protects users who serve the page without encryption from unexplained silence: the page states what sound requires,
/// and continues.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_that_may_not_play_says_why() {
    let stage = Stage::new();
    let mut flags = FLAGS.to_vec();
    flags.push("--host-resolver-rules=MAP page.test 127.0.0.1");
    let browser = stage.open_with(&flags);
    browser.visit(&stage.address.replace("127.0.0.1", "page.test"));
    wait(&browser, "return window.echomarch?.page.frame().length > 0");
    browser.click("#play");
    browser.wait_for("#message", "only over https:// or from localhost");
    assert_eq!(browser.text("#play"), "Play sound");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects sound in browsers that cannot trace full listening: the page shows a message, plays the balance, and
/// disables the other choice.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn without_ears_the_balance_is_played() {
    let stage = Stage::new();
    let browser = stage.open_with(&FLAGS);
    browser.before_load(
        "const Usual = Worker;
         Worker = class extends Usual {
             constructor(file, options) { super(file === 'ears.js' ? 'none.js' : file, options); }
         };",
    );
    play_at_the_right(&stage, &browser, "full");
    browser.wait_for("#message", "Only the balance can be heard");
    check_side(&browser, Side::Right, "balance");
    browser.click("h1");
    browser.press("v");
    let listen = "const list = document.getElementById('listen'); \
                  return list.value + ' ' + list.options[0].disabled";
    assert_eq!(browser.run(listen), "balance true");
}

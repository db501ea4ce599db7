//! The page of `examples/browser`, in a headless browser whose WebGL is a software renderer: counts against the
//! program's, sound, keys, links, and texts that are no scenes.
//!
//! `scripts/browser-test.sh` builds the page and runs these; elsewhere they are left out, since building it takes
//! another compiler's target.

use crate::browser::{Browser, Driver};
use crate::common::cli::{argument, json};
use serde_json::Value;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long anything may take before a test is given up: no machine is so busy.
const TIMEOUT: Duration = Duration::from_secs(300);

/// By how much a count of 65,536 waves may differ between two renderers. Their roundings differ, so that some 120 waves
/// (in `cave`, docs/portability.md) end elsewhere. What a count gains by that and what it loses nearly cancel: √120 is
/// 11.
const MAY_DIFFER: u64 = 16;

/// SwiftShader, which Chromium brings, and no sound card but a clock; sound without a click before it.
const FLAGS: [&str; 3] = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--autoplay-policy=no-user-gesture-required",
];

/// The page behind a server of files, and a browser that shows it.
struct Stage {
    // In the order in which they go.
    server: Child,
    driver: Driver,
    address: String,
    folder: TempDir,
}

impl Drop for Stage {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Stage {
    fn new() -> Stage {
        let page = std::env::var_os("ECHOMARCH_PAGE")
            .map(PathBuf::from)
            .expect("ECHOMARCH_PAGE names the folder that scripts/browser.sh made");
        let mut server = Command::new("python3")
            .args([
                "-u",
                "-m",
                "http.server",
                "0",
                "--bind",
                "127.0.0.1",
                "--directory",
            ])
            .arg(&page)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("no python3");
        let mut line = String::new();
        let out = server.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        let port = line
            .split_whitespace()
            .nth(5)
            .expect("the server says its port");
        Stage {
            address: format!("http://127.0.0.1:{port}/"),
            server,
            driver: Driver::start(),
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn open(&self) -> Browser<'_> {
        let folder = self.folder.path();
        self.driver.open_with(folder, folder, &FLAGS)
    }

    /// Loads the page anew with a link, and waits for its first frame.
    fn load(&self, browser: &Browser, link: &str) {
        browser.visit("about:blank");
        browser.visit(&format!("{}{link}", self.address));
        wait(browser, "return window.echomarch?.page.frame().length > 0");
    }
}

/// Waits until the function's body returns true.
fn wait(browser: &Browser, script: &str) -> Duration {
    let began = Instant::now();
    while browser.run(script) != Value::Bool(true) {
        let shown = browser.run("return document.body?.innerText ?? ''");
        assert!(
            began.elapsed() < TIMEOUT,
            "never: {script}; the page says {shown}"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    began.elapsed()
}

/// Waves at the listener, dead, travelling.
fn counts_of_page(browser: &Browser) -> [u64; 3] {
    let frame = browser.run("return Array.from(echomarch.page.frame())");
    [0, 1, 2].map(|index| frame[index].as_f64().unwrap() as u64)
}

fn counts_of_program(scene: &str) -> [u64; 3] {
    let told = json(&["trace", scene, "--waves", "65536", "--iterations", "8"]);
    ["listener_hits", "dead", "travelling"].map(|name| told[name].as_u64().unwrap())
}

/// A text as part of a link.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for byte in text.bytes() {
        write!(escaped, "%{byte:02X}").unwrap();
    }
    escaped
}

/// A room with 64 balls, which lie in cells.
fn many_balls() -> String {
    let mut text = String::from("Scene(surfaces: [Surface(shape: Room(size: (40, 10, 40))),\n");
    for ball in 0..64 {
        let (x, z) = (ball % 8 * 4 - 14, ball / 8 * 4 - 14);
        writeln!(
            text,
            "Surface(shape: Sphere(radius: 0.9), position: ({x}, 0, {z})),"
        )
        .unwrap();
    }
    text += "], source: Source(position: (0, 1, 0.5)), listener: Listener(position: (8, 0.5, 8), radius: 1))";
    text
}

/// Protects the waves: in a browser the same scenes give the program's counts, but for rounding.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_counts_what_the_program_counts() {
    let stage = Stage::new();
    let browser = stage.open();
    let file = stage.folder.path().join("balls.ron");
    std::fs::write(&file, many_balls()).unwrap();
    let balls = format!("scene=corner&text={}", escaped(&many_balls()));
    let cases = [
        ("corner", "scene=corner"),
        ("obstacles", "scene=obstacles"),
        (argument(&file), &balls),
        ("cave", "scene=cave"),
    ];
    for (scene, link) in cases {
        stage.load(
            &browser,
            &format!("#{link}&profile=hybrid&waves=65536&iterations=8"),
        );
        let (page, program) = (counts_of_page(&browser), counts_of_program(scene));
        println!("{scene}: page {page:?}, program {program:?}");
        assert_eq!(page.iter().sum::<u64>(), 65_536);
        for (page, program) in page.iter().zip(&program) {
            assert!(
                page.abs_diff(*program) <= MAY_DIFFER,
                "{scene}: {page:?}, {program:?}"
            );
        }
        assert!(page[0] > 0, "{scene}: nothing is heard");
    }
    let seconds = browser.run("return Array.from(echomarch.page.frame())[6]");
    let renderer = browser.run("return echomarch.page.renderer()");
    println!("{renderer}: {seconds} ms until a frame is heard");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Decibels of either channel of what the page plays, recorded by its own audio graph for a second.
const RECORD: &str = "
    const { context, output } = echomarch.sound();
    if (!window.recorders) {
        const splitter = context.createChannelSplitter(2);
        output.connect(splitter);
        window.recorders = [0, 1].map((channel) => {
            const analyser = new AnalyserNode(context, { fftSize: 32768 });
            splitter.connect(analyser, channel);
            return analyser;
        });
        window.since = context.currentTime;
    }
    if (context.currentTime - window.since < arguments_seconds) return null;
    return window.recorders.map((recorder) => {
        const samples = new Float32Array(recorder.fftSize);
        recorder.getFloatTimeDomainData(samples);
        return 10 * Math.log10(samples.reduce((sum, s) => sum + s * s, 0) / samples.length + 1e-12);
    });";

/// Records for so many seconds from now on, and gives the levels at their end.
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

/// Protects ears: what is played comes from the side where the source is, in full and as the balance alone, and
/// changes when the listener turns round.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_page_plays_the_source_where_it_is() {
    /// Decibels between the channels at the least: a source at the side is panned by 10 dB and more.
    const LOUDER_DB: f64 = 6.0;
    let stage = Stage::new();
    let browser = stage.open();
    for listen in ["full", "balance"] {
        // The source is 6 m to the right of a listener that looks along -z.
        let link = format!(
            "#scene=open-field&waves=16384&listen={listen}&sound=noise&listener=0,0,0,0,0&source=6,0,-1"
        );
        stage.load(&browser, &link);
        browser.click("#play");
        wait(
            &browser,
            "return echomarch.sound() != null && echomarch.levels()[1] > -60",
        );
        let [left, right] = levels(&browser, 2.0);
        println!("{listen}, source at the right: {left:.1} dB, {right:.1} dB");
        assert!(right > left + LOUDER_DB, "{listen}: {left}, {right}");
        browser.run("echomarch.page.stand(0, 0, 0, Math.PI, 0); return 0");
        wait(
            &browser,
            "const [l, r] = echomarch.levels(); return l > r + 3",
        );
        let [left, right] = levels(&browser, 2.0);
        println!("{listen}, source at the left: {left:.1} dB, {right:.1} dB");
        assert!(left > right + LOUDER_DB, "{listen}: {left}, {right}");
    }
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects walking and links: a key moves the listener, the link says where to, and a page that is loaded with
/// that link stands there with the same choices.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn keys_walk_and_a_link_leads_back() {
    let stage = Stage::new();
    let browser = stage.open();
    stage.load(
        &browser,
        "#scene=corner&profile=march&waves=8192&iterations=5&listen=balance&sound=sine:220&volume=0.25",
    );
    let z = |browser: &Browser| {
        browser
            .run("return echomarch.page.listener()[2]")
            .as_f64()
            .unwrap()
    };
    let before = z(&browser);
    browser.click("h1");
    browser.hold("w", Duration::from_millis(1500));
    wait(
        &browser,
        "return Math.abs(echomarch.page.listener()[2] - 8) > 0.2",
    );
    assert!(z(&browser) < before, "forward is along -z");
    wait(&browser, "return location.hash === echomarch.address()");
    let link = browser
        .run("return location.hash")
        .as_str()
        .unwrap()
        .to_owned();
    let there = z(&browser);
    stage.load(&browser, &link);
    assert!(
        (z(&browser) - there).abs() < 0.002,
        "{} {there}",
        z(&browser)
    );
    let chosen = browser.run(
        "return ['scene', 'profile', 'waves', 'iterations', 'listen', 'sound', 'volume']\
         .map((id) => document.getElementById(id).value).join()",
    );
    assert_eq!(chosen, "corner,march,8192,5,balance,sine:220,0.25");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects whoever edits: a text that is no scene says why with its line, and the last good scene goes on.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_bad_text_is_told_and_the_scene_goes_on() {
    let stage = Stage::new();
    let browser = stage.open();
    stage.load(&browser, "#scene=corner&waves=8192");
    let before = counts_of_page(&browser);
    let write = |text: &str| {
        let script = format!(
            "const area = document.getElementById('text'); area.value = {}; \
             area.dispatchEvent(new Event('input')); return 0",
            Value::from(text)
        );
        browser.run(&script);
    };
    write("Scene(\n  surfaces: [Surface(shape: Spere(radius: 1))],\n)");
    browser.wait_for("#error", "2:");
    let error = browser.text("#error");
    assert!(error.contains("did you mean Sphere?"), "{error}");
    assert_eq!(counts_of_page(&browser), before);
    let of = |shape: &str| {
        format!(
            "Scene(surfaces: [Surface(shape: {shape}, position: (0, -2, 0))],\n\
             source: Source(position: (0, 0, -5)),\n\
             listener: Listener(position: (0, 0, 3), radius: 1))"
        )
    };
    write(&of("HeightField(image: \"hill.png\", size: (9, 1, 9))"));
    browser.wait_for("#error", "there are no files in a browser");
    write(&of("Plane"));
    wait(
        &browser,
        "return document.getElementById('error').hidden && echomarch.page.sources()[2] === -5 \
         && echomarch.page.listener()[2] === 3",
    );
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects whoever has no WebGL 2 from an empty page.
#[test]
#[ignore = "scripts/browser-test.sh builds the page first"]
fn a_browser_without_webgl_is_told_so() {
    let stage = Stage::new();
    let folder = stage.folder.path();
    let browser = stage
        .driver
        .open_with(folder, folder, &["--disable-3d-apis"]);
    browser.visit(&stage.address);
    browser.wait_for("#message", "This page needs WebGL 2");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

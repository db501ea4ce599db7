//! A private PulseAudio server without hardware. The monitor of its sink gives the audible output.
#![allow(dead_code)] // Each test file uses only some of these.

pub mod levels;

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// The server's sink: 48 kHz, stereo.
pub const SINK: &str = "probe";

/// Maximum wait before a test fails, longer than any step takes on a slow machine.
pub const TIMEOUT: Duration = Duration::from_secs(300);

/// Waits until `is_so` returns true.
pub fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < TIMEOUT, "waited too long: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A child process, ended on drop.
pub struct Process(pub Child);

impl Drop for Process {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A server in a separate folder.
pub struct Server {
    pub folder: TempDir,
    process: Option<Process>,
}

impl Server {
    pub fn start() -> Self {
        let folder = TempDir::new().unwrap();
        let mut server = Self {
            folder,
            process: None,
        };
        server.restart();
        server
    }

    /// Kills the server without a shutdown.
    pub fn kill(&mut self) {
        self.process = None;
    }

    /// Starts or restarts the server, and waits until it responds.
    pub fn restart(&mut self) {
        self.kill();
        let null_sink = format!(
            "module-null-sink sink_name={SINK} rate=48000 channels=2 format=float32le norewinds=1"
        );
        let mut command = self.command("pulseaudio");
        command
            .args(["-n", "--daemonize=no", "--exit-idle-time=-1"])
            .args(["--use-pid-file=no", "--realtime=no", "--high-priority=no"])
            .args(["-L", "module-native-protocol-unix auth-anonymous=1"])
            .args(["-L", &null_sink])
            .stdout(Stdio::null())
            .stderr(File::create(self.folder.path().join("server.log")).unwrap());
        let child = command
            .spawn()
            .expect("pulseaudio must be installed: scripts/test.sh does it");
        self.process = Some(Process(child));
        wait_for("the server's answer", || {
            self.command("pactl")
                .args(["info"])
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
                .expect("pulseaudio-utils must be installed: scripts/test.sh does it")
                .success()
        });
    }

    /// Sends the server a signal, such as `STOP`.
    pub fn signal(&self, name: &str) {
        let id = self.process.as_ref().unwrap().0.id();
        let status = Command::new("sh")
            .args(["-c", &format!("kill -{name} {id}")])
            .status();
        assert!(status.unwrap().success());
    }

    /// Returns a command whose environment refers only to this server.
    pub fn command(&self, program: impl Into<PathBuf>) -> Command {
        let folder = self.folder.path();
        let mut command = Command::new(program.into());
        command
            .env("XDG_RUNTIME_DIR", folder)
            .env("HOME", folder)
            .env("PULSE_RUNTIME_PATH", folder.join("pulse"))
            .env(
                "PULSE_SERVER",
                format!("unix:{}", folder.join("pulse/native").display()),
            )
            .env_remove("DBUS_SESSION_BUS_ADDRESS")
            .stdin(Stdio::null());
        command
    }

    /// Sends the server a request and returns its answer.
    pub fn pactl(&self, arguments: &[&str]) -> String {
        let output = self.command("pactl").args(arguments).output().unwrap();
        assert!(output.status.success(), "pactl {arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Adds a second sink, `other`: 44.1 kHz, one channel.
    pub fn load_other(&self) {
        self.pactl(&[
            "load-module",
            "module-null-sink",
            "sink_name=other",
            "rate=44100",
            "channels=1",
            "format=s16le",
            "norewinds=1",
            "sink_properties=device.description=Other",
        ]);
    }

    /// Starts to record the output of a sink.
    pub fn record(&self, sink: &str, rate_hz: u32, channels: u32) -> Recorder {
        let path = self.folder.path().join(format!("{sink}.raw"));
        let child = self
            .command("parec")
            .args(["-d", &format!("{sink}.monitor"), "--format=float32le"])
            .args([
                format!("--rate={rate_hz}"),
                format!("--channels={channels}"),
            ])
            .args(["--latency-msec=20", "--raw"])
            .stdout(File::create(&path).unwrap())
            .spawn()
            .unwrap();
        let recorder = Recorder {
            process: Process(child),
            path,
        };
        wait_for("the recorder", || recorder.samples().len() > 4800);
        recorder
    }
}

/// A recording of a sink's monitor.
pub struct Recorder {
    process: Process,
    path: PathBuf,
}

impl Recorder {
    /// Returns all samples recorded until now, interleaved.
    pub fn samples(&self) -> Vec<f32> {
        let bytes = fs::read(&self.path).unwrap();
        let samples = bytes.as_chunks::<4>().0.iter();
        samples.map(|&sample| f32::from_le_bytes(sample)).collect()
    }

    pub fn stop(self) -> Vec<f32> {
        // The last sound has not reached the file yet.
        std::thread::sleep(Duration::from_millis(200));
        let samples = self.samples();
        drop(self.process);
        samples
    }
}

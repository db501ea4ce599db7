//! The script that measures a graphics card, run with few waves on any renderer.

use crate::common::cli::argument;
use std::path::Path;
use std::process::Command;

/// Protects users who run this one command on a graphics card: the report has all parts, the renderer's name, rows of
/// every profile, and a picture beside it.
#[test]
fn the_report_of_a_renderer_has_all_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.md");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/gpu-report.sh");
    let output = Command::new("bash")
        .arg(script)
        .args(["--quick", "--bandwidth", "20", "--arithmetic", "100"])
        .args(["-o", argument(&file)])
        .env("ECHOMARCH", env!("CARGO_BIN_EXE_echomarch"))
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    let report = std::fs::read_to_string(&file).unwrap();
    for part in [
        "# Report of a renderer: ",
        "## Renderers",
        "## Hard cases",
        "## Figures 11.1 to 11.4",
        "## Share of memory bandwidth and arithmetic",
        "bandwidth 20 GB/s, arithmetic 100 G operations/s",
        "march, all in one pass",
        "### Waves",
        "### Iterations",
        "### Surfaces",
    ] {
        assert!(report.contains(part), "no {part:?} in {report}");
    }
    for profile in ["hybrid", "march", "thesis"] {
        assert!(report.contains(&format!("- `{profile}` passes ")));
        assert!(report.contains(&format!("| {profile}, ms |")), "{profile}");
    }
    let picture = std::fs::read_to_string(file.with_extension("svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("time by surfaces"));
}

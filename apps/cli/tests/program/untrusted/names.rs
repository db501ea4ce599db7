//! Names from files in terminals, tables and pages.

use super::{answers, folder_with, refusal, scene};
use crate::common::cli::{run_in, stderr, stdout};

/// Protects terminals from control characters in the names of scenes, surfaces, values, files and answers.
#[test]
fn no_name_reaches_a_terminal_as_it_is() {
    let folder = folder_with("Plane");
    let folder = folder.path();
    let nasty = [
        "\u{1b}[31mred",
        "two\nlines",
        "\u{202e}turned",
        "\u{9b}1m",
        "a\rb",
    ];
    for name in nasty
        .map(str::to_owned)
        .into_iter()
        .chain(["x".repeat(1 << 20)])
    {
        let quoted = name.escape_default().to_string();
        let plain = scene("Plane");
        let named = [
            plain.replacen("Scene(", &format!("Scene(name: \"{quoted}\", "), 1),
            plain.replace("Surface(", &format!("Surface(name: \"{quoted}\", ")),
            scene(&format!("Sphere(radius: Value(\"{quoted}\", 1))")),
            scene(&format!(
                "HeightField(image: \"{quoted}\", size: (1, 1, 1))"
            )),
            scene(&format!(
                "Field(file: \"{quoted}\", lipschitz: 1, size: (1, 1, 1))"
            )),
            scene(&format!("r#\"{name}\"#")),
        ];
        for text in named {
            std::fs::write(folder.join("named.ron"), &text).unwrap();
            let said = refusal(folder, &["trace", "named.ron"]);
            check_shown(&said);
        }
        std::fs::write(folder.join("a.json"), answers(&name, "p")).unwrap();
        check_shown(&refusal(folder, &["localise", "score", "a.json"]));
        let said = serde_json::to_string(&name).unwrap();
        let file = answers("s", "p").replace("\"right\"", &said);
        std::fs::write(folder.join("a.json"), file).unwrap();
        check_shown(&refusal(folder, &["localise", "score", "a.json"]));
    }
    // If a scene has no name, its file name is used.
    std::fs::write(folder.join("\u{1b}[31m\n.ron"), scene("Plane")).unwrap();
    let output = run_in(folder, &["trace", "\u{1b}[31m\n.ron", "--waves", "64"]);
    assert!(output.status.success());
    check_shown(&stdout(&output).replace('\n', ""));
    let output = run_in(
        folder,
        &["trace", "\u{1b}[31m\n.ron", "--waves", "64", "--json"],
    );
    assert!(serde_json::from_slice::<serde_json::Value>(&output.stdout).is_ok());
}

/// Checks that a message is within the limits and contains only visible characters.
fn check_shown(said: &str) {
    assert!(said.chars().count() <= 1000, "{} characters", said.len());
    let hidden = |c: char| c.is_control() || c == '\u{202e}';
    assert!(!said.contains(hidden), "{said:?}");
}

/// Protects readers from error messages that fill the screen.
#[test]
fn messages_of_many_lines_are_cut() {
    let folder = tempfile::tempdir().unwrap();
    let said = serde_json::to_string(&"\n".repeat(50)).unwrap();
    let file = answers("corner", "p").replace("\"right\"", &said);
    std::fs::write(folder.path().join("a.json"), file).unwrap();
    let output = run_in(folder.path(), &["localise", "score", "a.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).lines().count() <= 10, "{}", stderr(&output));
}

/// Protects spreadsheets from names that they would interpret as formulas.
#[test]
fn no_csv_cell_is_a_formula() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["=1+1", "+1", "-1", "@SUM(1)", " =1"] {
        std::fs::write(folder.path().join("a.json"), answers(name, "p")).unwrap();
        let output = run_in(folder.path(), &["localise", "score", "a.json", "-o", "."]);
        assert!(output.status.success(), "{}", stderr(&output));
        let table = std::fs::read_to_string(folder.path().join("score.csv")).unwrap();
        let first_cells = table.lines().map(|line| line.split(',').next().unwrap());
        assert!(
            first_cells.clone().any(|cell| cell == format!("'{name}")),
            "{table}"
        );
    }
}

/// Protects the form from names with a meaning in HTML. An unescaped name could open a script element that never ends.
#[test]
fn a_form_holds_names_as_data() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        scene("Room(size: (30, 20, 30))").replacen("Scene(", "Scene(name: \"<!--<script>&\", ", 1);
    std::fs::write(folder.path().join("y.ron"), text).unwrap();
    let arguments = [
        "localise",
        "form",
        "-o",
        "form",
        "--scenes",
        "y.ron",
        "--sounds",
        "sine:500",
        "--waves",
        "64",
        "--iterations",
        "1",
        "--seconds",
        "0.1",
    ];
    let output = run_in(folder.path(), &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.path().join("form/form.html")).unwrap();
    let begin = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let data = &page[begin..begin + page[begin..].find("</script>").unwrap()];
    assert!(!data.contains(['<', '>', '&']));
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["trials"][0]["stimulus"]["scene"], "<!--<script>&");
}

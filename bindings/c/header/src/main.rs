//! Prints the header of the C interface, for scripts/c-test.sh.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let config = cbindgen::Config::from_file(package.join("cbindgen.toml"))?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in ["call", "values", "handle", "objects", "results", "sound"] {
        builder = builder.with_src(package.join(format!("src/{file}.rs")));
    }
    builder.generate()?.write(std::io::stdout());
    Ok(())
}

//! `bindgen FILE.wasm FOLDER` writes the wasm that a page loads, and the JavaScript that loads it, into a folder.
//!
//! It does what `wasm-bindgen --target web` does. As a member of the workspace it always has the same version as
//! the library that the wasm was built with.

use anyhow::{Context, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder] = &arguments[..] else {
        bail!("usage: bindgen FILE.wasm FOLDER");
    };
    Bindgen::new()
        .input_path(wasm)
        .web(true)?
        .omit_default_module_path(false)
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
        .with_context(|| format!("{wasm} is not made into JavaScript"))
}

//! `bindgen FILE.wasm FOLDER` writes the WebAssembly module for the page, and the JavaScript that loads it, into a
//! folder.
//!
//! The program does the same as `wasm-bindgen --target web`. As a member of the workspace, it always has the same
//! version as the `wasm-bindgen` crate that the module was built with.

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
        .with_context(|| format!("cannot generate JavaScript for {wasm}"))
}

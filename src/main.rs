//! The program `echomarch`; everything it does stands in the library.

fn main() -> std::process::ExitCode {
    echomarch::cli::run()
}

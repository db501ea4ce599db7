//! The program `echomarch`; all its code is in the library.

fn main() -> std::process::ExitCode {
    echomarch::cli::run()
}

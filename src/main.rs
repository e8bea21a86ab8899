//! The `render` command. Everything happens in [`zeroset::cli`].

fn main() -> std::process::ExitCode {
    zeroset::cli::run()
}

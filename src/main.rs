use std::process::ExitCode;

fn main() -> ExitCode {
    wildfire::cli::main()
}

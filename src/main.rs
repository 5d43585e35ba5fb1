//! The program `steradian`: a thin front end of the library.

mod cli;
#[cfg(feature = "viewer")]
mod viewer;

use std::panic::PanicHookInfo;
use std::process::ExitCode;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(report_defect));
    match std::panic::catch_unwind(|| cli::run(&cli::parse()?)) {
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            cli::talk::line(&format!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
        // The hook has said it.
        Err(_) => ExitCode::FAILURE,
    }
}

/// A panic is a defect of this program; a user gets one line about it.
fn report_defect(panic: &PanicHookInfo) {
    let message = panic.payload_as_str().unwrap_or("no message");
    let place = panic.location().map(|l| format!(" at {l}")).unwrap_or_default();
    cli::talk::line(&format!("error: a defect of Steradian{place}, please report it: {message}"));
}

//! The command line: one file per subcommand. Results go to stdout, everything else to stderr.
//!
//! Exit codes: 0 done; 1 a check that the user asked for failed; 2 bad input or environment; 101 a bug in pathspace.

pub mod arguments;
pub mod bench;
pub mod bench_compare;
pub mod budget;
pub mod devices;
pub mod diff;
pub mod inspect;
pub mod output;
pub mod progress;
pub mod render;
pub mod report;

use anyhow::Context;
use clap::Parser;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// How a subcommand ended that met no error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    Done,
    /// A check that the user asked for did not hold; exit code 1.
    CheckFailed,
}

#[derive(Parser)]
#[command(version, about, propagate_version = true)]
struct Cli {
    /// Say more on stderr: -v what is being done, -vv details, -vvv everything
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Only errors on stderr: no warnings, no progress bar
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Render(Box<render::Args>),
    Inspect(inspect::Args),
    Devices(devices::Args),
    Diff(diff::Args),
    Bench(bench::Args),
    Report(report::Args),
    BenchCompare(bench_compare::Args),
}

impl Command {
    fn run(&self) -> anyhow::Result<Outcome> {
        match self {
            Command::Render(args) => render::run(args),
            Command::Inspect(args) => inspect::run(args),
            Command::Devices(args) => devices::run(args),
            Command::Diff(args) => diff::run(args),
            Command::Bench(args) => bench::run(args),
            Command::Report(args) => report::run(args),
            Command::BenchCompare(args) => bench_compare::run(args),
        }
    }
}

/// The whole program.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // Help and version come this way too, with exit code 0. A closed pipe leaves nobody to tell.
        Err(error) => {
            error.print().ok();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    report_panics();
    // Unwinding, rather than exiting from the hook, removes temporary files on the way.
    match std::panic::catch_unwind(|| run(&cli)) {
        Ok(Ok(Outcome::Done)) => ExitCode::SUCCESS,
        Ok(Ok(Outcome::CheckFailed)) => ExitCode::from(1),
        Ok(Err(error)) => {
            writeln!(std::io::stderr(), "{}", describe(&error)).ok();
            ExitCode::from(2)
        }
        Err(_) => ExitCode::from(101),
    }
}

fn run(cli: &Cli) -> anyhow::Result<Outcome> {
    start_log(cli)?;
    if cli.quiet {
        progress::hide();
    }
    cli.command.run()
}

/// `PATHSPACE_LOG` (tracing's filter syntax, such as `pathspace::gpu=debug`) goes before `-v` and `-q`.
fn start_log(cli: &Cli) -> anyhow::Result<()> {
    let level = match (cli.quiet, cli.verbose) {
        (true, _) => "error",
        (_, 0) => "warn",
        (_, 1) => "info",
        (_, 2) => "debug",
        _ => "trace",
    };
    let filter = match std::env::var("PATHSPACE_LOG") {
        Ok(directives) => EnvFilter::try_new(&directives).with_context(|| format!("PATHSPACE_LOG='{directives}' is not a log filter"))?,
        Err(_) => EnvFilter::new(level),
    };
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(|| progress::BarAwareStderr)
        .with_ansi(std::io::stderr().is_terminal())
        .without_time()
        .with_target(false)
        .init();
    Ok(())
}

/// One message, and each cause that it does not already name.
fn describe(error: &anyhow::Error) -> String {
    let mut text = format!("error: {error}");
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text += &format!("\n  because: {cause}");
        }
    }
    text
}

fn report_panics() {
    std::panic::set_hook(Box::new(|info| {
        writeln!(
            std::io::stderr(),
            "pathspace {}: {info}\nThis is a bug: please report it with the command line.",
            env!("CARGO_PKG_VERSION")
        )
        .ok();
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn each_cause_of_an_error_is_named_once() {
        let error = anyhow!("disk full").context("cannot write 'a.png': disk full").context("render failed");
        assert_eq!(describe(&error), "error: render failed\n  because: cannot write 'a.png': disk full");
    }
}

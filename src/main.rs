//! The `gsm` command.

use clap::Parser;
use gsm::cli::{Cli, Command};
use gsm::commands::session::{self, Exit, Session};
use gsm::commands::{build, check, convert, mesh, new, usage};
use gsm::diag::Diagnostic;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;
use std::sync::OnceLock;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The fault behind the first panic: only the hook knows its place, and only the end of the run may write to standard output.
static BROKEN: OnceLock<Diagnostic> = OnceLock::new();

fn main() -> ExitCode {
    let cli = match Cli::try_parse().and_then(Cli::checked) {
        Ok(cli) => cli,
        Err(e) => {
            // Where the output is closed, nobody wants to know.
            drop(refuse(&e));
            return ExitCode::from(u8::try_from(e.exit_code()).unwrap_or(Exit::Usage as u8));
        }
    };
    let is_json = wants_json();
    panic::set_hook(Box::new(move |info| {
        let fault = BROKEN.get_or_init(|| internal(&info.to_string()));
        if !is_json {
            complain(&format!("internal error: {}\n{}", fault.message, fault.hints.join("\n")));
        }
    }));
    let outcome = panic::catch_unwind(AssertUnwindSafe(|| run(&cli)));
    let exit = match outcome {
        Ok(Ok(exit)) => exit,
        Ok(Err(e)) if e.kind() == ErrorKind::BrokenPipe => Exit::Good,
        Ok(Err(e)) => {
            complain(&format!("cannot write to standard output: {e}"));
            Exit::Wrong
        }
        Err(_) => {
            if let (true, Some(fault)) = (is_json, BROKEN.get()) {
                drop(tell(cli.command.file(), fault));
            }
            Exit::Internal
        }
    };
    ExitCode::from(exit as u8)
}

/// Whether the arguments ask for JSON, also those that are not understood.
fn wants_json() -> bool {
    std::env::args_os().take_while(|a| a != "--").any(|a| a == "--json")
}

/// Tells what is wrong with the arguments: as JSON if that was asked for. Help and version are no errors, and text.
fn refuse(error: &clap::Error) -> io::Result<()> {
    if wants_json() && error.use_stderr() { tell(None, &usage::fault(error)) } else { error.print() }
}

/// Tells scripts of the one fault that ended the run.
fn tell(file: Option<&Path>, fault: &Diagnostic) -> io::Result<()> {
    session::json(&mut io::stdout().lock(), file, std::slice::from_ref(fault), &serde_json::Map::new())
}

/// Tells people of it; where standard error cannot be written, nobody is left to tell.
fn complain(what: &str) {
    drop(writeln!(io::stderr(), "gsm: {what}"));
}

fn run(cli: &Cli) -> io::Result<Exit> {
    let mut out = BufWriter::new(io::stdout().lock());
    let exit = match &cli.command {
        Command::Build(args) => build::run(args, &mut Session::new(&mut out, &args.common)),
        Command::Check(args) => check::run(args, &mut Session::new(&mut out, &args.common)),
        Command::Mesh(args) => mesh::run(args, &mut Session::new(&mut out, &args.common)),
        Command::Convert(args) => convert::run(args, &mut Session::new(&mut out, &args.common)),
        Command::New(args) => new::run(args, &mut Session::new(&mut out, &args.common)),
    }?;
    out.flush()?;
    Ok(exit)
}

/// A panic as a fault: what it says, with its place, and what a report of it needs.
fn internal(what: &str) -> Diagnostic {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    let version = env!("CARGO_PKG_VERSION");
    Diagnostic::internal("panic", what)
        .hint(format!("please report this with the scene, gsm {version} and the arguments {arguments:?}"))
}

//! The `gsm` command.

use clap::Parser;
use gsm::cli::{Cli, Command};
use gsm::commands::session::{self, Exit, Session};
use gsm::commands::{build, check, convert, mesh, new, usage};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let cli = match Cli::try_parse().and_then(Cli::checked) {
        Ok(cli) => cli,
        Err(e) => {
            // Where the output is closed, nobody wants to know.
            drop(refuse(&e));
            return ExitCode::from(u8::try_from(e.exit_code()).unwrap_or(Exit::Usage as u8));
        }
    };
    panic::set_hook(Box::new(|info| eprintln!("{}", report_panic(info))));
    let outcome = panic::catch_unwind(AssertUnwindSafe(|| run(&cli)));
    let exit = match outcome {
        Ok(Ok(exit)) => exit,
        Ok(Err(e)) if e.kind() == ErrorKind::BrokenPipe => Exit::Good,
        Ok(Err(e)) => {
            eprintln!("gsm: cannot write to standard output: {e}");
            Exit::Wrong
        }
        Err(_) => Exit::Internal,
    };
    ExitCode::from(exit as u8)
}

/// Tells what is wrong with the arguments: as JSON if that was asked for. Help and version are no errors, and text.
fn refuse(error: &clap::Error) -> io::Result<()> {
    let is_json = std::env::args_os().take_while(|a| a != "--").any(|a| a == "--json");
    if !(is_json && error.use_stderr()) {
        return error.print();
    }
    session::json(&mut io::stdout().lock(), None, &[usage::fault(error)], &serde_json::Map::new())
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

fn report_panic(info: &panic::PanicHookInfo) -> String {
    format!(
        "gsm: internal error: {info}\nnothing was written; please report this with the scene, gsm {} and the arguments {:?}",
        env!("CARGO_PKG_VERSION"),
        std::env::args().skip(1).collect::<Vec<_>>()
    )
}

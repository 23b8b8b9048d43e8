//! The `gsm` command.

fn main() {}

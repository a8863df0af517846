//! Runs the program, as a user or a script does.

use std::io::Write;
use std::process::{Command, Output, Stdio};

pub fn tubecert(words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tubecert"));
    command.args(words).current_dir(env!("CARGO_MANIFEST_DIR")).stdin(Stdio::null());
    command
}

pub fn fed(words: &[&str], input: &[u8]) -> Output {
    let mut child =
        tubecert(words).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    std::thread::scope(|scope| {
        // a program that refuses its arguments reads nothing
        scope.spawn(move || drop(stdin.write_all(input)));
        child.wait_with_output().unwrap()
    })
}

pub fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code, no signal")
}

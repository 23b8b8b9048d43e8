//! The same scene gives the same bytes, for any number of threads and any number of runs.

mod support;

use std::fs;
use support::{SCENES, build, folder, label, scene};

#[test]
fn one_and_two_threads_and_two_runs_write_the_same_bytes() {
    let folder = folder("determinism");
    for (name, arguments) in SCENES {
        let written = ["1", "2", "2"].map(|threads| {
            build(&scene(name), &[arguments, &["--threads", threads]].concat(), &folder);
            ["poly", "gsm.json"].map(|extension| fs::read(folder.join(format!("{name}.{extension}"))).unwrap())
        });
        assert!(written[0] == written[1], "{}: one thread and two differ", label(name, arguments));
        assert!(written[1] == written[2], "{}: two runs differ", label(name, arguments));
    }
}

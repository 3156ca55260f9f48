//! Ctrl-C while a picture is drawn.
#![cfg(target_os = "linux")]

use crate::place::Place;
use std::process::{Child, Command};
use std::time::Duration;

/// Takes minutes.
const SLOW: [&str; 11] = [
    "render",
    "-e",
    "x^2 + y^2 + z^2 - 1",
    "-o",
    "ball.png",
    "--stats",
    "ball.json",
    "--size=2048x2048",
    "--method=sampled",
    "--step=0.0001",
    "--threads=1",
];

/// Waits until the program listens to SIGINT, which the system shows as a bit of a mask.
fn wait_until_it_listens(child: &Child) {
    let path = format!("/proc/{}/status", child.id());
    loop {
        let status = std::fs::read_to_string(&path).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        if u64::from_str_radix(caught.trim(), 16).unwrap() & 2 != 0 {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn press_ctrl_c(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

#[test]
fn an_interrupt_leaves_nothing_behind() {
    let place = Place::new();
    let child = place.start(&SLOW);
    wait_until_it_listens(&child);
    // Into the work.
    std::thread::sleep(Duration::from_millis(300));
    press_ctrl_c(&child);
    let output = child.wait_with_output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), errors.as_str()), (Some(130), "interrupted: nothing was written\n"));
    assert!(output.stdout.is_empty());
    assert_eq!(place.files(), Vec::<String>::new());
}

#[test]
fn an_interrupt_keeps_what_was_there() {
    let place = Place::new();
    place.file("ball.png", "old");
    let child = place.start(&SLOW);
    wait_until_it_listens(&child);
    press_ctrl_c(&child);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(place.files(), ["ball.png"]);
    assert_eq!(std::fs::read_to_string(place.path("ball.png")).unwrap(), "old");
}

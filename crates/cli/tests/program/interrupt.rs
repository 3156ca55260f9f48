//! Ctrl-C while a picture is drawn, and the bar that shows how far it is.
#![cfg(target_os = "linux")]

use crate::place::Place;
use nix::pty::{Winsize, openpty};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs::File;
use std::io::Read;
use std::process::Child;
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

/// Waits until the program has worked for so long, in hundredths of a second, that it must be drawing.
fn wait_until_it_draws(child: &Child) {
    wait_until_it_listens(child);
    loop {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
        // The 14th field is the time in the program; the second, in parentheses, is its name.
        let (_, rest) = stat.rsplit_once(')').unwrap();
        if rest.split_whitespace().nth(11).unwrap().parse::<u32>().unwrap() >= 30 {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn press_ctrl_c(child: &Child) {
    kill(Pid::from_raw(child.id().try_into().unwrap()), Signal::SIGINT).unwrap();
}

#[test]
fn an_interrupt_leaves_nothing_behind() {
    let place = Place::new();
    let child = place.command(&SLOW).spawn().unwrap();
    wait_until_it_draws(&child);
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
    let child = place.command(&SLOW).spawn().unwrap();
    wait_until_it_listens(&child);
    press_ctrl_c(&child);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(place.files(), ["ball.png"]);
    assert_eq!(std::fs::read_to_string(place.path("ball.png")).unwrap(), "old");
}

/// Starts the program with a terminal for its errors, which can be read from the other end.
fn start_on_a_terminal(place: &Place, arguments: &[&str]) -> (Child, File) {
    let size = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
    let terminal = openpty(&size, None).unwrap();
    // The command is dropped here, and the program's end of the terminal with it.
    let child = place.command(arguments).stderr(terminal.slave).spawn().unwrap();
    (child, File::from(terminal.master))
}

/// What appears on a terminal until it holds a text, or until the program ends.
fn read_until(terminal: &mut File, text: &str) -> String {
    let (mut shown, mut bytes) = (String::new(), [0; 4096]);
    while !shown.contains(text) {
        // The end of the program is an error here.
        let Ok(count @ 1..) = terminal.read(&mut bytes) else { break };
        shown.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    shown
}

#[test]
fn a_bar_on_a_terminal_shows_the_time_left_and_goes_away() {
    let place = Place::new();
    let (mut child, mut terminal) = start_on_a_terminal(&place, &SLOW);
    let shown = read_until(&mut terminal, " left");
    assert!(shown.contains(" %, "), "{shown:?}");
    press_ctrl_c(&child);
    let after = read_until(&mut terminal, "written");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    // The line is erased before the message.
    assert!(after.contains("\u{1b}[2Kinterrupted: nothing was written"), "{after:?}");
}

#[test]
fn a_quiet_program_shows_no_bar() {
    let place = Place::new();
    let (mut child, mut terminal) = start_on_a_terminal(&place, &[SLOW.as_slice(), &["--quiet"]].concat());
    wait_until_it_draws(&child);
    // Longer than it takes for the bar to appear.
    std::thread::sleep(Duration::from_millis(500));
    press_ctrl_c(&child);
    let shown = read_until(&mut terminal, "written");
    assert!(shown.contains("interrupted") && !shown.contains('%'), "{shown:?}");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_second_interrupt_ends_what_does_not_stop() {
    let place = Place::new();
    // One value of this takes minutes.
    let endless = "my_model(x[3], a[1]) { r = x[1]; while r*r >= 0 loop r = r + 1; endloop; my_model = r; }";
    place.file("endless.hf", endless);
    let fuel = ["render", "endless.hf", "-o", "a.png", "--bounds=-1,-1,-1,1,1,1", "--fuel=4000000000"];
    let (mut child, mut terminal) = start_on_a_terminal(&place, &fuel);
    wait_until_it_draws(&child);
    press_ctrl_c(&child);
    assert!(read_until(&mut terminal, "again").contains("press Ctrl-C again"));
    press_ctrl_c(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.files(), ["endless.hf"]);
}

//! `fieldstone bench` as a program. What it measures is not tested here, only that it is measured and told.

use crate::place::Place;
use serde_json::Value;

const SMALL: [&str; 8] = ["bench", "models", "--size", "16", "--runs", "2", "--threads", "1"];

#[test]
fn a_report_has_tables_and_numbers() {
    let place = Place::new();
    let more = ["--only", "gear", "--view", "parallel", "-o", "report.json", "-o", "report.md"];
    let run = place.run(&[SMALL.as_slice(), &more].concat(), "");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("| gear | 209 | parallel | 16² | 1 |"), "{}", run.out);
    let read = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    assert_eq!(read("report.md"), run.out);
    let report: Value = serde_json::from_str(&read("report.json")).unwrap();
    let row = &report["models"][0];
    assert_eq!((&row["model"], &row["runs"]), (&Value::from("gear"), &Value::from(2)));
    assert!(row["ours"]["seconds"]["median"].as_f64().unwrap() > 0.0 && row["certified"] == 1.0, "{row}");
    // Either the peer was measured, or it is said why not.
    let peers = row["peers"].as_array().unwrap().len();
    let told = run.out.contains("Not measured: fidget: build with `--features peers`");
    assert_eq!((peers == 2, told), (row["ratio"].is_object(), peers == 0));
}

#[test]
fn a_shape_of_the_plane_is_measured() {
    let mut arguments = [SMALL.as_slice(), &["--only", "page"]].concat();
    arguments[3] = "128";
    let run = Place::new().run(&arguments, "");
    assert!(run.code == 0 && run.out.contains("| page | 11554 | plane | 128² |"), "{}{}", run.out, run.err);
}

#[test]
fn a_job_tells_what_it_found() {
    let run = Place::new().run(&["bench", "--worker", "setup:tangle"], "");
    assert_eq!(run.code, 0, "{}", run.err);
    let work: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(work["Frames"]["certified"], 0);
}

#[test]
fn what_cannot_be_measured_is_told() {
    let place = Place::new();
    let wrong = [
        (
            &["bench", "models", "--only", "cathedral"][..],
            2,
            "there is no model `cathedral`; there are tangle, ",
        ),
        (&["bench", "models", "-o", "report.txt"], 2, "report.txt: a report is written to .json or .md"),
        (
            &["bench", "gallery"],
            1,
            "gallery/table1: No such file or directory; run it in the folder of the sources",
        ),
        (&["bench", "models", "-o", "no/report.md"], 1, "no/report.md"),
        (&["bench", "--worker", "dance"], 2, "there is no job `dance`"),
        (&["bench", "--size", "8"], 2, "16..=4096"),
    ];
    for (arguments, code, message) in wrong {
        let run = place.run(arguments, "");
        assert!(run.code == code && run.err.contains(message), "{arguments:?}: {} {}", run.code, run.err);
    }
    assert_eq!(place.files(), [""; 0]);
}

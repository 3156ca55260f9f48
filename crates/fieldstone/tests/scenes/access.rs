//! What a scene may read.

use fieldstone::{Document, FileAccess, SceneRequest};
use std::fs;
use std::path::Path;

fn outcome(folder: &Path, file: &str, access: &FileAccess) -> Result<(), String> {
    let scene = folder.join("scene.toml");
    fs::write(&scene, format!("[solids.a]\nfile = {file:?}\n")).unwrap();
    let document = Document::load(&scene, access).map_err(|error| error.to_string())?;
    document.resolve(&SceneRequest::default()).map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn scenes_read_their_folder_and_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    fs::create_dir_all(inside.join("models")).unwrap();
    fs::create_dir(folder.path().join("other")).unwrap();
    let ball = "x^2 + y^2 + z^2 - 1";
    for place in ["inside/models/ball.txt", "inside/ball.txt", "other/ball.txt", "ball.txt"] {
        fs::write(folder.path().join(place), ball).unwrap();
    }
    let closed = FileAccess::default();
    for fine in ["ball.txt", "models/ball.txt", "models/../ball.txt"] {
        assert_eq!(outcome(&inside, fine, &closed), Ok(()), "{fine}");
    }
    let absolute = folder.path().join("ball.txt").display().to_string();
    for outside in ["../ball.txt", "../other/ball.txt", absolute.as_str(), "../no/such.txt"] {
        let error = outcome(&inside, outside, &closed).unwrap_err();
        assert!(error.contains("lies outside of the folder") && error.contains("--allow-read"), "{error}");
    }
    assert!(outcome(&inside, "no.txt", &closed).unwrap_err().contains("there is no file"));
    let other = FileAccess { folders: vec![folder.path().join("other")], outside: false };
    assert_eq!(outcome(&inside, "../other/ball.txt", &other), Ok(()));
    assert!(outcome(&inside, "../ball.txt", &other).is_err());
    let open = FileAccess { outside: true, ..FileAccess::default() };
    assert_eq!(outcome(&inside, "../ball.txt", &open), Ok(()));
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_are_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.path().join("ball.txt"), "x^2 + y^2 + z^2 - 1").unwrap();
    fs::write(inside.join("own.txt"), "x^2 + y^2 + z^2 - 1").unwrap();
    std::os::unix::fs::symlink("../ball.txt", inside.join("out.txt")).unwrap();
    std::os::unix::fs::symlink("own.txt", inside.join("in.txt")).unwrap();
    let closed = FileAccess::default();
    assert!(outcome(&inside, "out.txt", &closed).unwrap_err().contains("lies outside"));
    assert_eq!(outcome(&inside, "in.txt", &closed), Ok(()));
}

#[test]
fn faults_of_models_are_shown_in_their_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.txt"), "x +\n y ) 1").unwrap();
    let error = outcome(folder.path(), "bad.txt", &FileAccess::default()).unwrap_err();
    assert!(error.contains("bad.txt:2:4"), "{error}");
}

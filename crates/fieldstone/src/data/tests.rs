use super::*;
use fieldstone_field::Function;
use fieldstone_solids::{Interpolation, Reconstruction};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;

fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// x + 10 y + 100 z on a grid of 3 × 2 × 2.
fn numbers() -> Vec<f64> {
    (0..12).map(|i| f64::from(i % 3 + 10 * (i / 3 % 2) + 100 * (i / 6))).collect()
}

const PLACE: Placement = Placement { place: Some([[0.0; 3], [2.0, 1.0, 1.0]]) };

fn holds_the_numbers(array: &VoxelArray) {
    for (p, value) in [([0.0; 3], 0.0), ([2.0, 1.0, 1.0], 112.0), ([1.5, 0.0, 0.5], 51.5)] {
        assert!((array.value(&p) - value).abs() < 1e-9, "{p:?}");
    }
}

fn nrrd(path: &Path) -> Result<VoxelArray, DataError> {
    load_voxels(path, None, &PLACE, Interpolation::Linear)
}

fn message<T>(result: Result<T, DataError>) -> String {
    result.err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn raw_numbers_of_every_type_and_order() {
    for (_, number) in NumberType::NAMES {
        for big_endian in [false, true] {
            let mut bytes = vec![0xAA; 3];
            for value in numbers() {
                let mut one = match number {
                    NumberType::U8 | NumberType::I8 => vec![value as u8],
                    NumberType::U16 | NumberType::I16 => (value as u16).to_le_bytes().to_vec(),
                    NumberType::U32 | NumberType::I32 => (value as u32).to_le_bytes().to_vec(),
                    NumberType::F32 => (value as f32).to_le_bytes().to_vec(),
                    NumberType::F64 => value.to_le_bytes().to_vec(),
                };
                if big_endian {
                    one.reverse();
                }
                bytes.extend(one);
            }
            let (_folder, path) = file("a.raw", &bytes);
            let layout = RawLayout { counts: [3, 2, 2], number, big_endian, skip: 3 };
            holds_the_numbers(&load_voxels(&path, Some(&layout), &PLACE, Interpolation::Linear).unwrap());
            let long = RawLayout { counts: [3, 2, 3], ..layout };
            let short = message(load_raw(&path, &long, &PLACE, Interpolation::Linear));
            assert!(short.contains("is the size or the type another?"), "{short}");
        }
    }
}

#[test]
fn nrrd_with_its_numbers_raw_packed_and_beside_it() {
    let data: Vec<u8> = numbers().iter().flat_map(|v| (*v as i16).to_be_bytes()).collect();
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(&data).unwrap();
    let packed = packer.finish().unwrap();
    let header = |encoding: &str, more: &str| {
        format!(
            "NRRD0004\n# a comment\ntype: short\ndimension: 3\nsizes: 3 2 2\nkey:=value\nendian: big\nencoding: {encoding}\n{more}\n"
        )
        .into_bytes()
    };
    for (encoding, data) in [("raw", &data), ("gzip", &packed)] {
        let (_folder, path) = file("a.nrrd", &[header(encoding, ""), data.clone()].concat());
        holds_the_numbers(&nrrd(&path).unwrap());
        let (folder, path) = file("a.nhdr", &header(encoding, "data file: ./numbers.bin\n"));
        std::fs::write(folder.path().join("numbers.bin"), data).unwrap();
        holds_the_numbers(&nrrd(&path).unwrap());
    }
    // Steps of the file: 1, 1 and 4, so that z is the longest side.
    let text = [header("raw", "space directions: (0,1,0) (1,0,0) (0,0,4)\n"), data].concat();
    let (_folder, path) = file("a.nrrd", &text);
    let array = load_voxels(&path, None, &Placement::default(), Interpolation::Linear).unwrap();
    assert_eq!(array.bounds(), [[-0.5, -0.25, -1.0], [0.5, 0.25, 1.0]]);
}

#[test]
fn headers_with_mistakes_say_where() {
    let refuse = |text: &str| {
        let (_folder, path) = file("a.nrrd", text.as_bytes());
        message(nrrd(&path)).rsplit('/').next().unwrap_or_default().to_owned()
    };
    assert_eq!(refuse("PNG"), "a.nrrd:1: an NRRD file begins with NRRD0004 or the like");
    assert_eq!(refuse("NRRD0004\nsizes: 3 2\n"), "a.nrrd:2: `sizes` are three whole numbers");
    let four = refuse("NRRD0004\ndimension: 4\n");
    assert_eq!(four, "a.nrrd:2: an array of three dimensions is needed, not of 4");
    assert_eq!(refuse("NRRD0004\nsizes: 2 2 2\n\n"), "a.nrrd: the header has no `type`");
    let text = refuse("NRRD0004\nencoding: text\n");
    assert_eq!(text, "a.nrrd:2: the encoding `text` is not read: write it as `raw` or `gzip`");
    for name in ["../secret", "sub/data.raw", "LIST", "slice%d.raw", "."] {
        let (_folder, path) = file("a.nrrd", format!("NRRD0004\ndata file: {name}\n").as_bytes());
        let message = message(nrrd(&path));
        assert!(message.ends_with("names one file in the folder of the header"), "{message}");
    }
    let huge = refuse("NRRD0004\ntype: double\nsizes: 99999999999 99999999999 2\n\n");
    assert!(huge.contains("at most 67108864 in all"), "{huge}");
}

#[test]
fn packed_numbers_that_are_none_are_errors() {
    let (_folder, path) = file("a.nrrd", b"NRRD0004\ntype: float\nsizes: 2 2 2\nencoding: gzip\n\nnot gzip");
    assert!(message(nrrd(&path)).starts_with("cannot read"));
}

#[test]
fn tables_of_points_with_any_separator() {
    for (separator, names) in
        [(",", "x,y,z,nx,ny,nz\n"), (";", ""), ("\t", ""), (" ", "# points\n"), ("  ", "")]
    {
        let line = ["1", "2.5", "-3e-1", "0", "0", "1"].join(separator);
        let (_folder, path) = file("a.csv", format!("{names}{line}\n{line}\n").as_bytes());
        let cloud = load_points(&path).unwrap();
        assert_eq!(
            (cloud.points.clone(), cloud.normals.len()),
            (vec![[1.0, 2.5, -0.3]; 2], 2),
            "{separator:?}"
        );
    }
    let refuse = |text: &str| {
        let (_folder, path) = file("a.csv", text.as_bytes());
        message(load_points(&path)).rsplit('/').next().unwrap_or_default().to_owned()
    };
    assert_eq!(refuse("1,2,3,0,0,1\n1,2,x,0,0,1\n"), "a.csv:2: here is something else than a number");
    assert_eq!(refuse("1,2\n"), "a.csv:1: a line has six numbers (x, y, z and the normal), or three, not 2");
    let as_above = "a.csv:2: a line has three numbers (x, y, z), as those above, not 6";
    assert_eq!(refuse("1,2,3\n1,2,3,0,0,1\n"), as_above);
    let as_above = "a.csv:2: a line has six numbers (x, y, z and the normal), as those above, not 3";
    assert_eq!(refuse("1,2,3,0,0,1\n1,2,3\n"), as_above);
    assert_eq!(refuse("1,2,3\n"), "a.csv: a solid needs 4 to 50000 points, not 1");
}

#[test]
fn points_without_normals_get_some() {
    let corners = "0 0 0\n2 0 0\n0 2 0\n0 0 2\n2 2 0\n2 0 2\n0 2 2\n2 2 2\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (name, text) in [("a.txt", corners.to_owned()), ("a.ply", ply.to_owned() + corners)] {
        let (_folder, path) = file(name, text.as_bytes());
        let cloud = load_points(&path).unwrap();
        assert_eq!((cloud.points.len(), cloud.normals.len()), (8, 8), "{name}");
    }
}

fn ply_header(format: &str, count: usize) -> String {
    let properties =
        ["x", "y", "z", "quality", "nx", "ny", "nz"].map(|n| format!("property float {n}\n")).concat();
    format!(
        "ply\nformat {format} 1.0\nelement vertex {count}\n{properties}element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

#[test]
fn ply_files_in_text_and_in_bytes() {
    let rows = [[1.0f32, 2.0, 3.0, 9.0, 0.0, 0.0, 1.0], [4.0, 5.0, 6.0, 9.0, 1.0, 0.0, 0.0]];
    let text: String = rows.iter().map(|r| r.map(|v| v.to_string()).join(" ") + "\n").collect();
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    for (format, data) in [("ascii", text.into_bytes()), ("binary_little_endian", bytes)] {
        let (_folder, path) = file("a.ply", &[ply_header(format, 2).into_bytes(), data].concat());
        let cloud = load_points(&path).unwrap();
        assert_eq!(cloud.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(cloud.normals, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    }
}

#[test]
fn ply_files_that_are_none_are_errors() {
    let refuse = |bytes: &[u8]| {
        let (_folder, path) = file("a.ply", bytes);
        message(load_points(&path))
    };
    assert!(refuse(b"solid\n").contains("this is no PLY file"));
    let header = |names: &[&str]| {
        let properties = names.iter().map(|n| format!("property float {n}\n")).collect::<String>();
        format!("ply\nformat ascii 1.0\nelement vertex 1\n{properties}end_header\n0 0 0 0\n")
    };
    let half = refuse(header(&["x", "y", "z", "nx"]).as_bytes());
    assert!(half.ends_with("the points have no `ny`: normals (nx, ny, nz) are needed"), "{half}");
    let flat = refuse(header(&["x", "y"]).as_bytes());
    assert!(flat.ends_with("the points have no `z`: coordinates (x, y, z) are needed"), "{flat}");
    let many = refuse(ply_header("ascii", 4_000_000_000).as_bytes());
    assert!(many.ends_with("there are 4000000000 points, and at most 50000 are read"), "{many}");
    assert!(refuse(ply_header("binary_little_endian", 5).as_bytes()).contains("this is no PLY file"));
}

#[test]
fn points_that_make_no_solid_name_their_file() {
    let (_folder, path) = file("a.csv", b"0,0,0,0,0,1\n");
    let reason = load_points(&path).unwrap().reconstruct(&Reconstruction::default()).unwrap_err();
    let error = DataError::Points { path: PathBuf::from("a.csv"), reason };
    assert_eq!(error.to_string(), "a.csv: a solid needs 4 to 50000 points, not 1");
}

#[test]
fn scans_come_from_nrrd_and_raw_files() {
    let data: Vec<u8> = numbers().iter().map(|v| *v as u8).collect();
    let header = b"NRRD0004\ntype: uchar\nsizes: 3 2 2\nencoding: raw\nspacings: 1 2 4\n\n".to_vec();
    let (_folder, path) = file("a.nrrd", &[header, data.clone()].concat());
    let scan = load_scan(&path, None).unwrap();
    assert_eq!(scan.bounds(), [[0.0; 3], [2.0, 2.0, 4.0]]);
    assert!((scan.at([1.5, 0.0, 2.0]).unwrap() - 51.5).abs() < 1e-5);
    let (_folder, path) = file("a.raw", &data);
    assert!(message(load_scan(&path, None)).contains("raw numbers need their counts and type"));
    let layout = RawLayout { counts: [3, 2, 2], number: NumberType::U8, big_endian: false, skip: 0 };
    assert_eq!(load_scan(&path, Some(&layout)).unwrap().range(), Some([0.0, 112.0]));
    let (_folder, path) = file("a.nii", &data);
    assert!(message(load_scan(&path, None)).contains("this is no NIfTI file"));
}

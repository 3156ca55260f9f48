use super::*;
use crate::{Mode, Volume};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;

/// x on a grid of 5 × 3 × 3.
fn ramp() -> Scan {
    Scan::new([5, 3, 3], [0.25, 0.5, 0.5], (0..45).map(|i| (i % 5) as f32 * 0.25).collect()).unwrap()
}

fn knot(value: f64, density: f64) -> Knot {
    Knot { value, density, albedo: [0.5; 3], gloss: 0.0 }
}

fn volume(scan: &Scan, edge: u32, options: &ScanOptions) -> (Volume, Place) {
    let mut builder = Builder::new(edge).unwrap();
    let place = add_scan(&mut builder, scan, options).unwrap();
    (builder.build(Mode::Sggx).unwrap(), place)
}

#[test]
fn numbers_are_linear_in_between() {
    let scan = ramp();
    for x in [0.0, 0.1, 0.7, 1.0] {
        assert!((scan.at([x, 0.3, 0.9]).unwrap() - x).abs() < 1e-6);
    }
    assert_eq!(scan.at([1.1, 0.0, 0.0]), None);
    assert_eq!((scan.range(), scan.bounds()), (Some([0.0, 1.0]), [[0.0; 3], [1.0; 3]]));
}

#[test]
fn densities_follow_the_transfer_function() {
    let transfer = vec![knot(0.25, 0.0), knot(0.75, 8.0)];
    let (volume, place) = volume(&ramp(), 16, &ScanOptions { transfer, ..ScanOptions::default() });
    let width = volume.cell_width(0);
    for i in 1..15 {
        let x = place.model_from_cube(DVec3::splat((f64::from(i) + 0.5) * width)).x;
        let density = volume.texel(0, [i, 8, 8]).map_or(0.0, |texel| texel.density);
        let exact = ((x - 0.25) * 16.0).clamp(0.0, 8.0);
        assert!((f64::from(density) - exact).abs() < 0.15, "{x}: {density} beside {exact}");
    }
}

#[test]
fn flakes_lie_across_the_gradient() {
    let transfer = vec![knot(0.4, 0.0), knot(0.6, 100.0)];
    let (volume, _) =
        volume(&ramp(), 16, &ScanOptions { transfer, roughness: 0.0, ..ScanOptions::default() });
    let border = volume.texel(0, [7, 8, 8]).unwrap().flakes;
    assert!(border.xx > 3.9 && border.yy < 0.05, "{border:?}");
    let inside = volume.texel(0, [13, 8, 8]).unwrap().flakes;
    assert!((inside.xx - 1.0).abs() < 0.02 && (inside.yy - 1.0).abs() < 0.02, "{inside:?}");
}

#[test]
fn what_is_no_number_is_empty() {
    let scan = Scan::new([2, 2, 2], [1.0; 3], vec![f32::NAN; 8]).unwrap();
    let mut builder = Builder::new(4).unwrap();
    add_scan(&mut builder, &scan, &ScanOptions::default()).unwrap();
    assert!(builder.is_empty());
}

#[test]
fn what_makes_no_scan_is_refused() {
    assert!(matches!(Scan::new([2, 2, 1], [1.0; 3], vec![0.0; 4]), Err(ScanError::Counts { .. })));
    assert!(matches!(Scan::new([2, 2, usize::MAX], [1.0; 3], vec![0.0; 4]), Err(ScanError::Counts { .. })));
    assert!(matches!(Scan::new([2; 3], [0.0; 3], vec![0.0; 8]), Err(ScanError::Steps(_))));
    let mut builder = Builder::new(4).unwrap();
    let transfer = vec![knot(1.0, 0.0), knot(1.0, 2.0)];
    let error = add_scan(&mut builder, &ramp(), &ScanOptions { transfer, ..ScanOptions::default() });
    let message = error.unwrap_err().to_string();
    assert_eq!(message, "`value` is greater than the one before it in the transfer function, not 1");
}

/// A NIfTI file of 3 × 2 × 2 numbers of two bytes, 0 to 11, scaled by 2 and moved by 1.
fn nifti_file() -> Vec<u8> {
    let header = NiftiHeader {
        dim: [3, 3, 2, 2, 1, 1, 1, 1],
        datatype: 4,
        bitpix: 16,
        pixdim: [1.0, 1.5, 2.0, 2.5, 1.0, 1.0, 1.0, 1.0],
        vox_offset: 352.0,
        scl_slope: 2.0,
        scl_inter: 1.0,
        magic: *b"n+1\0",
        ..NiftiHeader::default()
    };
    let mut bytes = nifti_header(&header);
    bytes.resize(352, 0);
    bytes.extend((0..12i16).flat_map(|i| i.to_le_bytes()));
    bytes
}

/// The fields of a header that the tests need, at their places (NIfTI-1, 348 bytes).
fn nifti_header(header: &NiftiHeader) -> Vec<u8> {
    let mut bytes = vec![0; 348];
    let mut put = |place: usize, data: &[u8]| bytes[place..place + data.len()].copy_from_slice(data);
    put(0, &348i32.to_le_bytes());
    for (i, n) in header.dim.iter().enumerate() {
        put(40 + 2 * i, &n.to_le_bytes());
    }
    put(70, &header.datatype.to_le_bytes());
    put(72, &header.bitpix.to_le_bytes());
    for (i, step) in header.pixdim.iter().enumerate() {
        put(76 + 4 * i, &step.to_le_bytes());
    }
    put(108, &header.vox_offset.to_le_bytes());
    put(112, &header.scl_slope.to_le_bytes());
    put(116, &header.scl_inter.to_le_bytes());
    put(344, &header.magic);
    bytes
}

#[test]
fn nifti_files_packed_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    let bytes = nifti_file();
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(&bytes).unwrap();
    for bytes in [bytes, packer.finish().unwrap()] {
        std::fs::write(&path, bytes).unwrap();
        let scan = read_nifti(&path).unwrap();
        assert_eq!((scan.counts, scan.steps), ([3, 2, 2], [1.5, 2.0, 2.5]));
        assert_eq!(scan.range(), Some([1.0, 23.0]));
    }
}

#[test]
fn damaged_nifti_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    let whole = nifti_file();
    for length in [0, 4, 100, 347, 360, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(read_nifti(&path).is_err(), "{length}");
    }
    for place in 0..whole.len().min(352) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x55;
        std::fs::write(&path, bytes).unwrap();
        // Whatever it is, it ends.
        let _ = read_nifti(&path);
    }
}

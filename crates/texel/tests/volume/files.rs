use super::{Chance, scattered};
use fieldstone_texel::{Builder, FileError, Mode, Phong, Sggx, Texel, Volume};

fn bytes(volume: &Volume) -> Vec<u8> {
    let mut bytes = Vec::new();
    volume.write_to(&mut bytes).expect("memory");
    bytes
}

/// The bytes with a checksum that fits them.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let sum = crc32fast::hash(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&sum);
    bytes
}

#[test]
fn a_file_gives_back_the_volume() {
    for (edge, filled, mode) in
        [(1, 0, Mode::Sggx), (1, 1, Mode::Sggx), (2, 3, Mode::Neyret1995), (32, 2000, Mode::Sggx)]
    {
        let (volume, _) = scattered(edge, filled, mode);
        let bytes = bytes(&volume);
        assert_eq!(volume.file_bytes(), bytes.len() as u64);
        assert!(Volume::from_bytes(&bytes).expect("whole") == volume);
    }
}

#[test]
fn flags_and_coefficients_are_kept() {
    let phong = Phong { diffuse: 0.5, specular: 0.25, exponent: 70.0 };
    let mut builder = Builder::new(4).expect("a power of two").cyclic([true, false, true]).phong(phong);
    builder.insert([1, 1, 1], &Texel::even(1.0, Sggx::ISOTROPIC, 0.25));
    let volume = builder.build(Mode::Neyret1995).expect("one cell");
    let read = Volume::from_bytes(&bytes(&volume)).expect("whole");
    assert_eq!((read.cyclic(), read.mode(), read.phong()), ([true, false, true], Mode::Neyret1995, phong));
}

#[test]
fn every_flipped_bit_is_seen() {
    let (volume, _) = scattered(8, 40, Mode::Sggx);
    let bytes = bytes(&volume);
    for bit in 0..8 * bytes.len() {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(Volume::from_bytes(&damaged).is_err(), "bit {bit}");
    }
}

#[test]
fn every_cut_is_seen() {
    let (volume, _) = scattered(8, 40, Mode::Sggx);
    let bytes = bytes(&volume);
    for end in 0..bytes.len() {
        assert!(Volume::from_bytes(&bytes[..end]).is_err(), "{end}");
    }
    let longer = [bytes, vec![0]].concat();
    assert!(matches!(Volume::from_bytes(&longer), Err(FileError::Length { .. })));
}

#[test]
fn damage_under_a_right_checksum_gives_an_error_or_a_volume() {
    let (volume, _) = scattered(8, 40, Mode::Sggx);
    let bytes = bytes(&volume);
    let mut chance = Chance(3);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..20_000 {
        let mut damaged = bytes.clone();
        for _ in 0..=chance.below(3) {
            let at = chance.below(bytes.len() as u32 - 4) as usize;
            damaged[at] = chance.next() as u8;
        }
        match Volume::from_bytes(&sealed(damaged)) {
            Ok(volume) => {
                read += 1;
                for level in 0..volume.levels() {
                    volume.for_each(level, |cell, _| assert!(volume.texel(level, cell).is_some()));
                }
            }
            Err(_) => refused += 1,
        }
    }
    assert!(read > 1000 && refused > 1000, "{read} {refused}");
}

#[test]
fn bytes_by_chance_are_no_volume() {
    let mut chance = Chance(4);
    for length in 0..3000 {
        let mut noise: Vec<u8> = (0..length).map(|_| chance.next() as u8).collect();
        assert!(Volume::from_bytes(&noise).is_err());
        if length > 16 {
            noise[..12].copy_from_slice(b"FSTEXEL\0\x01\0\0\0");
            noise[12] %= 13;
            noise[13..16].copy_from_slice(&[0; 3]);
            assert!(Volume::from_bytes(&sealed(noise)).is_err());
        }
    }
}

#[test]
fn the_reason_is_told() {
    let (volume, _) = scattered(8, 40, Mode::Sggx);
    let bytes = bytes(&volume);
    let with = |at: usize, value: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = value;
        Volume::from_bytes(&sealed(bytes)).expect_err("damaged").to_string()
    };
    assert_eq!(with(0, b'G'), "not a .texel file: it does not begin with FSTEXEL");
    assert_eq!(with(8, 2), "version 2 of .texel files cannot be read, only 1");
    assert_eq!(with(12, 40), "the header is damaged: an edge of 2 to the 40 cells");
    let mut changed = bytes.clone();
    let last = changed.len() - 5;
    changed[last] ^= 4;
    let error = Volume::from_bytes(&changed).expect_err("damaged").to_string();
    assert!(error.starts_with("the file is damaged: its checksum is "), "{error}");
}

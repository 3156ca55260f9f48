use super::{Chance, scattered};
use fieldstone_texel::{Builder, Mode, Sggx, Texel, Volume};
use glam::DVec3;

/// Opaque specks by chance: what linear filtering of densities turns to haze.
fn specks(mode: Mode) -> Volume {
    let mut chance = Chance(6);
    let mut builder = Builder::new(32).expect("a power of two");
    for _ in 0..400 {
        let opaque = Texel { density: 160.0, depth: [20.0; 3], ..Texel::default() };
        builder.insert(std::array::from_fn(|_| chance.below(32)), &opaque);
    }
    builder.build(mode).expect("few cells")
}

#[test]
fn an_even_cube_is_the_same_at_every_level() {
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let mut builder = Builder::new(8).expect("a power of two");
        for key in 0..512 {
            builder.insert([key & 7, key >> 3 & 7, key >> 6], &Texel::even(1.5, Sggx::ISOTROPIC, 0.125));
        }
        for row in builder.build(mode).expect("few cells").compare() {
            assert!(row.rmse < 1e-6 && row.drift.abs() < 1e-6, "{mode:?}: {row:?}");
            assert_eq!(row.contrast, None);
        }
    }
}

#[test]
fn the_rules_of_1995_darken_specks_and_those_of_transmittance_hardly() {
    let (new, old) = (specks(Mode::Sggx).compare(), specks(Mode::Neyret1995).compare());
    assert_eq!(new.len(), 5);
    for (new, old) in new.iter().zip(&old) {
        assert!(new.rmse < 0.5 * old.rmse, "{new:?} {old:?}");
        assert!(new.drift.abs() < 0.02, "{new:?}");
        assert!(old.drift > 0.1, "{old:?}");
    }
    assert!(new[0].contrast.is_some_and(|contrast| (contrast - 1.0).abs() < 0.05), "{:?}", new[0]);
}

#[test]
fn the_whole_cube_is_its_mean_opacity_at_the_top() {
    let (volume, _) = scattered(16, 200, Mode::Sggx);
    let rows = volume.compare();
    let top = rows.last().expect("levels");
    assert!(top.level == 4 && top.rmse < 2e-3 && top.drift.abs() < 2e-3, "{top:?}");
}

/// A sun overhead throws the shadow along z; an oblique one tells the same of the two rules.
#[test]
fn shadows_in_the_sun_keep_their_contrast_by_the_rule_of_transmittances() {
    let sun = DVec3::new(0.5, -0.4, 0.9);
    let (new, old) = (specks(Mode::Sggx).compare_in_sun(sun), specks(Mode::Neyret1995).compare_in_sun(sun));
    assert_eq!((new.len(), old.len()), (5, 5));
    for (new, old) in new.iter().zip(&old).take(3) {
        assert!(new.drift.abs() < 0.5 * old.drift.abs(), "{new:?} {old:?}");
        assert!(new.rmse < old.rmse, "{new:?} {old:?}");
    }
    assert!(specks(Mode::Sggx).compare_in_sun(DVec3::ZERO).is_empty());
}

#[test]
fn an_even_cube_throws_the_same_shadow_at_every_level() {
    let mut builder = Builder::new(8).expect("a power of two").cyclic([true; 3]);
    for key in 0..512 {
        builder.insert([key & 7, key >> 3 & 7, key >> 6], &Texel::even(1.5, Sggx::ISOTROPIC, 0.125));
    }
    for row in builder.build(Mode::Sggx).expect("few cells").compare_in_sun(DVec3::new(0.3, 0.5, 0.8)) {
        assert!(row.rmse < 1e-6 && row.drift.abs() < 1e-6, "{row:?}");
    }
}

#[test]
fn sizes_are_counted() {
    let (volume, cells) = scattered(32, 500, Mode::Sggx);
    let size = volume.size();
    assert_eq!((size.filled, size.cells), (cells.len() as u64, 32768));
    assert_eq!(size.dense_bytes, 16 * 32768);
    assert!((size.compression() - (1.0 - volume.file_bytes() as f64 / 524_288.0)).abs() < 1e-12);
    let mut full = Builder::new(8).expect("a power of two");
    for key in 0..512 {
        full.insert([key & 7, key >> 3 & 7, key >> 6], &Texel::even(1.5, Sggx::ISOTROPIC, 0.125));
    }
    assert_eq!(full.build(Mode::Sggx).expect("few cells").size().filled, 512);
}

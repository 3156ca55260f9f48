use super::{Chance, scattered};
use fieldstone_texel::{BuildError, Builder, MAX_DEPTH, Mode, Sggx, Texel};
use std::collections::BTreeMap;

#[test]
fn what_is_put_in_is_found_and_nothing_else() {
    let (volume, cells) = scattered(16, 600, Mode::Sggx);
    let cells: BTreeMap<_, _> = cells.into_iter().collect();
    for x in 0..16 {
        for y in 0..16 {
            for z in 0..16 {
                match (volume.texel(0, [x, y, z]), cells.get(&[x, y, z])) {
                    (None, None) => {}
                    (Some(found), Some(given)) => {
                        assert!((found.depth[0] / given.depth[0].max(1e-5) - 1.0).abs() < 0.003);
                        assert!((found.albedo[2] - given.albedo[2]).abs() < 0.004);
                    }
                    other => panic!("{:?}: {other:?}", [x, y, z]),
                }
            }
        }
    }
    assert_eq!(volume.texel(0, [16, 0, 0]), None);
    assert_eq!(volume.texel(9, [0, 0, 0]), None);
}

#[test]
fn empty_cells_are_passed_as_far_as_they_reach() {
    let mut builder = Builder::new(16).expect("a power of two");
    builder.insert([0, 0, 0], &Texel::even(1.0, Sggx::ISOTROPIC, 1.0 / 16.0));
    let volume = builder.build(Mode::Sggx).expect("one cell");
    assert_eq!(volume.find(0, [15, 15, 15]).level, 3);
    assert_eq!(volume.find(0, [3, 0, 0]).level, 1);
    assert_eq!(volume.find(0, [1, 0, 0]).level, 0);
    assert!(volume.find(0, [0, 0, 0]).texel.is_some() && volume.find(4, [0, 0, 0]).texel.is_some());
}

#[test]
fn an_evenly_filled_cube_is_one_cell() {
    let texel = Texel::even(30.0, Sggx::ISOTROPIC, 1.0 / 8.0);
    let mut builder = Builder::new(8).expect("a power of two");
    for key in 0..512 {
        builder.insert([key & 7, key >> 3 & 7, key >> 6], &texel);
    }
    let volume = builder.build(Mode::Sggx).expect("few cells");
    assert_eq!((0..4).map(|level| volume.stored(level)).collect::<Vec<_>>(), [0, 0, 0, 1]);
    for level in 0..4 {
        let found = volume.texel(level, [0; 3]).expect("filled");
        let expected = (30.0 * volume.cell_width(level) as f32).min(MAX_DEPTH);
        assert!((found.depth[0] / expected - 1.0).abs() < 0.003, "{level}: {found:?}");
    }
    let mut count = 0;
    volume.for_each(0, |_, _| count += 1);
    assert_eq!(count, 512);
}

#[test]
fn cells_are_visited_in_order_and_once() {
    let (volume, cells) = scattered(16, 600, Mode::Sggx);
    for level in 0..5 {
        let mut visited = Vec::new();
        volume.for_each(level, |cell, texel| {
            assert_eq!(volume.texel(level, cell).as_ref(), Some(texel));
            visited.push(cell);
        });
        let mut expected: Vec<_> = cells.iter().map(|(cell, _)| cell.map(|c| c >> level)).collect();
        expected.sort_unstable();
        expected.dedup();
        visited.sort_unstable();
        assert_eq!(visited, expected);
    }
}

#[test]
fn contents_of_one_cell_are_added() {
    let one = Texel::even(2.0, Sggx::ISOTROPIC, 0.25).coloured([1.0, 0.0, 0.0], 0.0);
    let other = Texel::even(6.0, Sggx::ISOTROPIC, 0.25).coloured([0.0, 1.0, 0.0], 0.0);
    let mut builder = Builder::new(4).expect("a power of two");
    builder.insert([1, 2, 3], &one);
    builder.insert([1, 2, 3], &other);
    let found = builder.build(Mode::Sggx).expect("few cells").texel(0, [1, 2, 3]).expect("filled");
    assert!((found.density / 8.0 - 1.0).abs() < 0.006 && (found.depth[1] / 2.0 - 1.0).abs() < 0.006);
    assert!((found.albedo[0] - 0.25).abs() < 0.006 && (found.albedo[1] - 0.75).abs() < 0.006);
}

#[test]
fn the_order_of_cells_does_not_matter() {
    let (volume, mut cells) = scattered(32, 3000, Mode::Neyret1995);
    let mut chance = Chance(5);
    for i in (1..cells.len()).rev() {
        cells.swap(i, chance.below(i as u32 + 1) as usize);
    }
    let mut builder = Builder::new(32).expect("a power of two");
    builder.extend(cells);
    assert!(builder.build(Mode::Neyret1995).expect("few cells") == volume);
}

#[test]
fn edges_are_powers_of_two() {
    for edge in [0, 3, 12, 8192] {
        assert_eq!(Builder::new(edge).err(), Some(BuildError::Edge { edge }));
    }
    let empty = Builder::new(1).expect("a power of two").build(Mode::Sggx).expect("no cells");
    assert_eq!((empty.levels(), empty.texel(0, [0; 3])), (1, None));
    let mut one = Builder::new(1).expect("a power of two");
    one.insert([0; 3], &Texel::even(1.0, Sggx::ISOTROPIC, 1.0));
    assert!(one.build(Mode::Sggx).expect("one cell").texel(0, [0; 3]).is_some());
}

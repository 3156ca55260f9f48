//! Places in an octree as one number: the bits of x, y and z in turns (Morton 1966), x in the lowest bit.

/// The key of a cell. Coordinates below 2²¹.
pub(crate) fn encode(cell: [u32; 3]) -> u64 {
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// The cell of a key.
pub(crate) fn decode(key: u64) -> [u32; 3] {
    [gather(key), gather(key >> 1), gather(key >> 2)]
}

fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

fn gather(key: u64) -> u32 {
    let mut x = key & 0x1249_2492_4924_9249;
    for (shift, mask) in [
        (2, 0x10c3_0c30_c30c_30c3),
        (4, 0x100f_00f0_0f00_f00f),
        (8, 0x001f_0000_ff00_00ff),
        (16, 0x001f_0000_0000_ffff),
        (32, 0x1f_ffff),
    ] {
        x = (x | x >> shift) & mask;
    }
    x as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_hold_their_cells() {
        for cell in [[0, 0, 0], [1, 2, 3], [4095, 0, 4095], [0x1f_ffff, 0x15_5555, 0x0a_aaaa]] {
            assert_eq!(decode(encode(cell)), cell);
        }
        assert_eq!(encode([1, 0, 0]), 1);
        assert_eq!(encode([0, 0, 2]), 32);
    }
}

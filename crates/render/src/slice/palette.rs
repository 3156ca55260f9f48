//! The colours of slices, in sRGB from 0 to 1.

/// A colour.
pub(super) type Colour = [f32; 3];

const fn rgb(hex: u32) -> Colour {
    let [_, r, g, b] = hex.to_be_bytes();
    [r as f32 / 255.0, g as f32 / 255.0, b as f32 / 255.0]
}

/// Inside.
pub(super) const INSIDE: Colour = rgb(0xf3cf9b);
/// Outside.
pub(super) const OUTSIDE: Colour = rgb(0xeaf0f5);
/// The boundary.
pub(super) const LINE: Colour = rgb(0x1f2630);
/// Lines of equal values, on either side.
pub(super) const CONTOUR_INSIDE: Colour = rgb(0xa8641c);
pub(super) const CONTOUR_OUTSIDE: Colour = rgb(0x5b7ea3);
/// Where there is no value, and the lines across it.
pub(super) const UNDEFINED: Colour = rgb(0xdcd3ea);
pub(super) const HATCH: Colour = rgb(0xb3a3cf);
/// Around the picture.
pub(super) const PAPER: Colour = rgb(0xffffff);
/// Axes and letters.
pub(super) const INK: Colour = rgb(0x3a4350);

/// Values from 0 to the end of the scale, inside and outside: the diverging scale RdBu of ColorBrewer.
const COLD: [Colour; 4] = [rgb(0xf7f7f7), rgb(0xd1e5f0), rgb(0x67a9cf), rgb(0x2166ac)];
const WARM: [Colour; 4] = [rgb(0xf7f7f7), rgb(0xfddbc7), rgb(0xef8a62), rgb(0xb2182b)];

/// The colour of a value from −1 (inside) to 1. Colours go with the square root: values are often far larger on one side
/// of the boundary than on the other.
pub(super) fn diverging(value: f32) -> Colour {
    let stops = if value < 0.0 { &COLD } else { &WARM };
    let place = value.abs().min(1.0).sqrt() * (stops.len() - 1) as f32;
    let before = (place as usize).min(stops.len() - 2);
    mix(stops[before], stops[before + 1], place - before as f32)
}

/// `a` where `t` is 0, `b` where it is 1.
pub(super) fn mix(a: Colour, b: Colour, t: f32) -> Colour {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_pale_in_the_middle_and_cold_inside() {
        let [inside, zero, outside] = [-1.0, 0.0, 1.0].map(diverging);
        assert!(zero.iter().all(|part| *part > 0.9));
        assert!(inside[2] > inside[0] && outside[0] > outside[2]);
        assert_eq!(diverging(-7.0), inside);
        assert_eq!(mix(inside, outside, 0.0), inside);
    }
}

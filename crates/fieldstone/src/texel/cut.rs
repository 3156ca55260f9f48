//! Pictures of what is in a volume, plane by plane.

use super::TexelError;
use fieldstone_scene::linear_to_srgb;
use fieldstone_texel::{Texel, Volume};
use glam::DVec3;

/// The greatest number of pixels along an edge.
pub const MAX_CUT_PIXELS: u32 = 4096;

/// What a cut shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CutContent {
    /// Colours before a chequered ground that shows through as far as the cells are transparent.
    #[default]
    Colour,
    /// Opacity across the plane: black lets all light pass, white none.
    Opacity,
    /// The projected areas of the flakes along x, y and z as red, green and blue: 2, which a flat flake has along its
    /// normal, is full. Empty cells are black.
    Flakes,
}

/// A plane of cells of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// 0 is the finest level.
    pub level: u32,
    /// The axis across the plane: 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// Where it crosses the axis, from 0 to 1.
    pub at: f64,
    /// What is shown.
    pub content: CutContent,
}

/// A picture of a cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CutPicture {
    /// Pixels along each edge.
    pub side: u32,
    /// Red, green, blue in sRGB, row by row from the top.
    pub pixels: Vec<u8>,
}

impl Cut {
    /// Draws the cut at least 512 pixels wide, each cell as a square of pixels. The first of the other two axes goes
    /// right, the second up.
    ///
    /// # Errors
    /// A level or a place that the volume has not.
    pub fn draw(&self, volume: &Volume) -> Result<CutPicture, TexelError> {
        if self.level >= volume.levels() {
            let last = volume.levels() - 1;
            return Err(TexelError::Cut(format!("there is no level {}: levels are 0 to {last}", self.level)));
        }
        if !(0.0..=1.0).contains(&self.at) || self.axis > 2 {
            return Err(TexelError::Cut(format!("a cut is at a place from 0 to 1, not at {}", self.at)));
        }
        let cells = volume.edge() >> self.level;
        let scale = (512 / cells).max(1);
        let side = (cells * scale).min(MAX_CUT_PIXELS);
        let across = ((self.at * f64::from(cells)) as u32).min(cells - 1);
        let mut pixels = Vec::with_capacity(3 * (side * side) as usize);
        for row in 0..side {
            for column in 0..side {
                let (u, v) = (column / scale, cells - 1 - row / scale);
                let mut cell = [u, v, v];
                if self.axis == 0 {
                    cell = [across, u, v];
                } else {
                    cell[self.axis] = across;
                }
                let ground = if (column / 16 + row / 16) % 2 == 0 { 0.25 } else { 0.12 };
                let colour = self.colour(volume.texel(self.level, cell).as_ref(), ground);
                pixels.extend(
                    colour.to_array().map(|c| (linear_to_srgb(c.clamp(0.0, 1.0)) * 255.0).round() as u8),
                );
            }
        }
        Ok(CutPicture { side, pixels })
    }

    fn colour(&self, texel: Option<&Texel>, ground: f64) -> DVec3 {
        let opacity = |texel: &Texel| -(-f64::from(texel.depth[self.axis])).exp_m1();
        match (self.content, texel) {
            (CutContent::Colour, None) => DVec3::splat(ground),
            (CutContent::Colour, Some(texel)) => {
                let colour = DVec3::from_array(texel.albedo.map(f64::from));
                DVec3::splat(ground).lerp(colour, opacity(texel))
            }
            (CutContent::Opacity, texel) => DVec3::splat(texel.map_or(0.0, opacity)),
            (CutContent::Flakes, None) => DVec3::ZERO,
            (CutContent::Flakes, Some(texel)) => {
                DVec3::from_array(DVec3::AXES.map(|w| 0.5 * texel.flakes.projected_area(w)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_texel::{Builder, Mode, Sggx};

    #[test]
    fn cells_stand_where_they_are() {
        let mut builder = Builder::new(4).expect("a power of two");
        let opaque = Texel { depth: [20.0; 3], density: 80.0, flakes: Sggx::ISOTROPIC, ..Texel::default() };
        builder.insert([1, 2, 3], &opaque.coloured([1.0, 0.0, 0.0], 0.0));
        let volume = builder.build(Mode::Sggx).expect("one cell");
        for (axis, u, v) in [(0, 2, 3), (1, 1, 3), (2, 1, 2)] {
            let at = ([1.0, 2.0, 3.0][axis] + 0.5) / 4.0;
            let cut = Cut { level: 0, axis, at, content: CutContent::Opacity };
            let picture = cut.draw(&volume).expect("a plane");
            let pixel =
                |u: u32, v: u32| picture.pixels[3 * ((128 * (3 - v) + 64) * 512 + 128 * u + 64) as usize];
            for i in 0..16 {
                let expected = if (i % 4, i / 4) == (u, v) { 255 } else { 0 };
                assert_eq!(pixel(i % 4, i / 4), expected, "axis {axis}");
            }
        }
        let none = Cut { level: 3, axis: 0, at: 0.5, content: CutContent::Colour };
        assert!(none.draw(&volume).is_err());
    }
}

//! A temple: steps, fluted columns around a hall, beams with dentils, a roof with gables.

use crate::program::{Program, Value};

/// How far apart columns stand, and how many there are along the front and along the sides.
const PITCH: f64 = 1.0;
const FRONT: usize = 6;
const SIDE: usize = 9;
/// Where columns begin and end.
const FLOOR: f64 = 0.6;
const BEAM: f64 = 4.6;

/// A solid in the making.
struct Site<'p> {
    program: &'p Program,
    point: [Value<'p>; 3],
}

/// The temple stands on z = 0; its fronts look along ±y.
pub(super) fn temple(program: &Program) -> Option<Value<'_>> {
    let site = Site { program, point: program.point() };
    let parts = [site.steps()?, site.columns()?, site.hall()?, site.beams()?, site.roof()?];
    program.union(&parts)
}

/// Where column `i` of `count` stands along its row.
fn place(i: usize, count: usize) -> f64 {
    (i as f64 - (count - 1) as f64 / 2.0) * PITCH
}

impl<'p> Site<'p> {
    /// A box: from −half to half along x and y, between two heights.
    fn block(&self, half: [f64; 2], low: f64, high: f64) -> Value<'p> {
        let [x, y, z] = self.point;
        x.slab(0.0, half[0]).max(y.slab(0.0, half[1])).max(z.slab((low + high) / 2.0, (high - low) / 2.0))
    }

    fn steps(&self) -> Option<Value<'p>> {
        let step = |i: usize| {
            let (out, low) = (0.85 - 0.25 * i as f64, FLOOR / 3.0 * i as f64);
            self.block([2.5 + out, 4.0 + out], low, low + FLOOR / 3.0)
        };
        self.program.union(&[step(0), step(1), step(2)])
    }

    fn columns(&self) -> Option<Value<'p>> {
        let is_outer = |i: usize, count: usize| i == 0 || i + 1 == count;
        let mut columns = Vec::new();
        for (i, j) in (0..FRONT).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
            if is_outer(i, FRONT) || is_outer(j, SIDE) {
                columns.push(self.column(place(i, FRONT), place(j, SIDE))?);
            }
        }
        self.program.union(&columns)
    }

    /// A shaft that grows thinner upwards, with sixteen flutes, a foot and a capital.
    fn column(&self, x: f64, y: f64) -> Option<Value<'p>> {
        let z = self.point[2];
        let (u, v) = ((self.point[0] - x).abs(), (self.point[1] - y).abs());
        let radius = u.hypot(v);
        let girth = (z - FLOOR) * -0.018 + 0.31;
        let shaft = radius - girth;
        // An eighth of the shaft stands for all of it: two flutes on its borders, and one between.
        let (large, small) = (u.max(v), u.min(v));
        let flute = |i: u32| {
            let (sine, cosine) = (std::f64::consts::FRAC_PI_8 * f64::from(i)).sin_cos();
            (large - girth * cosine).hypot(small - girth * sine) - 0.045
        };
        let flutes = self.program.union(&[flute(0), flute(1), flute(2)])?;
        let shaft = shaft.without(flutes).max(z.slab((FLOOR + BEAM) / 2.0, (BEAM - FLOOR) / 2.0));
        let foot = (radius - 0.38).max(z.slab(FLOOR + 0.05, 0.06));
        let cushion = (radius - (z - (BEAM - 0.32)) * 0.5 - 0.24).max(z.slab(BEAM - 0.21, 0.11));
        let plate = (large - 0.4).max(z.slab(BEAM - 0.06, 0.07));
        self.program.union(&[shaft, foot, cushion, plate])
    }

    /// Walls with a door to the front.
    fn hall(&self) -> Option<Value<'p>> {
        let walls = self.block([1.55, 2.9], FLOOR, BEAM);
        let room = self.block([1.4, 2.75], FLOOR + 0.02, BEAM - 0.05);
        let [x, y, z] = self.point;
        let door = self.program.intersection(&[x.slab(0.0, 0.55), y + 2.0, z.slab(FLOOR, 2.6)])?;
        Some(walls.without(room).without(door))
    }

    /// Beams over the columns, a frieze with grooves, and dentils under the cornice.
    fn beams(&self) -> Option<Value<'p>> {
        let [x, y, z] = self.point;
        let beam = self.block([2.85, 4.35], BEAM, BEAM + 0.35);
        let frieze = self.block([2.82, 4.32], BEAM + 0.35, BEAM + 0.75);
        let groove = |a: Value<'p>, at: f64| a.slab(at, 0.035);
        let along_x = (0..23).map(|i| groove(x, (f64::from(i) - 11.0) * 0.25));
        let along_y = (0..35).map(|i| groove(y, (f64::from(i) - 17.0) * 0.25));
        let over_front = self.program.union(&along_x.collect::<Vec<_>>())?.max(-(y.slab(0.0, 4.27)));
        let over_side = self.program.union(&along_y.collect::<Vec<_>>())?.max(-(x.slab(0.0, 2.77)));
        let grooves = over_front.min(over_side).max(z.slab(BEAM + 0.55, 0.14));
        let dentil = |a: Value<'p>, at: f64| a.slab(at, 0.06);
        let along_x = (0..24).map(|i| dentil(x, (f64::from(i) - 11.5) * 0.245));
        let along_y = (0..36).map(|i| dentil(y, (f64::from(i) - 17.5) * 0.247));
        let rows = self.program.union(&along_x.collect::<Vec<_>>())?.max(x.slab(0.0, 2.95));
        let rows = rows.min(self.program.union(&along_y.collect::<Vec<_>>())?.max(y.slab(0.0, 4.45)));
        let dentils = rows.max(self.block([2.95, 4.45], BEAM + 0.74, BEAM + 0.88));
        let cornice = self.block([3.1, 4.6], BEAM + 0.87, BEAM + 1.0);
        self.program.union(&[beam, frieze.without(grooves), dentils, cornice])
    }

    /// Two slopes, gables that stand back, tiles in rows, and a ball on each corner.
    fn roof(&self) -> Option<Value<'p>> {
        let [x, y, z] = self.point;
        let slope = (z - (BEAM + 1.0)) * 0.9 + x.abs() * 0.36;
        let roof = self.program.intersection(&[slope - 1.2, y.slab(0.0, 4.6), -(z - (BEAM + 0.95))])?;
        let gable = self.program.intersection(&[slope - 0.95, -(y.slab(0.0, 4.45)), -(z - (BEAM + 1.05))])?;
        let row = |i: u32| (y - (f64::from(i) - 10.0) * 0.44).abs() - 0.06;
        let rows = self.program.union(&(0..21).map(row).collect::<Vec<_>>())?;
        let tiles = self.program.intersection(&[rows, slope - 1.26, -(slope - 1.1), y.slab(0.0, 4.55)])?;
        let tiles = tiles.max(x.slab(0.0, 3.05));
        let ball = |u: f64, v: f64, w: f64| {
            let squares = (x.abs() - u).square() + (y.abs() - v).square() + (z - w).square();
            squares.sqrt() - 0.16
        };
        let balls = [ball(2.95, 4.45, BEAM + 1.26), ball(0.0, 4.45, BEAM + 2.45)];
        Some(roof.without(gable).min(tiles).min(balls[0]).min(balls[1]))
    }
}

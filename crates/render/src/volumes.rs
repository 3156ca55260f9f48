//! Light in the volumes of texels of a scene.
//!
//! A ray is cut into pieces in filled cells before its nearest surface. Each piece asks for light as a surface does: a
//! wish towards each lamp, whose shadow ray looks for solids from the middle of the piece. What volumes leave of the light is known
//! when it is asked for: optical depths are added up at once, from both ends of a piece in between which they rise evenly. So
//! volumes throw shadows on solids, solids on volumes, and mirrors and glass show both.
//!
//! The level that is looked at follows from the distance to the eye, also in mirrors; two levels are blended, but one is
//! looked at alone in volumes that were filtered by the rules of 1995.

use crate::hierarchy::Hierarchy;
use fieldstone_scene::{Rgb, Scene, TexelBox};
use fieldstone_texel::{Footprint, Layer, Mode, Ray, Reflector, Segment, Texel};
use glam::DVec3;

/// Where less than this of the light passes, nothing behind is looked at.
pub(crate) const FAINTEST: f64 = 1.0 / 4096.0;

/// Pieces are no longer than this many cells of the level looked at.
const CELLS: f64 = 4.0;

/// The most pieces of one segment.
const MOST_PIECES: f64 = 1024.0;

/// Up to so many volumes are asked one after the other.
const FEW: usize = 8;

/// Behind this optical depth nothing is seen: e⁻²⁰ = 2·10⁻⁹ of the light passes.
const OPAQUE: f64 = 20.0;

/// How far from the ends of a piece, in parts of its length, is within its cell.
const INSET: f64 = 1e-6;

/// The volumes of a scene.
pub(crate) struct Volumes<'s> {
    boxes: &'s [TexelBox],
    /// Where there are many.
    hierarchy: Option<Hierarchy>,
    /// How wide in a cell of the finest level of each is what is 1 wide in the world.
    scales: Vec<f64>,
    eye: DVec3,
    /// The width of a pixel at the eye, and its growth by the distance.
    pixel: Footprint,
    /// The number of the first volume among the parts of the scene: they come after those of all solids.
    first_part: usize,
}

/// A piece of a ray in a filled cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<'s> {
    texels: &'s TexelBox,
    /// Its volume among the parts of the scene.
    pub(crate) part: usize,
    segment: Segment,
    /// Where it begins and ends along the ray.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The optical depth from end to end.
    pub(crate) depth: f64,
}

impl<'s> Volumes<'s> {
    pub(crate) fn new(scene: &'s Scene, first_part: usize) -> Self {
        let (width, height) = scene.settings().size;
        let (x, y) = (0.5 * f64::from(width), 0.5 * f64::from(height));
        let (near, beside) = (scene.ray(x, y), scene.ray(x + 1.0, y));
        let pixel = Footprint { width: near.0.distance(beside.0), spread: near.1.distance(beside.1) };
        let scale = |texels: &TexelBox| texels.scale() / texels.volume().cell_width(0);
        let scales = scene.texels().iter().map(scale).collect();
        let boxes = scene.texels();
        let bounds = || boxes.iter().map(TexelBox::bounds).collect::<Vec<_>>();
        let hierarchy = (boxes.len() > FEW).then(|| Hierarchy::new(&bounds()));
        Self { boxes, hierarchy, scales, eye: near.0, pixel, first_part }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// The pieces of a ray before a distance, front to back, until nothing more is seen.
    pub(crate) fn pieces(&self, ray: (DVec3, DVec3), furthest: f64) -> Vec<Piece<'s>> {
        let mut pieces = Vec::new();
        self.visit(ray, furthest, |number| self.cut(ray, furthest, (number, &mut pieces)));
        if self.boxes.len() > 1 {
            pieces.sort_by(|a, b| a.from.total_cmp(&b.from));
        }
        pieces
    }

    /// Adds the pieces of a ray in one volume; from where on nothing is seen behind them.
    fn cut(
        &self,
        (origin, direction): (DVec3, DVec3),
        furthest: f64,
        (number, pieces): (usize, &mut Vec<Piece<'s>>),
    ) -> f64 {
        let (texels, part) = (&self.boxes[number], self.first_part + number);
        let ray = in_volume(texels, origin, direction);
        let Some((near, far)) = texels.span(&ray) else { return f64::INFINITY };
        let level = |t: f64| self.level(number, origin + t * direction);
        let mut depth = 0.0;
        for segment in texels.volume().segments(&ray, (near.max(0.0), far.min(furthest)), level) {
            let length = (segment.to - segment.from) * ray.direction.length();
            let cell = texels.volume().cell_width(level(segment.from) as u32);
            let count = (length / (CELLS * cell)).ceil().clamp(1.0, MOST_PIECES);
            let step = (segment.to - segment.from) / count;
            let whole = segment.depth(&ray) * texels.density();
            let each = whole / count;
            let end = |i: u32| {
                if f64::from(i) == count { segment.to } else { segment.from + f64::from(i) * step }
            };
            let piece = |i: u32| Piece { texels, part, segment, from: end(i), to: end(i + 1), depth: each };
            pieces.extend((0..count as u32).map(piece));
            depth += whole;
            if depth > -FAINTEST.ln() {
                return segment.to;
            }
        }
        f64::INFINITY
    }

    /// The optical depth of all volumes from a place in a unit direction over a distance.
    pub(crate) fn depth(&self, place: DVec3, direction: DVec3, distance: f64) -> f64 {
        let mut sum = 0.0;
        self.visit((place, direction), distance, |number| {
            let texels = &self.boxes[number];
            let ray = in_volume(texels, place, direction);
            if let Some((near, far)) = texels.span(&ray).filter(|(_, far)| *far > 0.0) {
                let level = self.level(number, place);
                let span = (near.max(0.0), far.min(distance));
                sum += texels.density() * texels.volume().depth_along(&ray, span, |_| level);
            }
            if sum > OPAQUE { f64::NEG_INFINITY } else { f64::INFINITY }
        });
        sum
    }

    /// Visits the volumes that a ray may meet before it has gone so far, from the nearest on where they are many; `visit`
    /// tells from where on others do not matter.
    fn visit(&self, ray: (DVec3, DVec3), furthest: f64, mut visit: impl FnMut(usize) -> f64) {
        let Some(hierarchy) = &self.hierarchy else {
            (0..self.boxes.len()).for_each(|number| {
                visit(number);
            });
            return;
        };
        let mut reach = furthest;
        let mut passage = hierarchy.passage(ray, furthest);
        while let Some(number) = hierarchy.next(&mut passage, reach) {
            reach = reach.min(visit(number));
        }
    }

    /// What of the light passes.
    pub(crate) fn transmittance(&self, place: DVec3, direction: DVec3, distance: f64) -> f64 {
        if self.is_empty() { 1.0 } else { (-self.depth(place, direction, distance)).exp() }
    }

    /// The level of cells as wide as a pixel at a place.
    fn level(&self, number: usize, place: DVec3) -> f32 {
        let texels = &self.boxes[number];
        let distance = place.distance(self.eye);
        let cells = (self.pixel.width + self.pixel.spread * distance) * self.scales[number];
        let level = (cells as f32).log2().max(texels.finest_level());
        match texels.volume().mode() {
            Mode::Sggx => level,
            // One level alone.
            Mode::Neyret1995 => level.round(),
        }
    }
}

/// What the flakes of a piece do with light.
pub(crate) struct Flakes {
    layers: Vec<(Rgb, Reflector)>,
}

impl Piece<'_> {
    /// Its ends, as far inside as it takes to be in its own cell: light may run along the faces of cells.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let inset = INSET * (self.to - self.from);
        [self.from + inset, self.to - inset]
    }

    /// Where half of the light passes, if so much does up to where it begins.
    pub(crate) fn half_way(&self, before: f64) -> f64 {
        self.from + (2.0 * before).ln() / self.depth * (self.to - self.from)
    }

    /// Its flakes, seen against the unit `direction` of the ray.
    pub(crate) fn flakes(&self, direction: DVec3) -> Flakes {
        let ray = self.texels.volume_from_world().transform_vector3(direction);
        let whole: f64 = self.segment.layers().iter().map(|layer| layer.extinction(ray)).sum();
        let turn = self.texels.turn();
        let layer = |layer: &Layer| {
            let weight = layer.extinction(ray) / whole.max(f64::MIN_POSITIVE);
            let texel = Texel { flakes: layer.texel.flakes.mapped(turn), ..layer.texel };
            let albedo = DVec3::from_array(texel.albedo.map(f64::from));
            (albedo * weight, Reflector::new(&texel, self.texels.model(), -direction))
        };
        Flakes { layers: self.segment.layers().iter().map(layer).collect() }
    }
}

impl Flakes {
    /// The share of light that is scattered at all.
    pub(crate) fn albedo(&self) -> Rgb {
        self.layers.iter().map(|(albedo, _)| *albedo).sum()
    }

    /// The share of light from a unit direction that is scattered towards the eye, per steradian.
    pub(crate) fn respond(&self, to_light: DVec3) -> Rgb {
        self.layers.iter().map(|(albedo, reflector)| *albedo * reflector.phase(to_light)).sum()
    }
}

fn in_volume(texels: &TexelBox, origin: DVec3, direction: DVec3) -> Ray {
    let map = texels.volume_from_world();
    Ray { origin: map.transform_point3(origin), direction: map.transform_vector3(direction) }
}

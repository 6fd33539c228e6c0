//! Made-up films of two posts that hold a tissue, with known motion.

use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;
use myospring::microscopy::posts::{Post, PostPlaces, PostShape};

/// What a made-up film shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) shape: PostShape,
    /// Middles at rest.
    pub(super) middles: [[f64; 2]; 2],
    /// Grey values of a post above those of the tissue; negative for dark posts.
    pub(super) contrast: f64,
    /// Whether only the rim of the posts differs from the tissue.
    pub(super) rim_only: bool,
    /// Largest displacement of a post, pixels.
    pub(super) pull: f64,
    /// Standard deviation of the motion of the stage, pixels.
    pub(super) jitter: f64,
    /// Standard deviation of the noise, grey levels.
    pub(super) noise: f64,
    /// Standard deviation of the texture of the tissue, grey levels.
    pub(super) texture: f64,
    pub(super) frames: usize,
    /// 0, or frames whose number modulo 4 is at least this show noise alone.
    pub(super) blank: usize,
    pub(super) seed: u64,
}

impl Scene {
    /// Round posts of this diameter in a frame that is four posts high and seven wide.
    pub(super) fn round(diameter: f64) -> Self {
        let side = |posts: f64| (posts * diameter).round().max(40.0) as usize;
        let (width, height) = (side(7.0), side(4.0));
        let row = 0.5 * height as f64 + 0.3;
        Self {
            width,
            height,
            shape: PostShape::Round { diameter_px: diameter },
            middles: [[1.4 * diameter + 0.2, row], [width as f64 - 1.4 * diameter - 0.7, row]],
            contrast: 80.0,
            rim_only: false,
            pull: (0.08 * diameter).max(1.0),
            jitter: 0.0,
            noise: 0.0,
            texture: 6.0,
            frames: 12,
            blank: 0,
            seed: 1,
        }
    }

    /// The same with rectangular posts.
    pub(super) fn rectangular(along: f64, across: f64) -> Self {
        let shape = PostShape::Rectangle { along_px: along, across_px: across };
        Self { shape, ..Self::round(along.max(across)) }
    }

    pub(super) fn places(&self, frame: usize) -> PostPlaces {
        let moved = self.moved();
        let post = |post: usize| Post {
            middle_px: [0, 1].map(|k: usize| self.middles[post][k] + moved[frame][post][k]),
            shape: self.shape,
        };
        PostPlaces { frame, posts: [post(0), post(1)] }
    }

    /// Part of the largest pull in a frame: a beat of twelve frames with its rest.
    fn beat(frame: usize) -> f64 {
        let phase = (frame % 12) as f64 / 12.0;
        if phase > 0.6 { 0.0 } else { (std::f64::consts::PI * phase / 0.6).sin().powi(2) }
    }

    /// Displacement of each post in each frame, pixels, with that of the stage.
    pub(super) fn moved(&self) -> Vec<[[f64; 2]; 2]> {
        let [a, b] = self.middles;
        let distance = (b[0] - a[0]).hypot(b[1] - a[1]);
        let axis = [0, 1].map(|k: usize| (b[k] - a[k]) / distance);
        let mut random = Random(self.seed ^ 0x5eed);
        let step = |frame: usize| {
            let stage = [self.jitter * random.normal(), self.jitter * random.normal()];
            // One post is stiffer than the other.
            let pull = self.pull * Self::beat(frame);
            [(0, pull), (1, -0.8 * pull)]
                .map(|(_, pull): (usize, f64)| [0, 1].map(|k: usize| stage[k] + pull * axis[k]))
        };
        (0..self.frames).map(step).collect()
    }

    /// The film, 16 bit a pixel.
    pub(super) fn film(&self) -> Film {
        let (width, height) = (self.width, self.height);
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F30:1 Cmono16\n").into_bytes();
        let mut random = Random(self.seed);
        let grains: Vec<[f64; 4]> = (0..16)
            .map(|_| {
                let wave = 0.8 + 1.6 * random.even();
                let angle = std::f64::consts::TAU * random.even();
                let phase = std::f64::consts::TAU * random.even();
                let scale = 12.0 / self.shape.sides_px()[0].clamp(8.0, 40.0);
                [scale * wave * angle.cos(), scale * wave * angle.sin(), phase, random.normal()]
            })
            .collect();
        for (frame, moved) in self.moved().into_iter().enumerate() {
            let is_blank = self.blank > 0 && frame % 4 >= self.blank;
            bytes.extend(b"FRAME\n");
            for row in 0..height {
                for column in 0..width {
                    let grey = if is_blank {
                        1000.0
                    } else {
                        self.grey([column as f64, row as f64], &moved, &grains)
                    };
                    let value = 20.0 * (grey + self.noise * random.normal());
                    bytes.extend((value.round().clamp(0.0, 65535.0) as u16).to_le_bytes());
                }
            }
        }
        Film::read(bytes, &Selection::default()).unwrap()
    }

    /// Grey value at a place: the posts over a tissue that moves with them, over a still ground.
    fn grey(&self, at: [f64; 2], moved: &[[f64; 2]; 2], grains: &[[f64; 4]]) -> f64 {
        let [a, b] = self.middles;
        let distance = (b[0] - a[0]).hypot(b[1] - a[1]);
        let axis = [(b[0] - a[0]) / distance, (b[1] - a[1]) / distance];
        let part = ((at[0] - a[0]) * axis[0] + (at[1] - a[1]) * axis[1]) / distance;
        let across = (at[1] - a[1]) * axis[0] - (at[0] - a[0]) * axis[1];
        let [_, wide] = self.shape.sides_px();
        // Half of the tissue's width: it has a waist.
        let waist = 0.7 + 0.35 * (2.0 * part.clamp(0.0, 1.0) - 1.0).powi(2);
        let ends = (part - 0.5).abs() * distance - 0.5 * distance - 0.9 * wide;
        let tissue = soft(across.abs() - waist * wide).min(soft(ends));
        let weight = part.clamp(0.0, 1.0);
        let own =
            [0, 1].map(|k: usize| at[k] - moved[0][k] * (1.0 - weight) - moved[1][k] * weight);
        let waves: f64 = grains
            .iter()
            .map(|[x, y, phase, size]| size * (x * own[0] + y * own[1] + phase).cos())
            .sum();
        let mut grey = 1000.0 + 60.0 * (1.0 - tissue);
        grey += tissue * self.texture * waves / (0.5 * grains.len().max(1) as f64).sqrt();
        for post in 0..2 {
            let off = [0, 1].map(|k: usize| at[k] - self.middles[post][k] - moved[post][k]);
            let out = self.outside(off, axis);
            let inside = soft(out);
            grey = if self.rim_only {
                let inner = soft(out + 0.2 * wide.max(10.0));
                grey + (inside - inner) * self.contrast
            } else {
                grey + inside * (1000.0 + self.contrast - grey)
            };
        }
        grey
    }

    /// Signed distance from the outline of a post, pixels, positive outside.
    fn outside(&self, off: [f64; 2], axis: [f64; 2]) -> f64 {
        let along = off[0] * axis[0] + off[1] * axis[1];
        let across = off[1] * axis[0] - off[0] * axis[1];
        match self.shape {
            PostShape::Round { diameter_px } => along.hypot(across) - 0.5 * diameter_px,
            PostShape::Rectangle { along_px, across_px } => {
                let [x, y] = [along.abs() - 0.5 * along_px, across.abs() - 0.5 * across_px];
                if x > 0.0 && y > 0.0 { x.hypot(y) } else { x.max(y) }
            }
        }
    }
}

/// 1 inside an edge that is some two pixels wide, 0 outside.
fn soft(out: f64) -> f64 {
    (1.0 + (1.8 * out).exp()).recip()
}

/// Numbers that look random (`splitmix64`).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// Between 0 and 1.
    pub(super) fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of a normal distribution with standard deviation 1.
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.even()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.even()).cos()
    }
}

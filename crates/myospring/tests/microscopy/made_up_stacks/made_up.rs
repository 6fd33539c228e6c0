//! Made-up stacks of cells whose volume and thickness are known.

/// A cell's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Body {
    /// Semi-axes 30, 10 and 6 um.
    Ellipsoid,
    /// On a flat bottom: semi-axes 30 and 12 um, 8 um high.
    Dome,
    /// 60 x 20 x 6 um.
    Slab,
    /// The ellipsoid, turned by 25 degrees in the plane and tilted by 12 degrees.
    Tilted,
}

/// How it is seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene {
    pub(super) body: Body,
    pub(super) pixel_um: f64,
    pub(super) z_step_um: f64,
    /// Standard deviations of the blur in the plane and along z, um.
    pub(super) blur_um: [f64; 2],
    /// Standard deviation of the noise over the brightness of the cell.
    pub(super) noise: f64,
    pub(super) membrane: bool,
    /// Depth over which brightness falls to 1/e, um.
    pub(super) attenuation_um: f64,
}

/// Fine grid, um, and size of the field of view, um; the cell stands 5 um above its lower face.
const FINE_UM: f64 = 0.25;
const FIELD_UM: [f64; 3] = [80.0, 40.0, 24.0];
const BOTTOM_UM: f64 = 5.0;
/// Thickness of a membrane's bright layer, um, on each side of the surface.
const LAYER_UM: f64 = 0.25;

impl Body {
    /// Whether a point (um from the middle of the field, above the bottom of the cell) is inside,
    /// if the surface is moved outward by `by` um.
    fn holds(self, [x, y, z]: [f64; 3], by: f64) -> bool {
        let ellipsoid = |[x, y, z]: [f64; 3], [a, b, c]: [f64; 3]| {
            let part = |v: f64, axis: f64| (v / (axis + by)).powi(2);
            part(x, a) + part(y, b) + part(z, c) < 1.0
        };
        match self {
            Self::Ellipsoid => ellipsoid([x, y, z - 6.0], [30.0, 10.0, 6.0]),
            Self::Dome => z > -by && ellipsoid([x, y, z], [30.0, 12.0, 8.0]),
            Self::Slab => x.abs() < 30.0 + by && y.abs() < 10.0 + by && z > -by && z < 6.0 + by,
            Self::Tilted => {
                let (sine, cosine) = 25_f64.to_radians().sin_cos();
                let (x, y) = (cosine * x + sine * y, cosine * y - sine * x);
                let (sine, cosine) = 12_f64.to_radians().sin_cos();
                let z = z - 8.6;
                ellipsoid([cosine * x + sine * z, y, cosine * z - sine * x], [30.0, 10.0, 6.0])
            }
        }
    }

    /// Volume, um^3, and largest thickness along z, um.
    pub(super) fn measures(self) -> [f64; 2] {
        let ellipsoid = 4.0 / 3.0 * std::f64::consts::PI * 30.0 * 10.0 * 6.0;
        match self {
            Self::Ellipsoid => [ellipsoid, 12.0],
            Self::Dome => [2.0 / 3.0 * std::f64::consts::PI * 30.0 * 12.0 * 8.0, 8.0],
            Self::Slab => [60.0 * 20.0 * 6.0, 6.0],
            Self::Tilted => {
                let (sine, cosine) = 12_f64.to_radians().sin_cos();
                [ellipsoid, 2.0 / ((sine / 30.0).powi(2) + (cosine / 6.0).powi(2)).sqrt()]
            }
        }
    }
}

impl Scene {
    /// Grey values of each slice, and columns and rows.
    pub(super) fn slices(&self) -> (Vec<Vec<f32>>, [usize; 2]) {
        let size = FIELD_UM.map(|um| (um / FINE_UM).round() as usize);
        let mut values = Vec::with_capacity(size.iter().product());
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = [x, y, z].map(|at| (at as f64 + 0.5) * FINE_UM);
                    let point =
                        [at[0] - FIELD_UM[0] / 2.0, at[1] - FIELD_UM[1] / 2.0, at[2] - BOTTOM_UM];
                    let bright = if self.membrane {
                        self.body.holds(point, LAYER_UM) && !self.body.holds(point, -LAYER_UM)
                    } else {
                        self.body.holds(point, 0.0)
                    };
                    values.push(if bright { 1.0_f32 } else { 0.0 });
                }
            }
        }
        let strides = [1, size[0], size[0] * size[1]];
        for axis in 0..3 {
            let sigma = self.blur_um[usize::from(axis == 2)] / FINE_UM;
            values = blurred(&values, size[axis], strides[axis], sigma);
        }
        self.sampled(&values, size)
    }

    /// Slices of the same noise without a cell.
    pub(super) fn noise_alone(&self) -> (Vec<Vec<f32>>, [usize; 2]) {
        let size = FIELD_UM.map(|um| (um / FINE_UM).round() as usize);
        self.sampled(&vec![0.0; size.iter().product()], size)
    }

    fn sampled(&self, values: &[f32], size: [usize; 3]) -> (Vec<Vec<f32>>, [usize; 2]) {
        let mut state = 88172645463325252_u64;
        let mut uniform = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        let most = values.iter().copied().fold(0.0, f32::max).max(f32::MIN_POSITIVE);
        let layer = size[0] * size[1];
        let block = (self.pixel_um / FINE_UM).round() as usize;
        let (width, height) = (size[0] / block, size[1] / block);
        let mut slices = Vec::new();
        let count = (FIELD_UM[2] / self.z_step_um) as usize;
        for slice in 0..count {
            let um = (slice as f64 + 0.5) * self.z_step_um;
            let place = (um / FINE_UM - 0.5).clamp(0.0, size[2] as f64 - 1.0);
            let (low, part) = (place as usize, place.fract() as f32);
            let high = (low + 1).min(size[2] - 1);
            let dim = (-(um - BOTTOM_UM).max(0.0) / self.attenuation_um).exp();
            let pixel = |at: usize| {
                let mut sum = 0.0;
                for row in 0..block {
                    for column in 0..block {
                        let from =
                            (at / width * block + row) * size[0] + at % width * block + column;
                        let [a, b] = [low, high].map(|z| values[z * layer + from]);
                        sum += a + part * (b - a);
                    }
                }
                f64::from(sum / most) / (block * block) as f64 * dim
            };
            let grey = (0..width * height).map(|at| {
                let noise: f64 = (0..4).map(|_| uniform() - 0.5).sum::<f64>() * 3.0_f64.sqrt();
                let value = 200.0 + 1000.0 * (pixel(at) + self.noise * noise);
                value.round().clamp(0.0, 65535.0) as f32
            });
            slices.push(grey.collect());
        }
        (slices, [width, height])
    }
}

fn blurred(values: &[f32], count: usize, stride: usize, sigma: f64) -> Vec<f32> {
    if sigma <= 0.0 {
        return values.to_vec();
    }
    let reach = (4.0 * sigma).ceil() as usize;
    let weight = |at: usize| (-0.5 * ((at as f64 - reach as f64) / sigma).powi(2)).exp() as f32;
    let weights: Vec<f32> = (0..=2 * reach).map(weight).collect();
    let sum: f32 = weights.iter().sum();
    let weights: Vec<f32> = weights.iter().map(|weight| weight / sum).collect();
    let mut result = vec![0.0; values.len()];
    let lines = values.chunks_exact(count * stride).zip(result.chunks_exact_mut(count * stride));
    for (values, result) in lines {
        for (place, result) in result.chunks_exact_mut(stride).enumerate() {
            for from in place.saturating_sub(reach)..(place + reach + 1).min(count) {
                let weight = weights[from + reach - place];
                let values = &values[from * stride..(from + 1) * stride];
                for (result, value) in result.iter_mut().zip(values) {
                    *result += weight * value;
                }
            }
        }
    }
    result
}

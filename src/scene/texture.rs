//! Decoded images with their mip chains.

use std::sync::LazyLock;

/// RGBA, 8 bits a channel, with a full mip chain (level 0 first, each half the size, rounded down, down to 1x1).
/// An image used both as colour and as data is two textures.
#[derive(Debug, Clone)]
pub struct Texture {
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// RGB is sRGB-encoded (filtered in linear light); else linear data.
    pub srgb: bool,
    pub mips: Vec<Vec<u8>>,
    pub wrap: [Wrap; 2],
    pub filter: Filter,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    Nearest,
    Linear,
}

/// How a texture is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampler {
    pub wrap: [Wrap; 2],
    pub filter: Filter,
}

impl Default for Sampler {
    fn default() -> Self {
        Self { wrap: [Wrap::Repeat; 2], filter: Filter::Linear }
    }
}

impl Texture {
    /// Builds the mip chain of `pixels`: `width` x `height` texels of RGBA, rows from the top.
    ///
    /// # Panics
    /// Where the size is 0 or is not that of `pixels`.
    pub fn new(name: String, [width, height]: [u32; 2], pixels: Vec<u8>, srgb: bool, sampler: Sampler) -> Self {
        assert!(width > 0 && height > 0 && pixels.len() == width as usize * height as usize * 4);
        let Sampler { wrap, filter } = sampler;
        Self { name, width, height, srgb, mips: mip_chain(width as usize, height as usize, pixels, srgb), wrap, filter }
    }

    /// One texel.
    pub fn flat(name: String, texel: [u8; 4], srgb: bool, sampler: Sampler) -> Self {
        Self::new(name, [1, 1], texel.to_vec(), srgb, sampler)
    }
}

/// All levels, each filtered from the one before it in linear light, which is kept in single precision so that rounding does not add up.
fn mip_chain(mut width: usize, mut height: usize, pixels: Vec<u8>, srgb: bool) -> Vec<Vec<u8>> {
    let mut mips = vec![pixels];
    let mut linear: Vec<[f32; 4]> = Vec::new();
    while width > 1 || height > 1 {
        linear = match mips.as_slice() {
            [base] => halve(width, height, |i| decode(&base[4 * i..], srgb)),
            _ => halve(width, height, |i| linear[i]),
        };
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
        mips.push(linear.iter().flat_map(|&texel| encode(texel, srgb)).collect());
    }
    mips
}

/// Box filter to half the size, rounded down; on an odd size each texel covers between two and three, so that the mean is kept.
fn halve(width: usize, height: usize, texel: impl Fn(usize) -> [f32; 4]) -> Vec<[f32; 4]> {
    let (columns, rows) = (footprints(width), footprints(height));
    let mut halved = Vec::with_capacity(columns.len() * rows.len());
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 4];
            for (y, &row_weight) in row.weights[..row.len].iter().enumerate() {
                for (x, &column_weight) in column.weights[..column.len].iter().enumerate() {
                    let source = texel((row.first + y) * width + column.first + x);
                    (0..4).for_each(|channel| sum[channel] += row_weight * column_weight * source[channel]);
                }
            }
            halved.push(sum);
        }
    }
    halved
}

/// The texels of one axis that a texel of half the size covers.
struct Footprint {
    first: usize,
    len: usize,
    weights: [f32; 3],
}

fn footprints(size: usize) -> Vec<Footprint> {
    let halved = (size / 2).max(1);
    let cover = size as f64 / halved as f64;
    let len = if size == 1 { 1 } else { 2 + size % 2 };
    let footprint = |i: usize| {
        let (start, end) = (i as f64 * cover, (i + 1) as f64 * cover);
        let first = (start as usize).min(size - len);
        let overlap = |texel: usize| (end.min((texel + 1) as f64) - start.max(texel as f64)).max(0.0);
        Footprint { first, len, weights: std::array::from_fn(|k| (overlap(first + k) / cover) as f32) }
    };
    (0..halved).map(footprint).collect()
}

/// Linear light of each sRGB code (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f64 / 255.0) as f32));

/// Linear light above which a value rounds to the next sRGB code.
static ROUNDS_UP: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear((code as f64 + 0.5) / 255.0) as f32));

/// The code of `i / 4096`, a lower bound to start from.
static NEAR_CODE: LazyLock<[u8; 4097]> = LazyLock::new(|| {
    let code = |linear: f32| ROUNDS_UP[..255].partition_point(|&bound| bound < linear) as u8;
    std::array::from_fn(|i| code(i as f32 / 4096.0))
});

fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

fn decode(texel: &[u8], srgb: bool) -> [f32; 4] {
    let linear = |code: u8| if srgb { LINEAR[usize::from(code)] } else { f32::from(code) / 255.0 };
    [linear(texel[0]), linear(texel[1]), linear(texel[2]), f32::from(texel[3]) / 255.0]
}

fn encode(texel: [f32; 4], srgb: bool) -> [u8; 4] {
    let round = |value: f32| (value * 255.0 + 0.5) as u8;
    let code = |value: f32| if srgb { srgb_code(value) } else { round(value) };
    [code(texel[0]), code(texel[1]), code(texel[2]), round(texel[3])]
}

/// The nearest sRGB code: exact, without a power.
fn srgb_code(linear: f32) -> u8 {
    let mut code = NEAR_CODE[(linear.clamp(0.0, 1.0) * 4096.0) as usize];
    while code < 255 && linear > ROUNDS_UP[usize::from(code)] {
        code += 1;
    }
    code
}

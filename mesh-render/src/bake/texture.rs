//! A baked map, and its PNG file.

use std::path::Path;

use mesh_core::io;

use crate::image::encode_png;
use crate::RenderError;

/// Bits of a sample in a PNG file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 256 values.
    Eight,
    /// 65536 values.
    Sixteen,
}

/// A square picture of numbers from 0 to 1, rows from the top; `N` a texel.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture<const N: usize> {
    size: usize,
    texels: Vec<[f32; N]>,
}

impl<const N: usize> Texture<N> {
    /// The picture with these texels, given by their places; every other texel takes the value of a nearest given one,
    /// counted in steps to one of eight neighbours, so that no filter blends a background in at a seam.
    pub(super) fn padded(size: usize, given: impl Iterator<Item = (u32, [f32; N])>) -> Self {
        let mut texels = vec![[0.0; N]; size * size];
        let mut is_known = vec![false; size * size];
        let mut ring = Vec::new();
        for (at, value) in given {
            texels[at as usize] = value;
            is_known[at as usize] = true;
            ring.push(at);
        }
        while !ring.is_empty() {
            let mut next = Vec::new();
            for at in ring {
                for neighbour in neighbours(at as usize, size) {
                    if !is_known[neighbour] {
                        is_known[neighbour] = true;
                        texels[neighbour] = texels[at as usize];
                        next.push(neighbour as u32);
                    }
                }
            }
            ring = next;
        }
        Self { size, texels }
    }

    /// Texels along a side.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The texel in column `x` and row `y`, both counted from the top left.
    ///
    /// # Panics
    /// If there is no such texel.
    pub fn texel(&self, x: usize, y: usize) -> [f32; N] {
        self.texels[y * self.size + x]
    }

    /// All texels, row by row.
    pub fn texels(&self) -> &[[f32; N]] {
        &self.texels
    }

    /// The picture with every texel changed.
    #[must_use]
    pub fn map<const M: usize>(&self, change: impl Fn([f32; N]) -> [f32; M]) -> Texture<M> {
        Texture {
            size: self.size,
            texels: self.texels.iter().map(|&texel| change(texel)).collect(),
        }
    }

    /// The bytes of a PNG file: grey for one sample a texel, red, green and blue for three.
    ///
    /// # Errors
    /// A picture that the format does not hold.
    pub fn to_png(&self, depth: Depth) -> Result<Vec<u8>, RenderError> {
        let color = match N {
            1 => png::ColorType::Grayscale,
            _ => png::ColorType::Rgb,
        };
        let samples = self.texels.as_flattened().iter();
        let (bits, data) = match depth {
            Depth::Eight => {
                let byte = |c: &f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
                (png::BitDepth::Eight, samples.map(byte).collect())
            }
            Depth::Sixteen => {
                let word = |c: &f32| ((c.clamp(0.0, 1.0) * 65535.0).round() as u16).to_be_bytes();
                (
                    png::BitDepth::Sixteen,
                    samples.flat_map(word).collect::<Vec<u8>>(),
                )
            }
        };
        encode_png([self.size; 2], (color, bits), &data)
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    /// As [`Self::to_png`], or the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>, depth: Depth) -> Result<(), RenderError> {
        Ok(io::write_atomic(path, &self.to_png(depth)?)?)
    }
}

/// The texels around one, those beyond the border left out.
fn neighbours(at: usize, size: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (at % size, at / size);
    let around = move |k: usize| k.saturating_sub(1)..=(k + 1).min(size - 1);
    around(y).flat_map(move |row| around(x).map(move |column| row * size + column))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_covered_takes_the_nearest_value() {
        let texture = Texture::padded(5, [(0, [0.25]), (24, [0.75])].into_iter());
        assert_eq!(texture.texel(1, 1), [0.25]);
        assert_eq!(texture.texel(3, 3), [0.75]);
        assert_eq!(texture.texel(4, 0), [0.25]);
    }

    #[test]
    fn sixteen_bits_come_back() {
        let texture = Texture::padded(2, (0..4).map(|k| (k, [k as f32 / 4.0, 0.5, 1.0])));
        let bytes = texture.to_png(Depth::Sixteen).unwrap();
        let picture = super::super::picture::DecodedPicture::decode(&bytes).unwrap();
        // The centre of the texel at the lower left.
        let found = picture.at([0.25, 0.25]);
        assert!(
            (found[0] - 0.5).abs() < 1e-4 && (found[1] - 0.5).abs() < 1e-4,
            "{found:?}"
        );
    }
}

//! Pixels: a picture, pictures beside each other, and PNG files.

use std::path::Path;

use anyhow::Context as _;
use mesh_core::io;

/// Straight (not premultiplied) red, green, blue, alpha.
pub(crate) type Pixel = [u8; 4];

/// Space between pictures that stand beside each other, in pixels.
const GAP: usize = 8;

/// A picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
}

impl Image {
    /// A transparent picture.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[0; 4]; width * height],
        }
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.height
    }

    #[cfg(test)]
    pub(crate) fn pixel(&self, x: usize, y: usize) -> Pixel {
        self.pixels[y * self.width + x]
    }

    pub(crate) fn set_pixel(&mut self, x: usize, y: usize, pixel: Pixel) {
        self.pixels[y * self.width + x] = pixel;
    }

    /// The pictures in one row, tops aligned.
    pub(crate) fn row(images: &[Self]) -> Self {
        let width = images
            .iter()
            .map(|i| i.width + GAP)
            .sum::<usize>()
            .saturating_sub(GAP);
        let height = images.iter().map(|i| i.height).max().unwrap_or(0);
        let mut row = Self::new(width, height);
        let mut left = 0;
        for image in images {
            row.paste(image, left, 0);
            left += image.width + GAP;
        }
        row
    }

    /// The pictures in one column, left sides aligned.
    pub(crate) fn column(images: &[Self]) -> Self {
        let width = images.iter().map(|i| i.width).max().unwrap_or(0);
        let height = images
            .iter()
            .map(|i| i.height + GAP)
            .sum::<usize>()
            .saturating_sub(GAP);
        let mut column = Self::new(width, height);
        let mut top = 0;
        for image in images {
            column.paste(image, 0, top);
            top += image.height + GAP;
        }
        column
    }

    fn paste(&mut self, image: &Self, left: usize, top: usize) {
        for y in 0..image.height {
            let from = y * image.width;
            let to = (top + y) * self.width + left;
            self.pixels[to..to + image.width]
                .copy_from_slice(&image.pixels[from..from + image.width]);
        }
    }

    /// The picture on an opaque background.
    pub(crate) fn over(&self, background: [u8; 3]) -> Self {
        let blend = |front: u8, back: u8, alpha: u8| {
            let alpha = u32::from(alpha);
            ((u32::from(front) * alpha + u32::from(back) * (255 - alpha) + 127) / 255) as u8
        };
        let [r, g, b] = background;
        Self {
            pixels: self
                .pixels
                .iter()
                .map(|p| {
                    [
                        blend(p[0], r, p[3]),
                        blend(p[1], g, p[3]),
                        blend(p[2], b, p[3]),
                        255,
                    ]
                })
                .collect(),
            ..*self
        }
    }

    /// The bytes of a PNG file.
    pub(crate) fn to_png(&self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header().context("cannot encode a picture")?;
        writer
            .write_image_data(self.pixels.as_flattened())
            .context("cannot encode a picture")?;
        writer.finish().context("cannot encode a picture")?;
        Ok(bytes)
    }

    /// Writes a PNG file on a light background.
    pub(crate) fn save(&self, path: &Path) -> anyhow::Result<()> {
        Ok(io::write_atomic(
            path,
            &self.over([250, 250, 248]).to_png()?,
        )?)
    }

    /// The picture as the address of an `<img>`.
    pub(crate) fn data_uri(&self) -> anyhow::Result<String> {
        Ok(format!("data:image/png;base64,{}", base64(&self.to_png()?)))
    }
}

/// Base 64 of RFC 4648, padded.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().enumerate().fold(0u32, |word, (k, &byte)| {
            word | u32::from(byte) << (16 - 8 * k)
        });
        for k in 0..4 {
            text.push(if k <= chunk.len() {
                DIGITS[(word >> (18 - 6 * k)) as usize & 63] as char
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        let coded = ["", "f", "fo", "foo", "foob"].map(|text| base64(text.as_bytes()));
        assert_eq!(coded, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]);
    }

    #[test]
    fn png_decodes_to_the_same_pixels() {
        let mut image = Image::new(3, 2);
        image.set_pixel(2, 1, [10, 20, 30, 255]);
        let bytes = image.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, image.pixels.as_flattened());
    }

    #[test]
    fn rows_and_columns_keep_every_picture() {
        let image = Image::new(10, 20);
        let row = Image::row(&[image.clone(), image.clone()]);
        assert_eq!((row.width(), row.height()), (20 + GAP, 20));
        let column = Image::column(&[row, image]);
        assert_eq!((column.width(), column.height()), (20 + GAP, 40 + GAP));
    }
}

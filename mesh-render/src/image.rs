//! Pixels: a picture, pictures beside each other, and PNG files.

use std::path::Path;

use base64::engine::general_purpose::STANDARD;
use base64::Engine as _;
use mesh_core::io;

use crate::RenderError;

/// Straight (not premultiplied) red, green, blue, alpha.
pub type Pixel = [u8; 4];

/// Space between pictures that stand beside each other, in pixels.
const GAP: usize = 8;

/// A picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
}

impl Image {
    /// A transparent picture.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[0; 4]; width * height],
        }
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
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
    pub fn row(images: &[Self]) -> Self {
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
    pub fn column(images: &[Self]) -> Self {
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
    #[must_use]
    pub fn over(&self, background: [u8; 3]) -> Self {
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
    ///
    /// # Errors
    /// A picture without a pixel.
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        let samples = (png::ColorType::Rgba, png::BitDepth::Eight);
        encode_png(
            [self.width, self.height],
            samples,
            self.pixels.as_flattened(),
        )
    }

    /// Writes a PNG file on a light background.
    ///
    /// # Errors
    /// As [`Self::to_png`], or the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), RenderError> {
        Ok(io::write_atomic(
            path,
            &self.over([250, 250, 248]).to_png()?,
        )?)
    }

    /// The picture as the address of an `<img>`.
    ///
    /// # Errors
    /// As [`Self::to_png`].
    pub fn data_uri(&self) -> Result<String, RenderError> {
        let digits = STANDARD.encode(self.to_png()?);
        Ok(format!("data:image/png;base64,{digits}"))
    }
}

/// The bytes of a PNG file with these samples, rows from the top.
pub(crate) fn encode_png(
    [width, height]: [usize; 2],
    (color, depth): (png::ColorType, png::BitDepth),
    samples: &[u8],
) -> Result<Vec<u8>, RenderError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::High);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(samples)?;
        writer.finish()
    });
    written.map_err(|error| RenderError::Encode(error.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

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

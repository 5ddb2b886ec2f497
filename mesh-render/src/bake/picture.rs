//! The pictures that a target shows, decoded.

use std::io::Cursor;

use mesh_core::io::Rgb;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use super::error::PictureError;

/// Memory that a decoder may take beside the picture itself, in bytes.
const DECODER_MEMORY: usize = 1 << 30;
/// The largest side of a picture, in pixels.
const MOST_PIXELS: usize = 1 << 16;

/// A decoded picture, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct DecodedPicture {
    width: usize,
    height: usize,
    /// Samples of a pixel: 1 or 2 of a grey one, 3 or 4 of a coloured one.
    n_channels: usize,
    samples: Samples,
}

#[derive(Clone, Debug)]
enum Samples {
    Eight(Vec<u8>),
    /// Big-endian, as PNG has them.
    Sixteen(Vec<u8>),
}

impl DecodedPicture {
    /// The picture in a PNG or JPEG file.
    pub(super) fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        let picture = match bytes {
            [0x89, b'P', b'N', b'G', ..] => of_png(bytes)?,
            [0xff, 0xd8, ..] => of_jpeg(bytes)?,
            _ => return Err(PictureError::UnknownFormat),
        };
        match picture.width * picture.height {
            0 => Err(PictureError::Empty),
            _ => Ok(picture),
        }
    }

    /// The colour at texture coordinates, (0, 0) at the lower left: between the four nearest pixels, each axis weighted by
    /// distance. Beyond the unit square the picture repeats.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> Rgb {
        let (x, y) = (self.place(u, self.width), self.place(1.0 - v, self.height));
        let row = |y: usize| mixed(self.pixel(x.low, y), self.pixel(x.high, y), x.share);
        mixed(row(y.low), row(y.high), y.share)
    }

    /// The two pixels on both sides of a place along an axis with `n` of them, and how much of the second counts.
    fn place(&self, at: f64, n: usize) -> Between {
        let wrapped = at - at.floor();
        let pixel = wrapped * n as f64 - 0.5;
        let low = pixel.floor();
        let row = |k: f64| (k.rem_euclid(n as f64) as usize).min(n - 1);
        Between {
            low: row(low),
            high: row(low + 1.0),
            share: (pixel - low) as f32,
        }
    }

    fn pixel(&self, x: usize, y: usize) -> Rgb {
        let first = (y * self.width + x) * self.n_channels;
        let sample = |k: usize| match &self.samples {
            Samples::Eight(bytes) => f32::from(bytes[first + k]) / 255.0,
            Samples::Sixteen(bytes) => {
                let at = 2 * (first + k);
                f32::from(u16::from_be_bytes([bytes[at], bytes[at + 1]])) / 65535.0
            }
        };
        match self.n_channels {
            1 | 2 => [sample(0); 3],
            _ => [sample(0), sample(1), sample(2)],
        }
    }
}

struct Between {
    low: usize,
    high: usize,
    share: f32,
}

fn mixed(a: Rgb, b: Rgb, share: f32) -> Rgb {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}

fn of_png(bytes: &[u8]) -> Result<DecodedPicture, PictureError> {
    let limits = png::Limits {
        bytes: DECODER_MEMORY,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Palettes as colours, fewer than eight bits as eight.
    decoder.set_transformations(png::Transformations::EXPAND);
    let broken = |error: png::DecodingError| PictureError::Broken(error.to_string());
    let mut reader = decoder.read_info().map_err(broken)?;
    let size = reader.output_buffer_size().ok_or(PictureError::Empty)?;
    let mut data = vec![0; size];
    let frame = reader.next_frame(&mut data).map_err(broken)?;
    data.truncate(frame.buffer_size());
    Ok(DecodedPicture {
        width: frame.width as usize,
        height: frame.height as usize,
        n_channels: frame.color_type.samples(),
        samples: match frame.bit_depth {
            png::BitDepth::Sixteen => Samples::Sixteen(data),
            _ => Samples::Eight(data),
        },
    })
}

fn of_jpeg(bytes: &[u8]) -> Result<DecodedPicture, PictureError> {
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(MOST_PIXELS)
        .set_max_height(MOST_PIXELS);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let data = decoder
        .decode()
        .map_err(|error| PictureError::Broken(error.to_string()))?;
    let (width, height) = decoder.dimensions().ok_or(PictureError::Empty)?;
    if data.len() != 3 * width * height {
        return Err(PictureError::Broken(
            "not in red, green and blue".to_owned(),
        ));
    }
    Ok(DecodedPicture {
        width,
        height,
        n_channels: 3,
        samples: Samples::Eight(data),
    })
}

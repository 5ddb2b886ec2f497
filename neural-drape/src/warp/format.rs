//! The bytes of a `.drape` file, all little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `DRAPEWRP` |
//! | 4 | version, u32 |
//! | … | extension: origin, constant, linear part by rows (15 f64), then a list of kernels (6 f64 each) |
//! | … | surface: lists of rest points (3 f64), residuals (3 f64) and triangles (3 u32) |
//! | 1 | how many networks follow, whose offsets are summed |
//! | … | network: frame and output scale (5 f64), waves (kind u8, gain f32, list of rows of 3 f32), for each a list of layers (each a list of biases and a list of weights, f32); nothing where there is none |
//! | 8 | FNV-1a hash of all bytes before |
//!
//! A list is its length as u32, then its entries.

use std::path::Path;

use mesh_core::{Point3, UnitFrame, Vector3};
use mesh_operators::{Kernel, SpaceExtension};
use nalgebra::Matrix3;

use super::{Surface, WarpError};
use crate::network::{Layer, NetworkMap, WaveKind, Waves};

const MAGIC: &[u8; 8] = b"DRAPEWRP";
const VERSION: u32 = 1;

type Parts = (SpaceExtension, Option<NetworkMap>, Surface);

/// What is wrong with the bytes of a warp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FormatError {
    NotAWarp,
    Version(u32),
    Damaged { offset: usize, reason: &'static str },
}

impl FormatError {
    pub(super) fn in_file(self, path: &Path) -> WarpError {
        let path = path.to_owned();
        match self {
            Self::NotAWarp => WarpError::NotAWarp { path },
            Self::Version(found) => WarpError::Version {
                path,
                found,
                supported: VERSION,
            },
            Self::Damaged { offset, reason } => WarpError::Damaged {
                path,
                offset,
                reason,
            },
        }
    }
}

/// The file of a warp.
pub(super) fn encode(
    extension: &SpaceExtension,
    network: Option<&NetworkMap>,
    surface: &Surface,
) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    put_f64(&mut bytes, extension.origin.iter());
    put_f64(&mut bytes, extension.constant.iter());
    put_f64(&mut bytes, extension.linear.transpose().iter());
    put_list(&mut bytes, &extension.kernels, |bytes, k| {
        put_f64(bytes, k.center.iter().chain(k.weight.iter()));
    });
    put_list(&mut bytes, &surface.rest, |bytes, p| {
        put_f64(bytes, p.iter())
    });
    put_list(&mut bytes, &surface.residuals, |bytes, r| {
        put_f64(bytes, r.iter())
    });
    put_list(&mut bytes, &surface.triangles, |bytes, t| {
        bytes.extend(t.iter().flat_map(|v| v.to_le_bytes()));
    });
    let n_networks = network.map_or(0, |network| network.networks.len());
    // There are at most 255 (`NetworkConfig::settings`).
    bytes.push(u8::try_from(n_networks).unwrap_or(u8::MAX));
    if let Some(network) = network {
        put_network(&mut bytes, network);
    }
    let hash = fnv1a(&bytes);
    bytes.extend(hash.to_le_bytes());
    bytes
}

fn put_network(bytes: &mut Vec<u8>, network: &NetworkMap) {
    put_f64(bytes, network.frame.center.iter());
    put_f64(bytes, [network.frame.scale, network.output_scale].iter());
    bytes.push(match network.waves.kind {
        WaveKind::Sine => 0,
        WaveKind::SineCosine => 1,
    });
    put_f32(bytes, &[network.waves.gain]);
    put_list(bytes, &network.waves.rows, |bytes, row| put_f32(bytes, row));
    for layers in &network.networks {
        put_list(bytes, layers, |bytes, layer| {
            put_list(bytes, &layer.bias, |bytes, b| put_f32(bytes, &[*b]));
            put_list(bytes, &layer.weight, |bytes, w| put_f32(bytes, &[*w]));
        });
    }
}

fn put_f64<'a>(bytes: &mut Vec<u8>, values: impl Iterator<Item = &'a f64>) {
    bytes.extend(values.flat_map(|v| v.to_le_bytes()));
}

fn put_f32(bytes: &mut Vec<u8>, values: &[f32]) {
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
}

fn put_list<T>(bytes: &mut Vec<u8>, items: &[T], put: impl Fn(&mut Vec<u8>, &T)) {
    // Vertices, triangles and weights are counted in 32 bits everywhere.
    bytes.extend((items.len() as u32).to_le_bytes());
    for item in items {
        put(bytes, item);
    }
}

/// Reads what [`encode`] wrote.
pub(super) fn decode(bytes: &[u8]) -> Result<Parts, FormatError> {
    if !bytes.starts_with(MAGIC) {
        return Err(FormatError::NotAWarp);
    }
    let mut reader = Reader {
        bytes,
        offset: MAGIC.len(),
    };
    let version = reader.u32()?;
    if version != VERSION {
        return Err(FormatError::Version(version));
    }
    let content = bytes.len().saturating_sub(8).max(reader.offset);
    let hash = u64::from_le_bytes(
        Reader {
            bytes,
            offset: content,
        }
        .take()?,
    );
    if hash != fnv1a(&bytes[..content]) {
        return reader.damaged("its content does not match its checksum");
    }
    reader.bytes = &bytes[..content];

    let extension = reader.extension()?;
    let surface = reader.surface()?;
    let network = match reader.u8()? {
        0 => None,
        n_networks => Some(reader.network(n_networks)?),
    };
    if reader.offset == content {
        Ok((extension, network, surface))
    } else {
        reader.damaged("something follows the end")
    }
}

/// FNV-1a, 64 bits: tells damage, not intent.
pub(super) fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// A place in the bytes of a file.
struct Reader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl Reader<'_> {
    fn damaged<T>(&self, reason: &'static str) -> Result<T, FormatError> {
        Err(FormatError::Damaged {
            offset: self.offset,
            reason,
        })
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        match self.bytes[self.offset..].first_chunk::<N>() {
            Some(chunk) => {
                self.offset += N;
                Ok(*chunk)
            }
            None => self.damaged("it ends too early"),
        }
    }

    fn u8(&mut self) -> Result<u8, FormatError> {
        Ok(u8::from_le_bytes(self.take()?))
    }

    fn u32(&mut self) -> Result<u32, FormatError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn f32(&mut self) -> Result<f32, FormatError> {
        let value = f32::from_le_bytes(self.take()?);
        if value.is_finite() {
            Ok(value)
        } else {
            self.damaged("a number is not finite")
        }
    }

    fn f64(&mut self) -> Result<f64, FormatError> {
        let value = f64::from_le_bytes(self.take()?);
        if value.is_finite() {
            Ok(value)
        } else {
            self.damaged("a number is not finite")
        }
    }

    fn vector(&mut self) -> Result<Vector3, FormatError> {
        Ok(Vector3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    fn point(&mut self) -> Result<Point3, FormatError> {
        Ok(Point3::from(self.vector()?))
    }

    /// A list whose items take at least `size` bytes each: its length is believed only if they are there.
    fn list<T>(
        &mut self,
        size: usize,
        mut item: impl FnMut(&mut Self) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        let n = self.u32()? as usize;
        if n > (self.bytes.len() - self.offset) / size {
            return self.damaged("a list is longer than the file");
        }
        let mut items = Vec::with_capacity(n);
        for _ in 0..n {
            items.push(item(self)?);
        }
        Ok(items)
    }

    fn extension(&mut self) -> Result<SpaceExtension, FormatError> {
        let (origin, constant) = (self.point()?, self.vector()?);
        let rows = [self.vector()?, self.vector()?, self.vector()?];
        let kernels = self.list(48, |r| {
            Ok(Kernel {
                center: r.point()?,
                weight: r.vector()?,
            })
        })?;
        Ok(SpaceExtension {
            kernels,
            origin,
            linear: Matrix3::from_rows(&rows.map(|row| row.transpose())),
            constant,
        })
    }

    fn surface(&mut self) -> Result<Surface, FormatError> {
        let rest = self.list(24, Self::point)?;
        let residuals = self.list(24, Self::vector)?;
        let triangles = self.list(12, |r| Ok([r.u32()?, r.u32()?, r.u32()?]))?;
        if residuals.len() != rest.len() {
            return self.damaged("not one residual for each vertex");
        }
        if triangles
            .iter()
            .flatten()
            .any(|&v| v as usize >= rest.len())
        {
            return self.damaged("a triangle names a vertex that is not there");
        }
        Ok(Surface {
            rest,
            triangles,
            residuals,
        })
    }

    /// A map with this many networks.
    fn network(&mut self, n_networks: u8) -> Result<NetworkMap, FormatError> {
        let frame = UnitFrame {
            center: self.point()?,
            scale: self.f64()?,
        };
        let output_scale = self.f64()?;
        let kind = match self.u8()? {
            0 => WaveKind::Sine,
            1 => WaveKind::SineCosine,
            _ => return self.damaged("an unknown kind of waves"),
        };
        let gain = self.f32()?;
        let rows = self.list(12, |r| Ok([r.f32()?, r.f32()?, r.f32()?]))?;
        let layer = |r: &mut Self| {
            Ok(Layer {
                bias: r.list(4, Self::f32)?,
                weight: r.list(4, Self::f32)?,
            })
        };
        let networks = (0..n_networks).map(|_| self.list(8, layer));
        let networks = networks.collect::<Result<Vec<_>, _>>()?;
        let network = NetworkMap {
            frame,
            output_scale,
            waves: Waves { rows, gain, kind },
            networks,
        };
        if network.is_consistent() {
            Ok(network)
        } else {
            self.damaged("the layers of the network do not fit together")
        }
    }
}

//! Landmarks and settings from text, for programs that hold them in memory.

use mesh_core::{Landmark, Point3, PolygonSoup};
use neural_drape::DrapeConfig;

use crate::input::Source;
use crate::seams::Seams;
use crate::{landmarks, settings};

/// The landmarks in the text of a landmark file, of either form (see the README), on a source and a target given by
/// its vertices. `names` has a name per line, for the plain form.
///
/// # Errors
/// The first landmark that does not read or whose place does not exist; a source without a face of three corners.
///
/// ```
/// use mesh_core::{shapes, Point3};
/// let text = r#"{"landmarks": [{"name": "tip", "source": {"vertex": 3}, "target": {"point": [0, 0, 1]}}]}"#;
/// let landmarks = drape_cli::read_landmarks(text, None, shapes::tetrahedron(), &[])?;
/// assert_eq!(landmarks[0].target, Point3::new(0.0, 0.0, 1.0));
/// # Ok::<(), anyhow::Error>(())
/// ```
pub fn read_landmarks(
    text: &str,
    names: Option<&str>,
    source: PolygonSoup,
    target: &[Point3],
) -> anyhow::Result<Vec<Landmark>> {
    landmarks::from_text(text, names)?.resolve(&Source::new(source, Seams::EXACT)?, target)
}

/// The settings in the text of a settings file, over those of the preset that it names.
///
/// # Errors
/// A line that does not read, or a name that is no setting. Ranges are checked by [`DrapeConfig::check`].
///
/// ```
/// assert_eq!(drape_cli::read_settings("preset = \"standard\"\nseed = 7\n")?.seed, 7);
/// # Ok::<(), anyhow::Error>(())
/// ```
pub fn read_settings(text: &str) -> anyhow::Result<DrapeConfig> {
    Ok(settings::from_text(text)?.config)
}

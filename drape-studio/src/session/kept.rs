//! Results that are kept beside the drape in progress.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::file::InputRecord;

/// A result that was kept: what it is of. Its shape and its drape are files beside the session, under its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kept {
    /// Its number as long as the session lives.
    pub(crate) id: u32,
    pub(crate) source: InputRecord,
    pub(crate) target: InputRecord,
    /// How many iterations led to it.
    pub(crate) iteration: usize,
    /// FNV-1a hash of its positions: one result is kept once.
    pub(crate) fnv1a: String,
    /// What the judge found, once it has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) figures: Option<Value>,
}

/// Settings under a name of the user's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct NamedSettings {
    pub(crate) name: String,
    /// The settings, as TOML.
    pub(crate) toml: String,
}

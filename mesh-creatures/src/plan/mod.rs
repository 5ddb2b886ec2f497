//! Body plans: what a kind of creature is made of.

mod bird;
mod builder;
mod head;
mod insect;
mod person;
mod quadruped;

use std::fmt;
use std::str::FromStr;

use builder::Builder;

use crate::cage::Cage;
use crate::proportions::Proportions;
use crate::skeleton::Skeleton;

/// A kind of creature. All individuals of a plan have the same vertices, faces and parts.
///
/// Creatures stand upright along +Y and look along +Z; their left is at +X.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Plan {
    /// An animal with four legs, ears and a tail.
    Quadruped,
    /// A person with arms, legs and fingers.
    Person,
    /// A bird with wings, tail feathers and toes.
    Bird,
    /// An insect with six legs and antennae.
    Insect,
    /// A head with eyes, ears, nose and an open mouth.
    Head,
}

/// The control mesh of an individual at rest, and its skeleton.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) cage: Cage,
    pub(crate) skeleton: Skeleton,
}

impl Plan {
    /// All there are.
    pub const ALL: [Self; 5] = [
        Self::Quadruped,
        Self::Person,
        Self::Bird,
        Self::Insect,
        Self::Head,
    ];

    /// Its name, in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quadruped => "quadruped",
            Self::Person => "person",
            Self::Bird => "bird",
            Self::Insect => "insect",
            Self::Head => "head",
        }
    }

    pub(crate) fn body(self, proportions: &Proportions) -> Body {
        let build = match self {
            Self::Quadruped => quadruped::build,
            Self::Person => person::build,
            Self::Bird => bird::build,
            Self::Insect => insect::build,
            Self::Head => head::build,
        };
        let mut template = Builder::default();
        build(&mut template, &Proportions::TEMPLATE);
        let mut builder = Builder::following(template);
        build(&mut builder, proportions);
        builder.finished()
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no plan has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownPlan;

impl fmt::Display for UnknownPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("use quadruped, person, bird, insect or head")
    }
}

impl std::error::Error for UnknownPlan {}

impl FromStr for Plan {
    type Err = UnknownPlan;

    fn from_str(name: &str) -> Result<Self, UnknownPlan> {
        Self::ALL
            .into_iter()
            .find(|plan| plan.name() == name)
            .ok_or(UnknownPlan)
    }
}

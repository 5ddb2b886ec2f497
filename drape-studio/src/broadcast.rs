//! What every open page is shown: the newest of each kind, older ones are passed over.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::Bytes;
use mesh_core::Positions;
use mesh_metrics::Counterparts;
use neural_drape::network::NetworkMap;
use neural_drape::StepReport;
use serde::{Deserialize, Serialize};
use tokio::sync::watch;

use crate::buffers::position_bytes;
use crate::displayed::DisplayedPair;
use crate::session::RunLog;

/// Points that a curve is sent with at most.
const MAX_CURVE: usize = 600;

/// What a shape in the result's view is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShownKind {
    /// The source brought to its landmarks.
    Initial = 0,
    /// The drape, as far as it is.
    Draped = 1,
    /// How the drape would go on with the landmarks as they are.
    Adjusted = 2,
}

/// A shape of the source.
pub(crate) struct ShownShape {
    pub(crate) serial: u32,
    pub(crate) kind: ShownKind,
    pub(crate) positions: Arc<Positions>,
    /// How a drape came to it; none for other shapes.
    pub(crate) provenance: Option<Provenance>,
    /// The message that carries it: four u32 (1, serial, kind, iteration), then f32 positions.
    pub(crate) message: Bytes,
}

/// How a drape came to a shape.
pub(crate) struct Provenance {
    pub(crate) log: RunLog,
    pub(crate) network: Option<NetworkMap>,
    /// What of the two shapes is compared.
    pub(crate) counterparts: Arc<Counterparts>,
}

impl ShownShape {
    /// What of it and of the target is compared.
    pub(crate) fn counterparts(&self) -> Arc<Counterparts> {
        let known = self.provenance.as_ref();
        known.map_or_else(
            || Arc::new(Counterparts::all(self.positions.len())),
            |p| Arc::clone(&p.counterparts),
        )
    }

    /// How many iterations led to it.
    pub(crate) fn iteration(&self) -> usize {
        self.provenance.as_ref().map_or(0, |p| p.log.iteration)
    }
}

/// The newest of everything.
pub(crate) struct Broadcast {
    pub(crate) state: watch::Sender<Arc<str>>,
    pub(crate) progress: watch::Sender<Arc<str>>,
    pub(crate) figures: watch::Sender<Arc<str>>,
    pub(crate) shown: watch::Sender<Option<Arc<ShownShape>>>,
    shared: Mutex<Shared>,
}

#[derive(Default)]
struct Shared {
    displayed: Option<DisplayedPair>,
    serial: u32,
    draped: Option<Arc<ShownShape>>,
    curves: Vec<Curve>,
}

/// A figure over the iterations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Curve {
    pub(crate) name: String,
    pub(crate) points: Vec<(usize, f64)>,
}

impl Broadcast {
    pub(crate) fn new() -> Self {
        let empty = || watch::Sender::new(Arc::from(""));
        Self {
            state: empty(),
            progress: empty(),
            figures: empty(),
            shown: watch::Sender::new(None),
            shared: Mutex::new(Shared::default()),
        }
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is shown belongs to this pair from now on.
    pub(crate) fn set_displayed(&self, displayed: Option<DisplayedPair>) {
        let mut shared = self.shared();
        shared.displayed = displayed;
        shared.curves.clear();
        shared.draped = None;
        drop(shared);
        self.shown.send_replace(None);
        self.figures.send_replace(Arc::from(""));
        self.progress.send_replace(Arc::from(""));
    }

    pub(crate) fn displayed(&self) -> Option<DisplayedPair> {
        self.shared().displayed.clone()
    }

    /// Shows what landmarks would give. Where there is a drape, an initial shape comes too late and is not shown.
    pub(crate) fn show(&self, displayed: &DisplayedPair, kind: ShownKind, x: Arc<Positions>) {
        self.put(displayed, kind, x, None);
    }

    /// Shows a drape as far as it is.
    pub(crate) fn show_drape(
        &self,
        displayed: &DisplayedPair,
        x: Arc<Positions>,
        provenance: Provenance,
    ) {
        self.put(displayed, ShownKind::Draped, x, Some(provenance));
    }

    fn put(
        &self,
        displayed: &DisplayedPair,
        kind: ShownKind,
        x: Arc<Positions>,
        provenance: Option<Provenance>,
    ) {
        let mut shared = self.shared();
        if kind == ShownKind::Initial && shared.draped.is_some() {
            return;
        }
        shared.serial = shared.serial.wrapping_add(1);
        let serial = shared.serial;
        let iteration = provenance.as_ref().map_or(0, |p| p.log.iteration);
        let mut message = Vec::with_capacity(16 + 12 * x.len());
        for n in [1, serial, kind as u32, iteration as u32] {
            message.extend(n.to_le_bytes());
        }
        message.extend(position_bytes(&displayed.target.frame, &x));
        let shown = Arc::new(ShownShape {
            serial,
            kind,
            positions: x,
            provenance,
            message: message.into(),
        });
        if kind == ShownKind::Draped {
            shared.draped = Some(Arc::clone(&shown));
        }
        self.shown.send_replace(Some(shown));
    }

    /// The drape as it was last shown.
    pub(crate) fn draped(&self) -> Option<Arc<ShownShape>> {
        self.shared().draped.clone()
    }

    /// Shows the drape again, after a shape that it might have taken; whether that was shown.
    pub(crate) fn show_drape_again(&self) -> bool {
        let draped = self.draped();
        let is_other = |shown: &Option<Arc<ShownShape>>| {
            shown.as_ref().map(|s| s.serial) != draped.as_ref().map(|s| s.serial)
        };
        let is_needed = draped.is_some() && is_other(&self.shown.borrow());
        if is_needed {
            self.shown.send_replace(draped);
        }
        is_needed
    }

    /// There is no drape any more.
    pub(crate) fn forget_drape(&self) {
        let mut shared = self.shared();
        shared.draped = None;
        shared.curves.clear();
        self.progress.send_replace(Arc::from(""));
    }

    /// Records the terms of a step.
    pub(crate) fn record_step(&self, step: &StepReport) {
        let mut shared = self.shared();
        shared.record("loss", step.iteration, step.total);
        for term in &step.terms {
            shared.record(term.name, step.iteration, term.value * term.weight);
        }
    }

    /// Records a figure of the judge.
    pub(crate) fn record(&self, name: &str, iteration: usize, value: f64) {
        self.shared().record(name, iteration, value);
    }

    /// Every curve, thinned out.
    pub(crate) fn curves(&self) -> Vec<Curve> {
        let shared = self.shared();
        let thin = |curve: &Curve| {
            let stride = curve.points.len().div_ceil(MAX_CURVE).max(1);
            let last = curve.points.len().saturating_sub(1);
            let kept = curve.points.iter().enumerate();
            let kept = kept.filter(|(k, _)| k % stride == 0 || *k == last);
            Curve {
                name: curve.name.clone(),
                points: kept.map(|(_, &p)| p).collect(),
            }
        };
        shared.curves.iter().map(thin).collect()
    }

    /// The curves of a drape that goes on.
    pub(crate) fn set_curves(&self, curves: Vec<Curve>) {
        self.shared().curves = curves;
    }
}

impl Shared {
    /// An iteration has one value: the newest.
    fn record(&mut self, name: &str, iteration: usize, value: f64) {
        let known = self.curves.iter().position(|curve| curve.name == name);
        let row = known.unwrap_or_else(|| {
            self.curves.push(Curve {
                name: name.to_owned(),
                points: Vec::new(),
            });
            self.curves.len() - 1
        });
        let points = &mut self.curves[row].points;
        if points.last().is_some_and(|(at, _)| *at == iteration) {
            points.pop();
        }
        points.push((iteration, value));
    }
}

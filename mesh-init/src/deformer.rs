//! The deformation of a placed shape by what pulls at its vertices, kept ready for other goals.

use mesh_core::{
    Landmark, LandmarkKind, Point3, Positions, Triangulation, UnitFrame, Vector3, VertexId,
};
use mesh_operators::{geodesic_distance_unfolded, SolveError, SpaceExtension};

use crate::reach::is_reached;
use crate::{
    ArapSolver, BiharmonicSolver, InitConfig, InitError, Pinning, PulledVertex, SimilarSolver,
    Spread,
};

/// Rigid landmarks move what lies within this geodesic distance, in longest sides of the box (the authors' program).
const RIGID_REACH: f64 = 0.25;
/// A field that pieces without a landmark follow has at most this many centres.
const MAX_CENTRES: usize = 1000;

/// What a landmark pulls at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pull {
    /// The vertex that it holds.
    pub(crate) vertex: VertexId,
    /// From the place of the landmark to the vertex, in the placed shape.
    pub(crate) offset: Vector3,
    pub(crate) kind: LandmarkKind,
    pub(crate) strength: Strength,
}

/// How strongly a landmark or a handle is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// What it counts where landmarks are weighed against each other and the surface.
    pub(crate) pull: f64,
    /// The share of the way to its place that it is brought where it is held; 1 and more are all of it.
    pub(crate) hold: f64,
}

impl Strength {
    pub(crate) fn of(landmark: &Landmark) -> Self {
        Self {
            pull: landmark.pull(),
            hold: landmark.weight,
        }
    }

    /// Of a handle at which another landmark pulls, too: together they pull no more than the stronger, or than one of
    /// weight 1.
    fn with(self, other: Self) -> Self {
        let most = self.pull.max(other.pull).max(1.0);
        Self {
            pull: (self.pull + other.pull).min(most),
            hold: self.hold.max(other.hold),
        }
    }
}

/// A vertex at which landmarks pull.
#[derive(Clone, Copy, Debug)]
struct Handle {
    vertex: VertexId,
    kind: LandmarkKind,
    strength: Strength,
}

/// A shape with all that a deformation of it needs but the goals: its systems are factored.
#[derive(Clone, Debug)]
pub(crate) struct Deformer {
    triangulation: Triangulation,
    frame: UnitFrame,
    /// The shape in the frame of its box.
    start: Positions,
    pulls: Vec<Pull>,
    /// The handle of each pull, and those of each kind.
    handle_of: Vec<usize>,
    handles: Vec<Handle>,
    all: Option<Field>,
    rigid: Option<Rigid>,
    /// Vertices with a handle on their piece, and those without.
    guided: Vec<VertexId>,
    extrapolated: Vec<VertexId>,
}

/// Where handles belong, and where they were, in the frame of the box.
type Goals = Vec<Point3>;

impl Deformer {
    /// Prepares the shape `placed`. Pulls at one vertex make one handle, rigid where any of them is.
    pub(crate) fn new(
        triangulation: Triangulation,
        placed: &Positions,
        pulls: Vec<Pull>,
        config: &InitConfig,
    ) -> Result<Self, InitError> {
        let frame = UnitFrame::principal(placed.as_slice());
        let start = placed.map(|p| frame.to_unit(p));
        let mut handles: Vec<Handle> = Vec::new();
        let mut handle_of = Vec::with_capacity(pulls.len());
        for pull in &pulls {
            let known = handles.iter().position(|h| h.vertex == pull.vertex);
            let row = known.unwrap_or(handles.len());
            if known.is_some() {
                handles[row].add(pull);
            } else {
                handles.push(Handle::of(pull));
            }
            handle_of.push(row);
        }
        let rows: Vec<VertexId> = handles.iter().map(|h| h.vertex).collect();
        let is_guided = is_reached(&triangulation, &rows);
        let (guided, extrapolated) = start.ids().partition(|&v| is_guided[v]);
        let (mut all, mut rigid) = (None, None);
        if !rows.is_empty() {
            let shape = Shape {
                triangulation: &triangulation,
                start: &start,
            };
            all = Some(Field::new(&shape, &handles, config)?);
            rigid = Rigid::new(&shape, &handles, config)?;
        }
        Ok(Self {
            triangulation,
            frame,
            start,
            pulls,
            handle_of,
            handles,
            all,
            rigid,
            guided,
            extrapolated,
        })
    }

    /// The longest side of the box of the placed shape.
    pub(crate) fn size(&self) -> f64 {
        self.frame.scale
    }

    /// How many vertices are moved by the field over space, since no handle is on their piece.
    pub(crate) fn n_extrapolated(&self) -> usize {
        if self.handles.is_empty() {
            0
        } else {
            self.extrapolated.len()
        }
    }

    /// Where the vertices go when each landmark belongs to its target; without a handle nothing moves.
    pub(crate) fn solve(&self, targets: &[Point3]) -> Result<Positions, InitError> {
        let Some(all) = &self.all else {
            return Ok(self.start.map(|p| self.frame.from_unit(p)));
        };
        let shape = Shape {
            triangulation: &self.triangulation,
            start: &self.start,
        };
        let goals = self.goals(targets);
        let mut x = all.solve(&shape, &goals);
        if let Some(rigid) = &self.rigid {
            x = rigid.turn(&shape, &self.handles, &goals, &x)?;
        }
        self.extrapolate(&mut x)?;
        Ok(x.map(|p| self.frame.from_unit(p)))
    }

    /// By how much the vertex of each landmark misses where it belongs, in the coordinates of the shape.
    pub(crate) fn misses(&self, targets: &[Point3], x: &Positions) -> Vec<Vector3> {
        let goals = self.goals(targets);
        let handles = self.handle_of.iter();
        let goals = handles.map(|&handle| self.frame.from_unit(&goals[handle]));
        let pulls = self.pulls.iter().zip(goals);
        pulls.map(|(pull, goal)| goal - x[pull.vertex]).collect()
    }

    /// Where each handle belongs: the target of its landmark, moved by the offset; the mean where there are several, by what
    /// they count.
    fn goals(&self, targets: &[Point3]) -> Goals {
        assert_eq!(
            targets.len(),
            self.pulls.len(),
            "one target for each landmark"
        );
        let mut goals = vec![(Point3::origin(), 0.0); self.handles.len()];
        let pulls = self.pulls.iter().zip(targets).zip(&self.handle_of);
        for ((pull, target), &handle) in pulls {
            let goal = self.frame.to_unit(&(target + pull.offset));
            let (mean, total) = &mut goals[handle];
            let is_first = *total == 0.0;
            *total += pull.strength.pull;
            if is_first {
                *mean = goal;
            } else {
                *mean += (goal - *mean) * pull.strength.pull / *total;
            }
        }
        goals.into_iter().map(|(mean, _)| mean).collect()
    }

    /// Vertices without a handle on their piece follow the field of those with one.
    fn extrapolate(&self, x: &mut Positions) -> Result<(), SolveError> {
        if self.extrapolated.is_empty() {
            return Ok(());
        }
        let points: Vec<Point3> = self.guided.iter().map(|&v| self.start[v]).collect();
        let moves: Vec<Vector3> = self.guided.iter().map(|&v| x[v] - self.start[v]).collect();
        let field = SpaceExtension::new(&points, &moves, MAX_CENTRES)?;
        for &v in &self.extrapolated {
            x[v] = self.start[v] + field.displacement_at(&self.start[v]);
        }
        Ok(())
    }
}

/// The surface where it was placed, in the frame of its box.
struct Shape<'a> {
    triangulation: &'a Triangulation,
    start: &'a Positions,
}

impl Shape<'_> {
    /// Vertices that a path along the surface joins to one of `rows`, but farther than `reach`.
    fn farther_than(&self, reach: f64, rows: &[VertexId]) -> Vec<VertexId> {
        let distance = geodesic_distance_unfolded(self.triangulation, self.start, rows);
        let is_far = |v: &VertexId| distance[*v].is_finite() && distance[*v] > reach;
        distance.ids().filter(is_far).collect()
    }
}

/// The smooth deformation of the pieces with a handle; the others stay.
#[derive(Clone, Debug)]
struct Field {
    handles: Vec<Handle>,
    n_pinned: usize,
    biharmonic: BiharmonicSolver,
    /// What handles of weights below 1 are brought from.
    strong: Strong,
    similar: Option<SimilarSolver>,
}

/// The field of the handles that are brought to their places all the way.
#[derive(Clone, Debug)]
enum Strong {
    /// All are.
    All,
    /// None is: nothing moves.
    None,
    /// Those of these rows.
    Some(Vec<usize>, Box<BiharmonicSolver>),
}

impl Field {
    fn new(shape: &Shape<'_>, handles: &[Handle], config: &InitConfig) -> Result<Self, SolveError> {
        let vertices: Vec<VertexId> = handles.iter().map(|h| h.vertex).collect();
        let pinned = match config.pinning {
            Pinning::None => Vec::new(),
            Pinning::Beyond(reach) => shape.farther_than(reach, &vertices),
        };
        let similar = match config.spread {
            Spread::Biharmonic => None,
            Spread::Similar(config) => Some(SimilarSolver::new(
                shape.triangulation,
                shape.start,
                &handles.iter().map(Handle::pulled).collect::<Vec<_>>(),
                config,
            )?),
        };
        let held = [vertices, pinned.clone()].concat();
        Ok(Self {
            biharmonic: BiharmonicSolver::new(shape.triangulation, shape.start, &held)?,
            strong: Strong::new(shape, handles, &pinned)?,
            handles: handles.to_vec(),
            n_pinned: pinned.len(),
            similar,
        })
    }

    fn solve(&self, shape: &Shape<'_>, goals: &[Point3]) -> Positions {
        let moves = self.handles.iter().zip(goals);
        let mut moves: Vec<Vector3> = moves
            .map(|(h, goal)| goal - shape.start[h.vertex])
            .collect();
        self.strong.weaken(&mut moves, &self.handles, self.n_pinned);
        moves.resize(goals.len() + self.n_pinned, Vector3::zeros());
        let d = self.biharmonic.solve(&moves);
        let biharmonic = shape.start.iter().zip(&d).map(|(p, d)| p + d).collect();
        match &self.similar {
            None => biharmonic,
            Some(similar) => similar.solve(goals, &biharmonic),
        }
    }
}

impl Strong {
    fn new(shape: &Shape<'_>, handles: &[Handle], pinned: &[VertexId]) -> Result<Self, SolveError> {
        let rows = (0..handles.len()).filter(|&h| handles[h].strength.hold >= 1.0);
        let rows: Vec<usize> = rows.collect();
        if rows.len() == handles.len() {
            return Ok(Self::All);
        }
        if rows.is_empty() {
            return Ok(Self::None);
        }
        let held = rows.iter().map(|&h| handles[h].vertex);
        let held: Vec<VertexId> = held.chain(pinned.iter().copied()).collect();
        let field = BiharmonicSolver::new(shape.triangulation, shape.start, &held)?;
        Ok(Self::Some(rows, Box::new(field)))
    }

    /// Takes back, from the moves of handles with weights below 1, the share of what the others leave that they do not go.
    fn weaken(&self, moves: &mut [Vector3], handles: &[Handle], n_pinned: usize) {
        let without = match self {
            Self::All => return,
            Self::None => None,
            Self::Some(rows, field) => {
                let mut strong: Vec<Vector3> = rows.iter().map(|&h| moves[h]).collect();
                strong.resize(rows.len() + n_pinned, Vector3::zeros());
                Some(field.solve(&strong))
            }
        };
        for (handle, way) in handles.iter().zip(moves) {
            let from = without
                .as_ref()
                .map_or(Vector3::zeros(), |d| d[handle.vertex]);
            if handle.strength.hold < 1.0 {
                *way = from + (*way - from) * handle.strength.hold;
            }
        }
    }
}

impl Handle {
    fn of(pull: &Pull) -> Self {
        Self {
            vertex: pull.vertex,
            kind: pull.kind,
            strength: pull.strength,
        }
    }

    /// Lets another landmark pull at the same vertex.
    fn add(&mut self, pull: &Pull) {
        if pull.kind == LandmarkKind::Rigid {
            self.kind = LandmarkKind::Rigid;
        }
        self.strength = self.strength.with(pull.strength);
    }

    fn pulled(&self) -> PulledVertex {
        PulledVertex {
            vertex: self.vertex,
            weight: self.strength.pull,
        }
    }
}

/// What turns as one around rigid handles, in the shape that the soft ones gave.
#[derive(Clone, Debug)]
struct Rigid {
    /// Rows of the soft handles, and their field where there are any.
    soft: Vec<usize>,
    field: Option<Field>,
    /// Rows of all handles, the rigid ones first, then the vertices that stay where the soft ones put them.
    order: Vec<usize>,
    far: Vec<VertexId>,
    /// The solver where no soft handle changes the shape that turns.
    solver: Option<ArapSolver>,
}

impl Rigid {
    /// None where no handle is rigid.
    fn new(
        shape: &Shape<'_>,
        handles: &[Handle],
        config: &InitConfig,
    ) -> Result<Option<Self>, SolveError> {
        let (rigid, soft): (Vec<usize>, Vec<usize>) =
            (0..handles.len()).partition(|&h| handles[h].kind == LandmarkKind::Rigid);
        if rigid.is_empty() {
            return Ok(None);
        }
        let vertices = |rows: &[usize]| rows.iter().map(|&h| handles[h].vertex).collect::<Vec<_>>();
        let mut far = shape.farther_than(RIGID_REACH, &vertices(&rigid));
        far.retain(|v| handles.iter().all(|h| h.vertex != *v));
        let order = [&rigid[..], &soft].concat();
        let (mut field, mut solver) = (None, None);
        if soft.is_empty() {
            let held = [vertices(&order), far.clone()].concat();
            solver = Some(ArapSolver::new(shape.triangulation, shape.start, &held)?);
        } else {
            let soft: Vec<Handle> = soft.iter().map(|&h| handles[h]).collect();
            field = Some(Field::new(shape, &soft, config)?);
        }
        Ok(Some(Self {
            soft,
            field,
            order,
            far,
            solver,
        }))
    }

    fn turn(
        &self,
        shape: &Shape<'_>,
        handles: &[Handle],
        goals: &[Point3],
        guess: &Positions,
    ) -> Result<Positions, SolveError> {
        let mut targets: Vec<Point3> = self.order.iter().map(|&h| goals[h]).collect();
        let Some(field) = &self.field else {
            targets.extend(self.far.iter().map(|&v| shape.start[v]));
            let solver = self.solver.as_ref().expect("it is made where no field is");
            return Ok(solver.solve(&targets, guess));
        };
        let soft: Vec<Point3> = self.soft.iter().map(|&h| goals[h]).collect();
        let base = field.solve(shape, &soft);
        targets.extend(self.far.iter().map(|&v| base[v]));
        let held = self.order.iter().map(|&h| handles[h].vertex);
        let held: Vec<VertexId> = held.chain(self.far.iter().copied()).collect();
        Ok(ArapSolver::new(shape.triangulation, &base, &held)?.solve(&targets, guess))
    }
}

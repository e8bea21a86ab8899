//! A function with its tapes, and what it is shortened to where a box decides minima and maxima.
//!
//! *Based on:* `fidget::render::RenderHandle`, which Fidget's renderer and mesher use: the last
//! shortened function is kept, because neighbouring octants often decide alike, and memory goes round.
//! On which levels shortening pays differs from surface to surface, and is tried out.

use std::{
    fmt,
    sync::{Arc, OnceLock},
};

use fidget::eval::{BulkEvaluator, Function, Tape, TracingEvaluator};

/// Which octants get a shortened function of their own, if their box decides a minimum or a maximum:
/// those of `2^finest` voxels an axis, and of every `step`-th level above them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortening {
    /// Levels between these octants and the voxels, at least 1.
    pub finest: u32,
    /// 1 for every level above, 2 for every second one.
    pub step: u32,
}

impl Shortening {
    /// One function for everything.
    pub const NEVER: Self = Self { finest: u32::MAX, step: 1 };

    /// Whether octants this many levels above the voxels are concerned.
    pub fn is_on(self, height: u32) -> bool {
        height.checked_sub(self.finest).is_some_and(|above| above.is_multiple_of(self.step))
    }
}

/// Such as `, shortened to 8³`.
impl fmt::Display for Shortening {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NEVER => Ok(()),
            Self { finest, step: 1 } => write!(f, ", shortened to {}³", 1 << finest),
            Self { finest, .. } => write!(f, ", every 2nd level to {}³", 1 << finest),
        }
    }
}

type BoxTape<F> = <<F as Function>::IntervalEval as TracingEvaluator>::Tape;
type GradientTape<F> = <<F as Function>::GradSliceEval as BulkEvaluator>::Tape;

/// A function and its tapes, which are made when they are needed and shared by all threads.
pub struct Program<F: Function> {
    /// The function.
    pub function: F,
    box_tape: OnceLock<BoxTape<F>>,
    gradient_tape: OnceLock<GradientTape<F>>,
}

impl<F: Function> Program<F> {
    /// A program without tapes.
    pub fn new(function: F) -> Self {
        Self { function, box_tape: OnceLock::new(), gradient_tape: OnceLock::new() }
    }
}

/// The last that a program was shortened to.
pub type Last<F> = Option<Box<Shortened<F>>>;

/// What a program is where a trace holds.
pub struct Shortened<F: Function> {
    trace: F::Trace,
    /// The same program where the trace made it no shorter.
    pub program: Arc<Program<F>>,
    /// What this was shortened to in turn.
    pub last: Last<F>,
}

/// Memory to be used again.
pub struct Spare<F: Function> {
    tapes: Vec<F::TapeStorage>,
    functions: Vec<F::Storage>,
    workspace: F::Workspace,
}

impl<F: Function> Default for Spare<F> {
    fn default() -> Self {
        Self { tapes: Vec::new(), functions: Vec::new(), workspace: F::Workspace::default() }
    }
}

impl<F: Function> Spare<F> {
    /// For intervals.
    pub fn box_tape<'a>(&mut self, program: &'a Program<F>) -> &'a BoxTape<F> {
        let mut storage = || self.tapes.pop().unwrap_or_default();
        program.box_tape.get_or_init(|| program.function.interval_tape(storage()))
    }

    /// For gradients.
    pub fn gradient_tape<'a>(&mut self, program: &'a Program<F>) -> &'a GradientTape<F> {
        let mut storage = || self.tapes.pop().unwrap_or_default();
        program.gradient_tape.get_or_init(|| program.function.grad_slice_tape(storage()))
    }

    /// What `program` is where `trace` holds.
    pub fn shorten<'a>(
        &mut self,
        program: &Arc<Program<F>>,
        last: &'a mut Last<F>,
        trace: &F::Trace,
    ) -> &'a mut Shortened<F> {
        if last.as_ref().is_some_and(|last| last.trace != *trace) {
            self.take_back(last.take());
        }
        last.get_or_insert_with(|| {
            let storage = self.functions.pop().unwrap_or_default();
            let function = program.function.simplify(trace, storage, &mut self.workspace).unwrap();
            let program = if function.size() < program.function.size() {
                Arc::new(Program::new(function))
            } else {
                self.functions.extend(function.recycle());
                program.clone()
            };
            Box::new(Shortened { trace: trace.clone(), program, last: None })
        })
    }

    /// Takes apart what will not be entered again.
    pub fn take_back(&mut self, last: Last<F>) {
        if let Some(shortened) = last {
            self.take_back(shortened.last);
            self.take_program(shortened.program);
        }
    }

    /// Takes a program apart, unless somebody else still needs it.
    pub fn take_program(&mut self, program: Arc<Program<F>>) {
        if let Some(Program { function, box_tape, gradient_tape }) = Arc::into_inner(program) {
            self.tapes.extend(box_tape.into_inner().and_then(Tape::recycle));
            self.tapes.extend(gradient_tape.into_inner().and_then(Tape::recycle));
            self.functions.extend(function.recycle());
        }
    }
}

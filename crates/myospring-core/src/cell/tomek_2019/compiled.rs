//! The equations as a tape, recorded from those of one cell.

use super::equations::{BEHIND, Constants, Form, Outside, derivatives};
use super::parameters::Parameters;
use crate::cell::land_2017::{Myofilaments, NUMBERS, STATES as MYOFILAMENTS};
use crate::cell::tape::graph::{Graph, Id, Outer};
use crate::cell::tape::{Compiled, Program, Traced};
use std::cell::RefCell;
use std::sync::{Arc, LazyLock};

static PROGRAMS: [LazyLock<Arc<Program>>; 3] = [
    LazyLock::new(|| Arc::new(program(Form::Published))),
    LazyLock::new(|| Arc::new(program(Form::MovingChloride))),
    LazyLock::new(|| Arc::new(program(Form::Land))),
];

/// The tape with the numbers of a cell; `calcium` is the index of that state.
pub(super) fn compiled(constants: &Constants<f64>, calcium: usize) -> Compiled {
    let program: &Arc<Program> = match constants.form {
        Form::Published => &PROGRAMS[0],
        Form::MovingChloride => &PROGRAMS[1],
        Form::Land => &PROGRAMS[2],
    };
    let mut given = Vec::new();
    constants.parameters.give(&mut |value| given.push(value));
    given.extend(constants.myofilaments.numbers());
    let mut seen = vec![0, calcium];
    if constants.form == Form::Land {
        seen.extend(BEHIND..BEHIND + MYOFILAMENTS);
    }
    let (program, fixed) = (Arc::clone(program), program.fixed(&given));
    Compiled { program, fixed, seen: seen.into() }
}

fn program(form: Form) -> Program {
    let graph = RefCell::new(Graph::default());
    let recorded = |id: Id| Traced::Recorded(&graph, id);
    let mut given = 0..;
    let mut next = || recorded(graph.borrow_mut().given(given.next().unwrap_or_default()));
    let parameters = Parameters::take(&mut next);
    let numbers: [Traced<'_>; NUMBERS] = std::array::from_fn(|_| next());
    let constants = Constants { form, parameters, myofilaments: Myofilaments::of_numbers(numbers) };
    let state: Vec<Traced<'_>> =
        (0..form.len()).map(|place| recorded(graph.borrow_mut().state(place))).collect();
    let [stimulus, stretch, stretch_rate] = [Outer::Stimulus, Outer::Stretch, Outer::StretchRate]
        .map(|outer| recorded(graph.borrow_mut().outer(outer)));
    let outside = Outside { stimulus, stretch, stretch_rate };
    let mut rates = vec![Traced::Plain(0.0); form.len()];
    derivatives(&constants, &state, &outside, &mut rates);
    let rates: Vec<Id> = rates.into_iter().map(|rate| rate.id(&graph)).collect();
    Program::new(graph.into_inner(), &rates, &[], Some(0))
}

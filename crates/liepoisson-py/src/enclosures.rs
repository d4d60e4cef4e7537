//! Rigorous enclosures: polynomials with rational coefficients in, bounds out. See `_core.pyi`.

use crate::errors::{exception, guarded, translate};
use crate::{copied, supervised};
use liepoisson_core::enclosure::chart::Frame;
use liepoisson_core::enclosure::covering::{self, Certificate, CoveringSet, Edge, Margins, Place, Refusal, Settings};
use liepoisson_core::enclosure::eigenvalues::{Eigenvalue, eigenvalues};
use liepoisson_core::enclosure::failure::Failure;
use liepoisson_core::enclosure::flow::{Bundle, Flow, Options, Tube};
use liepoisson_core::enclosure::interval::Interval;
use liepoisson_core::enclosure::lohner::StateSet;
use liepoisson_core::enclosure::matrix::{IntervalVector, Matrix, points};
use liepoisson_core::enclosure::passage::Level;
use liepoisson_core::enclosure::periodic::{Leg, periodic_orbit};
use liepoisson_core::enclosure::polynomial::{Polynomial, Sign};
use liepoisson_core::enclosure::program::Program;
use liepoisson_core::enclosure::rational::Rational;
use liepoisson_core::enclosure::section::{Section, section_map};
use liepoisson_core::enclosure::watched;
use liepoisson_core::enclosure::zeros::zeros;
use liepoisson_core::ensemble::Control;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The most variables of a system, and the greatest degree.
const MOST_VARIABLES: usize = 256;
const MOST_FACTORS: usize = 64;

/// Terms of a polynomial: a rational coefficient as text, and the exponent of each variable.
type Terms = Vec<(String, Vec<usize>)>;

/// Order, longest step, size of the remainders (or equal steps), most steps.
type How = (usize, f64, Option<f64>, usize);

fn parameter(message: &str) -> PyErr {
    exception("ParameterError", message)
}

fn shape(message: &str) -> PyErr {
    exception("ShapeError", message)
}

fn polynomial(n: usize, terms: &Terms) -> PyResult<Polynomial> {
    let mut parts = Vec::with_capacity(terms.len());
    for (coefficient, exponents) in terms {
        if exponents.len() != n {
            let got = exponents.len();
            return Err(shape(&format!(
                "polynomial: wanted {n} exponents in each term, one for each variable; got {got}"
            )));
        }
        let degree = exponents.iter().fold(0_usize, |sum, &exponent| sum.saturating_add(exponent));
        if degree > MOST_FACTORS {
            return Err(parameter(&format!(
                "polynomial: wanted terms of degree at most {MOST_FACTORS}; got {degree}; divide the field by a factor"
            )));
        }
        let factors = (0..n).flat_map(|variable| std::iter::repeat_n(variable, exponents[variable]));
        parts.push((Rational::parse(coefficient).map_err(translate)?, factors.collect()));
    }
    guarded(|| Polynomial::new(n, parts))
}

fn polynomials(n: usize, rows: &[Terms]) -> PyResult<Vec<Polynomial>> {
    rows.iter().map(|terms| polynomial(n, terms)).collect()
}

fn system(rows: &[Terms]) -> PyResult<Vec<Polynomial>> {
    if rows.is_empty() || rows.len() > MOST_VARIABLES {
        let got = rows.len();
        return Err(parameter(&format!("field: wanted from 1 to {MOST_VARIABLES} components; got {got}")));
    }
    polynomials(rows.len(), rows)
}

fn rationals(texts: &[String]) -> PyResult<Vec<Rational>> {
    texts.iter().map(|text| Rational::parse(text).map_err(translate)).collect()
}

fn signs(signs: &[i64]) -> PyResult<Vec<Sign>> {
    let sign = |&sign: &i64| match sign {
        1 => Ok(Sign::Plus),
        -1 => Ok(Sign::Minus),
        got => Err(parameter(&format!("signs: wanted 1 or -1; got {got}"))),
    };
    signs.iter().map(sign).collect()
}

fn boxes(lower: &[f64], upper: &[f64]) -> PyResult<IntervalVector> {
    if lower.len() != upper.len() {
        return Err(shape(&format!(
            "box: wanted as many bounds on either side; got {} and {}",
            lower.len(),
            upper.len()
        )));
    }
    let bounds: IntervalVector = lower.iter().zip(upper).map(|(&lower, &upper)| Interval::new(lower, upper)).collect();
    match bounds.iter().position(|bound| bound.is_unknown()) {
        None => Ok(bounds),
        Some(place) => Err(parameter(&format!(
            "box: wanted finite lower bounds that are not above the upper ones; got {} and {} for component {place}",
            lower[place], upper[place]
        ))),
    }
}

fn finite(name: &str, values: &[f64], count: usize) -> PyResult<()> {
    if values.len() != count {
        return Err(shape(&format!("{name}: wanted {count} numbers; got {}", values.len())));
    }
    match values.iter().find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(got) => Err(parameter(&format!("{name}: wanted finite numbers; got {got}"))),
    }
}

fn options((order, step, tolerance, max_steps): How) -> PyResult<Options> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    if !(2..=64).contains(&order) {
        return Err(parameter(&format!("order: wanted from 2 to 64; got {order}; try 20")));
    }
    if !is_positive(step) {
        return Err(parameter(&format!("step: wanted a positive number; got {step}; try 0.1")));
    }
    if let Some(got) = tolerance.filter(|&tolerance| !is_positive(tolerance)) {
        return Err(parameter(&format!("tolerance: wanted a positive number or None; got {got}; try 1e-16")));
    }
    Ok(Options { order, step, tolerance, max_steps })
}

fn square(flat: &[f64], n_rows: usize, n_columns: usize) -> Matrix<f64> {
    Matrix::from_fn(n_rows, n_columns, |i, j| flat[i * n_columns + j])
}

fn failed(failure: Failure) -> PyErr {
    let hint = match failure {
        Failure::Stopped => "give a larger time_limit, a smaller set or a shorter time",
        _ => "try a smaller set, a shorter time or another order",
    };
    exception("EnclosureError", &format!("no enclosure: {failure}; {hint}"))
}

/// Runs `work` with Ctrl-C at hand; what could not be enclosed is an `EnclosureError`.
fn enclosed<R: Send>(
    py: Python<'_>,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Control) -> Result<R, Failure> + Send,
) -> PyResult<R> {
    supervised(py, 1, time_limit, progress, |control, watch| watched(control, watch, || work(control)))?.map_err(failed)
}

fn bounds(py: Python<'_>, result: &Bound<'_, PyDict>, name: [&str; 2], values: &[Interval]) -> PyResult<()> {
    let side =
        |bound: fn(Interval) -> f64| values.iter().map(|&value| bound(value)).collect::<Vec<_>>().into_pyarray(py);
    result.set_item(name[0], side(Interval::lo))?;
    result.set_item(name[1], side(Interval::hi))
}

fn pair(value: Interval) -> (f64, f64) {
    (value.lo(), value.hi())
}

/// Bounds of a set of states after a time.
#[pyfunction]
#[pyo3(signature = (field, center, frame, lower, upper, time, how, tube, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn enclose_flow<'py>(
    py: Python<'py>,
    field: Vec<Terms>,
    center: PyReadonlyArray1<'py, f64>,
    frame: PyReadonlyArray1<'py, f64>,
    lower: PyReadonlyArray1<'py, f64>,
    upper: PyReadonlyArray1<'py, f64>,
    time: f64,
    how: How,
    tube: bool,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (field, options) = (system(&field)?, options(how)?);
    let n = field.len();
    let set = state_set(n, &copied(&center)?, &copied(&frame)?, &copied(&lower)?, &copied(&upper)?)?;
    finite("time", &[time], 1)?;
    let (states, derivative, steps) = enclosed(py, time_limit, progress, |control| {
        let mut flow = Flow::new(Program::new(n, &field), options);
        let mut bundle = Bundle::new(vec![set], Matrix::identity(n));
        let mut steps: Vec<Tube> = vec![];
        flow.advance(&mut bundle, time, control, |step| steps.push(step.clone()))?;
        Ok((bundle.states[0].hull(), bundle.derivative.hull(), steps))
    })?;
    let result = PyDict::new(py);
    bounds(py, &result, ["lower", "upper"], &states)?;
    bounds(py, &result, ["derivative_lower", "derivative_upper"], derivative.entries())?;
    result.set_item("n_steps", steps.len())?;
    if tube {
        let times: IntervalVector = steps.iter().map(|step| step.time).collect();
        bounds(py, &result, ["tube_start", "tube_end"], &times)?;
        let states: IntervalVector = steps.into_iter().flat_map(|step| step.states).collect();
        bounds(py, &result, ["tube_lower", "tube_upper"], &states)?;
    }
    Ok(result)
}

/// `center + frame box`.
fn state_set(n: usize, center: &[f64], frame: &[f64], lower: &[f64], upper: &[f64]) -> PyResult<StateSet> {
    finite("center", center, n)?;
    finite("frame", frame, n * lower.len())?;
    Ok(StateSet::new(center, square(frame, n, lower.len()), boxes(lower, upper)?))
}

/// Bounds of the map of a set of states to a section.
#[pyfunction]
#[pyo3(signature = (field, section, center, frame, lower, upper, time, how, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn enclose_section_map<'py>(
    py: Python<'py>,
    field: Vec<Terms>,
    section: Terms,
    center: PyReadonlyArray1<'py, f64>,
    frame: PyReadonlyArray1<'py, f64>,
    lower: PyReadonlyArray1<'py, f64>,
    upper: PyReadonlyArray1<'py, f64>,
    time: f64,
    how: How,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (field, options) = (system(&field)?, options(how)?);
    let n = field.len();
    let section = Section::Polynomial(Program::new(n, &[polynomial(n, &section)?]));
    let (center, frame, lower) = (copied(&center)?, copied(&frame)?, copied(&lower)?);
    finite("center", &center, n)?;
    finite("frame", &frame, n * lower.len())?;
    finite("time", &[time], 1)?;
    let (coordinates, frame) = (boxes(&lower, &copied(&upper)?)?, square(&frame, n, lower.len()));
    let map = enclosed(py, time_limit, progress, |control| {
        let mut flow = Flow::new(Program::new(n, &field), options);
        section_map(&mut flow, (&center, &frame, &coordinates), &section, time, control)
    })?;
    let result = PyDict::new(py);
    bounds(py, &result, ["lower", "upper"], &map.states)?;
    bounds(py, &result, ["derivative_lower", "derivative_upper"], map.derivative.entries())?;
    result.set_item("time", pair(map.time))?;
    result.set_item("rate", pair(map.crossing.rate))?;
    Ok(result)
}

/// Boxes around eigenvalues, as arrays.
fn add_eigenvalues(py: Python<'_>, result: &Bound<'_, PyDict>, name: &str, found: &[Eigenvalue]) -> PyResult<()> {
    let real: IntervalVector = found.iter().map(|eigenvalue| eigenvalue.re).collect();
    let imaginary: IntervalVector = found.iter().map(|eigenvalue| eigenvalue.im).collect();
    let keys = |part: &str| [format!("{name}_{part}_lower"), format!("{name}_{part}_upper")];
    for (part, values) in [("real", real), ("imaginary", imaginary)] {
        let [low, high] = keys(part);
        bounds(py, result, [&low, &high], &values)?;
    }
    let alone: Vec<bool> = found.iter().map(|eigenvalue| eigenvalue.is_alone).collect();
    result.set_item(format!("{name}_alone"), alone.into_pyarray(py))
}

/// A periodic orbit through sections across the flow at given points, proved to exist and to be the only one nearby.
#[pyfunction]
#[pyo3(signature = (field, constants, level, symmetry, states, times, reach, how, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn enclose_periodic_orbit<'py>(
    py: Python<'py>,
    field: Vec<Terms>,
    constants: Vec<Terms>,
    level: Option<Vec<String>>,
    symmetry: Option<Vec<i64>>,
    states: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    reach: f64,
    how: How,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (field, options) = (system(&field)?, options(how)?);
    let n = field.len();
    let constants = polynomials(n, &constants)?;
    let symmetry = symmetry.map(|given| signs(&given)).transpose()?.unwrap_or(vec![Sign::Plus; n]);
    let (states, times) = (copied(&states)?, copied(&times)?);
    if times.is_empty() || symmetry.len() != n {
        return Err(shape("times, symmetry: wanted a time for each state, one or more, and a sign for each component"));
    }
    finite("states", &states, n * times.len())?;
    finite("times", &times, times.len())?;
    if times.iter().any(|&time| time <= 0.0) || reach.is_nan() || reach <= 0.0 {
        return Err(parameter("times, reach: wanted positive numbers; the times from each state to the next"));
    }
    exactly_kept(&field, &constants, &symmetry)?;
    let (program, constants) = (Program::new(n, &field), Program::new(n, &constants));
    let values = match level {
        Some(texts) => rationals(&texts)?.into_iter().map(Rational::enclosure).collect(),
        None => constants.values(&points(&states[..n])),
    };
    if values.len() != constants.n_rows() {
        return Err(shape("level: wanted a value for each constant of motion"));
    }
    let level = Level { constants, values, reach };
    let orbit = enclosed(py, time_limit, progress, |control| {
        let frames: Vec<Frame> =
            states.chunks(n).map(|state| Frame::around(state, &program, &level.constants)).collect::<Result<_, _>>()?;
        let end = frames[0].reflected(&symmetry);
        let next = |k: usize| if k + 1 < frames.len() { frames[k + 1].clone() } else { end.clone() };
        let legs: Vec<Leg> =
            (0..frames.len()).map(|k| Leg { from: frames[k].clone(), to: next(k), time: times[k] }).collect();
        let start = vec![vec![0.0; frames[0].n_directions()]; legs.len()];
        periodic_orbit(&mut Flow::new(program, options), &level, &legs, start, control)
    })?;
    let derivative = orbit.derivative();
    let found = eigenvalues(&derivative).ok_or_else(|| failed(Failure::Singular))?;
    let result = PyDict::new(py);
    bounds(py, &result, ["lower", "upper"], &orbit.states.concat())?;
    result.set_item("period", pair(orbit.period()))?;
    let times: IntervalVector = orbit.passages.iter().map(|passage| passage.time).collect();
    bounds(py, &result, ["times_lower", "times_upper"], &times)?;
    let radius = orbit.unique_within.iter().flatten().map(|side| side.rad()).fold(f64::INFINITY, f64::min);
    result.set_item("unique_radius", radius)?;
    bounds(py, &result, ["derivative_lower", "derivative_upper"], derivative.entries())?;
    add_eigenvalues(py, &result, "multipliers", &found)?;
    Ok(result)
}

/// Refuses constants that are none, and a symmetry that is none.
fn exactly_kept(field: &[Polynomial], constants: &[Polynomial], symmetry: &[Sign]) -> PyResult<()> {
    let is_constant = |constant: &Polynomial| constant.along(field).is_some_and(|derivative| derivative.is_zero());
    if !constants.iter().all(is_constant) {
        return Err(parameter("constants: wanted polynomials that are constant along orbits, exactly"));
    }
    let is_kept = constants.iter().all(|constant| constant.with_signs(symmetry) == *constant);
    match is_kept && liepoisson_core::enclosure::polynomial::commutes(field, symmetry, false) {
        true => Ok(()),
        false => Err(parameter("symmetry: wanted signs that map orbits to orbits and keep the constants")),
    }
}

/// All zeros of a field in a box, with the eigenvalues of the linearisation.
#[pyfunction]
#[pyo3(signature = (field, lower, upper, max_boxes, time_limit, progress))]
pub(crate) fn enclose_equilibria<'py>(
    py: Python<'py>,
    field: Vec<Terms>,
    lower: PyReadonlyArray1<'py, f64>,
    upper: PyReadonlyArray1<'py, f64>,
    max_boxes: usize,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let field = system(&field)?;
    let n = field.len();
    let region = boxes(&copied(&lower)?, &copied(&upper)?)?;
    if region.len() != n {
        return Err(shape(&format!("box: wanted {n} components; got {}", region.len())));
    }
    let program = Program::new(n, &field);
    let found = enclosed(py, time_limit, progress, |control| zeros(&program, &region, max_boxes, control))?;
    let mut spectrum = vec![];
    let none = Eigenvalue { re: Interval::UNKNOWN, im: Interval::UNKNOWN, is_alone: false };
    for equilibrium in &found.boxes {
        spectrum.extend(eigenvalues(&program.jacobian(equilibrium)).unwrap_or(vec![none; n]));
    }
    let result = PyDict::new(py);
    bounds(py, &result, ["lower", "upper"], &found.boxes.concat())?;
    bounds(py, &result, ["unique_lower", "unique_upper"], &found.unique_within.concat())?;
    bounds(py, &result, ["undecided_lower", "undecided_upper"], &found.undecided.concat())?;
    add_eigenvalues(py, &result, "eigenvalues", &spectrum)?;
    Ok(result)
}

/// Number of the set that is left, of the set that is covered, flight time, whether the symmetry follows.
type EdgeParts = (usize, usize, f64, bool);

/// Level radius, order, step, reach of charts, factor of smaller sets, time near the middle set, shift of the energy.
type Parts = (String, usize, f64, f64, f64, f64, Option<String>);

fn settings((level_radius, order, step, reach, small, near, shift): Parts) -> PyResult<Settings> {
    let rational = |text: &String| Rational::parse(text).map_err(translate);
    let shift = shift.as_ref().map(rational).transpose()?;
    Ok(Settings { level_radius: rational(&level_radius)?, order, step, reach, small, near, shift })
}

/// Verifies a certificate of chaos.
#[pyfunction]
#[pyo3(signature = (field, constants, level, symmetry, reversers, n_unstable, names, centers, frames, edges, how, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn check_covering_relations<'py>(
    py: Python<'py>,
    field: Vec<Terms>,
    constants: Vec<Terms>,
    level: Vec<String>,
    symmetry: Vec<i64>,
    reversers: Vec<Vec<i64>>,
    n_unstable: usize,
    names: Vec<String>,
    centers: PyReadonlyArray1<'py, f64>,
    frames: PyReadonlyArray1<'py, f64>,
    edges: Vec<EdgeParts>,
    how: Parts,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let field = system(&field)?;
    let n = field.len();
    let (centers, frames) = (copied(&centers)?, copied(&frames)?);
    if centers.len() != n * names.len() || frames.len() != n * n * names.len() {
        return Err(shape(&format!(
            "centers, frames: wanted {n} and {} numbers for each of the {} names; got {} and {}",
            n * n,
            names.len(),
            centers.len(),
            frames.len()
        )));
    }
    let parts = centers.chunks(n).zip(frames.chunks(n * n));
    let sets = parts.map(|(center, frame)| CoveringSet { center: center.to_vec(), frame: square(frame, n, n) });
    let edge = |(from, to, time, is_reflected): EdgeParts| Edge { from, to, time, is_reflected };
    let certificate = Certificate {
        constants: polynomials(n, &constants)?,
        field,
        level: rationals(&level)?,
        symmetry: signs(&symmetry)?,
        reversers: reversers.iter().map(|given| signs(given)).collect::<PyResult<_>>()?,
        n_unstable,
        sets: sets.collect(),
        edges: edges.into_iter().map(edge).collect(),
    };
    let settings = settings(how)?;
    let verdict = supervised(py, 1, time_limit, progress, |control, watch| {
        watched(control, watch, || covering::check(&certificate, &settings, control))
    })?;
    match verdict {
        Ok(margins) => covering_result(py, &margins),
        Err(refusal) => Err(refused(py, &refusal, &names, &certificate.edges)),
    }
}

fn refused(py: Python<'_>, refusal: &Refusal, names: &[String], edges: &[Edge]) -> PyErr {
    let name = |set: usize| names.get(set).cloned().unwrap_or_else(|| set.to_string());
    let place = match refusal.place {
        Place::Everywhere => String::new(),
        Place::Set(set) => format!("set {}", name(set)),
        Place::Edge(edge) => match edges.get(edge) {
            Some(edge) => format!("edge {} -> {}", name(edge.from), name(edge.to)),
            None => format!("edge {edge}"),
        },
    };
    let error = exception("EnclosureError", &refusal.message(&place));
    let (set, edge) = match refusal.place {
        Place::Everywhere => (None, None),
        Place::Set(set) => (Some(set), None),
        Place::Edge(edge) => (None, Some(edge)),
    };
    let value = error.value(py);
    let added = value
        .setattr("check", refusal.check.name())
        .and_then(|()| value.setattr("set", set))
        .and_then(|()| value.setattr("edge", edge));
    added.map_or_else(|failure| failure, |()| error)
}

fn covering_result<'py>(py: Python<'py>, margins: &Margins) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("n_steps", margins.n_steps)?;
    let by_edge = [
        ("expansion", &margins.expansion),
        ("contraction", &margins.contraction),
        ("cone", &margins.cone),
        ("chart", &margins.chart),
    ];
    for (name, values) in by_edge {
        result.set_item(name, values.clone().into_pyarray(py))?;
    }
    let (separation, loops) = (&margins.separation, &margins.loops);
    let numbers = [
        ("crossing_rate", margins.crossing_rate),
        ("small_expansion", margins.small.0),
        ("small_contraction", margins.small.1),
        ("reversal", margins.reversal),
        ("apart_from_orbit", separation.to_orbit),
        ("apart_from_excursion", separation.to_excursion),
        ("apart_from_image", separation.to_image),
        ("entropy", margins.entropy),
    ];
    for (name, value) in numbers {
        result.set_item(name, value)?;
    }
    result.set_item("middle", separation.middle)?;
    result.set_item("loop_times", (pair(loops[0].0), pair(loops[1].0)))?;
    result.set_item("loop_reflections", (loops[0].1, loops[1].1))?;
    let rotation = margins.rotation.map(|rotation| {
        let part = PyDict::new(py);
        part.set_item("discriminant", pair(rotation.discriminant))?;
        part.set_item("angles", (pair(rotation.angles[0]), pair(rotation.angles[1])))?;
        part.set_item("periods", (pair(rotation.periods[0]), pair(rotation.periods[1])))?;
        part.set_item("moduli", (pair(rotation.moduli[0]), pair(rotation.moduli[1])))?;
        PyResult::Ok(part)
    });
    result.set_item("rotation", rotation.transpose()?)?;
    Ok(result)
}

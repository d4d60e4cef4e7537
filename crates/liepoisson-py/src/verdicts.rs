//! The rule that calls orbits regular or chaotic, and its indicators: flat arrays, row by row.

use crate::errors::exception;
use crate::{Doubles, copied};
use liepoisson_core::analysis::verdict::{self, Rule};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// Thresholds as Python's `Rule` has them.
type Thresholds = ((f64, f64), (f64, f64), (f64, f64), f64, f64);

fn rule_of((growth_power, megno, sali, averages, least_time): Thresholds) -> Rule {
    let pair = |(regular, chaotic)| [regular, chaotic];
    Rule { growth_power: pair(growth_power), megno: pair(megno), sali: pair(sali), averages, least_time }
}

/// Rows of so many numbers.
fn rows<'n, T>(numbers: &'n [T], length: usize) -> PyResult<std::slice::ChunksExact<'n, T>> {
    if length == 0 || !numbers.len().is_multiple_of(length) {
        return Err(exception(
            "ShapeError",
            &format!("values: wanted rows of {length}; got {} numbers.", numbers.len()),
        ));
    }
    Ok(numbers.chunks_exact(length))
}

/// The thresholds of which the error rates were measured.
#[pyfunction]
pub(crate) fn usual_rule() -> Thresholds {
    let Rule { growth_power, megno, sali, averages, least_time } = Rule::USUAL;
    (growth_power.into(), megno.into(), sali.into(), averages, least_time)
}

/// Votes of the indicators, four for each trajectory.
#[pyfunction]
pub(crate) fn votes<'py>(
    py: Python<'py>,
    rule: Thresholds,
    indicators: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let (rule, numbers) = (rule_of(rule), copied(&indicators)?);
    let votes = rows(&numbers, 4)?.flat_map(|row| rule.votes([row[0], row[1], row[2], row[3]])).collect::<Vec<i8>>();
    Ok(votes.into_pyarray(py))
}

/// What votes make: -1 regular, 1 chaotic, 0 undecided.
#[pyfunction]
pub(crate) fn verdicts<'py>(
    py: Python<'py>,
    rule: Thresholds,
    votes: PyReadonlyArray1<'py, i8>,
    natural_time: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let (rule, votes, times) = (rule_of(rule), copied(&votes)?, copied(&natural_time)?);
    let kind = |(row, time): (&[i8], &f64)| rule.kind([row[0], row[1], row[2], row[3]], *time) as i8;
    Ok(rows(&votes, 4)?.zip(&times).map(kind).collect::<Vec<i8>>().into_pyarray(py))
}

/// MEGNO and its mean at times, of each row of `ln|v|`.
#[pyfunction]
pub(crate) fn megno<'py>(
    py: Python<'py>,
    times: PyReadonlyArray1<'py, f64>,
    log_growth: PyReadonlyArray1<'py, f64>,
) -> PyResult<[Doubles<'py>; 2]> {
    let (times, numbers) = (copied(&times)?, copied(&log_growth)?);
    let [mut values, mut means] = [const { Vec::new() }; 2];
    for row in rows(&numbers, times.len())? {
        let [of_row, mean] = verdict::megno(&times, row);
        values.extend(of_row);
        means.extend(mean);
    }
    Ok([values, means].map(|numbers| numbers.into_pyarray(py)))
}

/// Growth powers, of each row of `ln|v|`.
#[pyfunction]
pub(crate) fn growth_powers<'py>(
    py: Python<'py>,
    times: PyReadonlyArray1<'py, f64>,
    log_growth: PyReadonlyArray1<'py, f64>,
) -> PyResult<Doubles<'py>> {
    let (times, numbers) = (copied(&times)?, copied(&log_growth)?);
    let found: Vec<f64> = rows(&numbers, times.len())?.map(|row| verdict::growth_power(&times, row)).collect();
    Ok(found.into_pyarray(py))
}

/// SALI of pairs of unit vectors with `n` components.
#[pyfunction]
pub(crate) fn sali<'py>(py: Python<'py>, pairs: PyReadonlyArray1<'py, f64>, n: usize) -> PyResult<Doubles<'py>> {
    let numbers = copied(&pairs)?;
    let found: Vec<f64> = rows(&numbers, 2 * n)?.map(|pair| verdict::sali(&pair[..n], &pair[n..])).collect();
    Ok(found.into_pyarray(py))
}

/// The largest change of an average square, of each of `n_rows` samples of `n` functions, (row, time, function).
#[pyfunction]
pub(crate) fn average_changes<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
    n_rows: usize,
    n: usize,
) -> PyResult<Doubles<'py>> {
    let numbers = copied(&values)?;
    if n_rows == 0 {
        return Ok(Vec::new().into_pyarray(py));
    }
    let found: Vec<f64> = rows(&numbers, numbers.len() / n_rows)?.map(|row| verdict::average_change(row, n)).collect();
    Ok(found.into_pyarray(py))
}

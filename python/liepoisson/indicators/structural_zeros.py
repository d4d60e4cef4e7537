r"""How many Lyapunov exponents must vanish, from the Poisson tensor and the known constants of the motion.

The gradients dF of constants F are carried along by the (co)tangent flow, and so are their Hamiltonian vector fields
$J\,dF$.  Neither grows while they stay bounded and independent, so with G the matrix of all gradients at a state

$$ n_0 = \mathrm{rank}\,G + \mathrm{rank}\,JG - \mathrm{rank}\,G^T J G $$

exponents vanish: the first term counts the directions across the common level sets, the other two those fields that lie
in them.  For corank c and k further integrals in involution this is c + 2 (1 + k).

The Casimirs count by the null space of J where the rank of J is the largest.  On leaves of lower rank only the
gradients of the known Casimirs count: other directions across such a leaf may grow.

All ranks are those at the start.  They are assumed to stay along the orbit, and the gradients to stay bounded: an orbit
that tends to a leaf of lower rank or to a critical point of an integral has other zeros.

The self-check of a Lyapunov spectrum looks at its sum, its pairs, and these zeros.

References: Pikovsky and Politi, Lyapunov Exponents (Cambridge, 2016), chapter 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.compile.field import Field, PiecesField
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.indicators.mean_divergence import divergence_of
from liepoisson.inputs.arrays import Array, ReadOnlyArrays, check_shape
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import Deadline
from liepoisson.io.result import labelled
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.systems import HasFunctions, has_functions, known_constants
from liepoisson.numeric.time_scale import zero_threshold
from liepoisson.portable import elementary, linear
from liepoisson.streams import generator

if TYPE_CHECKING:
    from liepoisson.indicators.spectrum import Spectrum

# Singular values below this fraction of the largest count as zero: gradients are evaluated to some 1e-15.
_NEGLIGIBLE = 1e-9
# The part of the time from which the derivative of the field is taken, and the part of it that counts as divergence.
_SHORT, _DIVERGENCE = 1e-9, 1e-5


@explains_its_methods
@dataclass(frozen=True, eq=False)
class PoissonStructure(ReadOnlyArrays):
    """What the bracket says about the spectrum of each trajectory.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> structure = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=20).structure
        >>> structure.corank, structure.n_zeros  # three Casimirs; with them H and the direction of the flow
        (array([3]), array([5]))

    Attributes:
        n_zeros: Exponents that must vanish while the gradients of the known constants stay independent, shape
            (trajectory,).
        corank: N minus the rank of J at the start, shape (trajectory,).
        is_regular: Whether J has its largest rank at the start, shape (trajectory,): then the exponents come in pairs.
    """

    n_zeros: NDArray[np.int64] = labelled("trajectory", long_name="exponents that must vanish", units="1")
    corank: NDArray[np.int64] = labelled("trajectory", long_name="corank of the Poisson tensor", units="1")
    is_regular: NDArray[np.bool_] = labelled("trajectory", long_name="whether its rank is the largest", units="1")

    def __post_init__(self) -> None:
        """Copies the arrays, which a caller may have made, and makes them read-only."""
        for name, kind in (("n_zeros", np.int64), ("corank", np.int64), ("is_regular", np.bool_)):
            object.__setattr__(self, name, _as_labels(getattr(self, name), name, kind))
        if not self.n_zeros.shape == self.corank.shape == self.is_regular.shape:
            raise ShapeError(
                "PoissonStructure: wanted n_zeros, corank and is_regular of one shape (trajectory,); got shapes "
                f"{self.n_zeros.shape}, {self.corank.shape} and {self.is_regular.shape}"
            )
        super().__post_init__()

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape (trajectory,) of each array."""
        return self.n_zeros.shape


def _as_labels(values: Any, name: str, kind: type[np.int64] | type[np.bool_]) -> NDArray[Any]:
    """A copy of whole numbers, or of truth values.

    Raises:
        ShapeError: they have no shape (trajectory,).
        ParameterError: they are of another kind.
    """
    try:
        given = np.array(values)
    except ValueError as error:  # rows of different lengths
        raise ShapeError(f"{name}: wanted an array of shape (trajectory,); got {error}") from error
    check_shape(given.ndim == 1, name, "(trajectory,)", given)
    if given.size and given.dtype.kind not in ("b" if kind is np.bool_ else "iu"):
        wanted = "truth values" if kind is np.bool_ else "whole numbers"
        raise ParameterError(f"{name}: wanted {wanted}; got an array of {given.dtype}; take those of another spectrum")
    return given.astype(kind)


def poisson_structure(
    system: Any, states: Array, units: Array | None = None, deadline: Deadline | None = None
) -> PoissonStructure | None:
    """The structure at each start, shape (trajectory, component); None for a system without a Poisson tensor.

    Ranks are those in the units of the components, shape (trajectory, component), by default 1.  Where the start or a
    gradient there is not finite, and where the deadline comes first, corank and number of zeros are 0.
    """
    if not has_functions(system):
        return None
    functions = system.functions
    constants = _constants(system)
    n = states.shape[1]
    with np.errstate(all="ignore"):  # overflow makes a gradient that is not finite, and the start is left out
        gradients = np.stack([constant.gradient(states) for constant in constants], axis=-1)
    unit = np.ones_like(states) if units is None else units
    gradients *= unit[:, :, None]
    tensors = _in_units(functions, states, unit)
    good = np.isfinite(states).all(axis=1) & np.isfinite(gradients).all(axis=(1, 2))
    good &= np.isfinite(tensors).all(axis=(1, 2))
    n_zeros, corank = np.zeros(len(states), dtype=np.int64), np.zeros(len(states), dtype=np.int64)
    is_regular = np.zeros(len(states), dtype=bool)
    least = n - max((_rank(tensor) for tensor in _generic_tensors(functions, unit[good])), default=0)
    for k in np.flatnonzero(good):
        if deadline is not None and not deadline.lasts():
            break
        tensor, known = tensors[k], gradients[k]
        corank[k] = n - _rank(tensor)
        is_regular[k] = corank[k] == least
        if is_regular[k]:
            known = np.concatenate([known, _null_space(tensor, least)], axis=1)
        n_zeros[k] = _n_zeros(tensor, known)
    return PoissonStructure(n_zeros, corank, is_regular)


def keeps_volume(field: Field, states: Array, *, time: float, method: Method) -> bool:
    r"""Whether $\mathrm{div} f = \mathrm{tr}\,Df$ vanishes at the given states, shape (trajectory, component).

    It does everywhere for the flow of any Hamiltonian on a unimodular algebra, $\sum_j c_{ij}^j = 0$.  Df is read off
    the variational equations, $M(h) = 1 + h\,Df + O(h^2)$ at $h = 10^{-9}$ of a time in which the flow changes by order
    one: it has relative errors of 1e-7 from round-off.
    """
    step, n = _SHORT * time, states.shape[1]
    identity = np.tile(np.eye(n), (len(states), 1, 1))
    # whatever the method of the run, but a field that is given by its pieces knows no other
    how = method if isinstance(field, PiecesField) else Taylor(tol=1e-13)
    change = (
        integrate(field, states, times=[0.0, step], tangents=identity, method=how).tangent[:, 1] - identity
    ) / step
    size = linear.norm(change, axis=(1, 2))
    divergence = np.abs(np.trace(change, axis1=1, axis2=2))
    return bool((divergence <= _DIVERGENCE * np.maximum(size, 1.0 / time)).all())


def _constants(system: HasFunctions) -> list[Any]:
    """The known constants of the motion as functions; H alone where a system lists no others."""
    constants = known_constants(system)
    return [system.functions.of(expression) for expression in constants.values()] or [system.functions.energy]


def _generic_tensors(functions: Any, units: Array) -> Array:
    """Poisson tensors at a few states of no special position: a rank is the largest on an open dense set."""
    states = generator(0).standard_normal((4, units.shape[1]))
    unit = np.unique(units, axis=0)[:, None, :] if len(units) else np.ones((1, 1, units.shape[1]))
    tensors = _in_units(functions, states * unit, unit).reshape(-1, units.shape[1], units.shape[1])
    return tensors[np.isfinite(tensors).all(axis=(1, 2))]


@np.errstate(all="ignore")
def _in_units(functions: Any, states: Array, units: Array) -> Array:
    """The brackets of the components divided by their units, one after the other: their product may overflow."""
    return np.asarray(functions.poisson_tensor(states) / units[..., :, None] / units[..., None, :])


def _n_zeros(tensor: Array, gradients: Array) -> int:
    lengths = np.abs(gradients).max(axis=0)
    basis = _range(gradients[:, lengths > 0] / lengths[lengths > 0])
    if basis.shape[1] == 0:
        return 0
    fields = linear.matmul(tensor, basis) / (linear.norm(tensor, 2) or 1.0)
    return basis.shape[1] + _rank(fields, 1.0) - _rank(linear.matmul(basis.T, fields), 1.0)


def _range(matrix: Array) -> Array:
    """An orthonormal basis of the range, as columns."""
    if matrix.shape[1] == 0:
        return matrix
    vectors, sizes, _ = linear.svd(matrix, full_matrices=False)
    return vectors[:, sizes > _NEGLIGIBLE * max(sizes[0], np.finfo(float).tiny)]


def _null_space(tensor: Array, corank: int) -> Array:
    return linear.svd(tensor)[0][:, len(tensor) - corank :]


def _rank(matrix: Array, scale: float | None = None) -> int:
    sizes = linear.svd(matrix, compute_uv=False)
    largest = (sizes[0] if len(sizes) else 0.0) if scale is None else scale
    return int(np.sum(sizes > _NEGLIGIBLE * largest)) if largest > 0 else 0


RATIO_LIMIT = 1e8
"""Within an interval the stretchings should not differ by more: half of the digits of a double."""


@dataclass(frozen=True, eq=False)
class SpectrumResiduals(ReadOnlyArrays):
    r"""How far spectra are from the structure that the bracket prescribes.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> found = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=1000).residuals
        >>> bool(abs(found.sum[0]) < 1e-12), found.zeros.shape[1], found.zeros_below_threshold.tolist()
        (True, 5, [1.0])

    Attributes:
        sum: Sum of all exponents, shape (trajectory,): zero where the flow keeps the volume,
            $\mathrm{div}\,J\nabla H = 0$, as for all H on a unimodular algebra.  On others, such as the affine one, and
            of damped systems it is `Spectrum.mean_divergence`.
        pairing: $\lambda_k + \lambda_{N+1-k}$ for the exponents in decreasing order, shape (trajectory, N // 2); NaN
            for starts on leaves of lower rank, across which exponents need not be paired.
        zeros: The structural zeros, the middle exponents in decreasing order, shape (trajectory, largest number of
            them); NaN beyond the number of this trajectory, and for starts on leaves of lower rank, where a growing
            direction across the leaf moves the middle.
        zero_threshold: $3\ln(t/T)/t$ with T the time scale of the orbit, below which an exponent at time t is
            consistent with zero: tangent vectors in these directions grow like powers of time; shape (trajectory,).  A
            fault that makes an exponent smaller than this is not seen: with T = 1 0.021 at t = 1,000, 0.0028 at
            t = 10,000.
    """

    sum: Array
    pairing: Array
    zeros: Array
    zero_threshold: Array

    @property
    def zeros_below_threshold(self) -> Array:
        """Fraction of the structural zeros below the threshold, per trajectory; NaN where there are none."""
        known = np.isfinite(self.zeros)
        n = known.sum(axis=1)
        small = (np.abs(np.where(known, self.zeros, np.inf)) <= self.zero_threshold[:, None]).sum(axis=1)
        return np.divide(small, n, out=np.full(len(n), np.nan), where=n > 0)


def spectrum_residuals(spectrum: Spectrum) -> SpectrumResiduals:
    """The residuals; sums, pairs and zeros are NaN where not all exponents are known, or no structure."""
    values, n = -np.sort(-spectrum.end_exponent, axis=1), len(spectrum.components)
    threshold = zero_threshold(spectrum.time[-1], spectrum.time_scale)
    complete, structure = values.shape[1] == n, spectrum.structure
    total = values.sum(axis=1) if complete else np.full(len(values), np.nan)
    pairing = (values + values[:, ::-1])[:, : n // 2] if complete else np.full((len(values), n // 2), np.nan)
    if structure is None:
        return SpectrumResiduals(total, np.full_like(pairing, np.nan), np.empty((len(values), 0)), threshold)
    pairing = np.where(structure.is_regular[:, None], pairing, np.nan)
    zeros = np.full((len(values), int(structure.n_zeros.max(initial=0))), np.nan)
    for k in np.flatnonzero(structure.is_regular & complete):
        count = int(structure.n_zeros[k])
        side = (n - count) // 2
        zeros[k, :count] = values[k, side : side + count]
    return SpectrumResiduals(total, pairing, zeros, threshold)


def check_lines(spectrum: Spectrum) -> list[str]:
    """The self-check in words, a line for each property."""
    finished = spectrum.outcome == "finished"
    if not finished.any():
        return ["no trajectory finished: there is nothing to check"]
    residuals, structure = spectrum.residuals, spectrum.structure
    if not np.isfinite(residuals.sum[finished]).any():
        n_known = int(np.isfinite(spectrum.end_exponent[finished]).sum(axis=1).max())
        line = f"only {n_known} of {len(spectrum.components)} exponents: sum and pairs are not known"
        return [line, *_ratio_line(spectrum)]
    lines = [_sum_line(spectrum, residuals.sum[finished])]
    if structure is None:
        return [*lines, "no Poisson tensor is known: no pairs and zeros to check", *_ratio_line(spectrum)]
    if np.isfinite(residuals.pairing[finished]).any():
        lines.append(f"pairs +x, -x: equal within {_largest(residuals.pairing[finished]):.1e}")
    else:
        lines.append("the leaves are of lower rank: exponents across them need not come in pairs")
    counts = sorted(set(structure.n_zeros[finished].tolist()))
    within, zeros = residuals.zeros_below_threshold[finished], residuals.zeros[finished]
    claim = f"structural zeros: {' or '.join(map(str, counts))} of {len(spectrum.components)}"
    if np.isfinite(zeros).any():
        below = "the natural time T of the orbit is not known"
        if np.isfinite(threshold := residuals.zero_threshold[finished]).any():
            below = (
                f"below 3 ln(t/T) / t = {_interval(threshold)} for {int(np.sum(within == 1.0))} of "
                f"{int(finished.sum())} trajectories (smaller faults are not seen)"
            )
        lines.append(f"{claim}, at most {_largest(zeros):.1e}; {below}")
    lines.append("assumed: the ranks of J and of the gradients at the start stay the same along the orbits")
    return lines + _ratio_line(spectrum)


def _sum_line(spectrum: Spectrum, total: Array) -> str:
    finished = spectrum.outcome == "finished"
    states = np.concatenate([spectrum.start[finished], spectrum.end_state[finished]])
    if keeps_volume(spectrum.field, states, time=spectrum.interval, method=spectrum.method):
        return f"sum of all exponents: at most {_largest(total):.1e}"
    mean = spectrum.mean_divergence[finished]
    if np.isfinite(mean).all():
        what = (
            "divergence of the field"
            if divergence_of(spectrum.system).is_number
            else "mean divergence along orbits computed apart"
        )
        return f"sum of all exponents: {_interval(total, '.10g')}, the {what}, within {_largest(total - mean):.1e}"
    return (
        f"sum of all exponents: from {total.min():.2g} to {total.max():.2g}; not expected to vanish, as the flow does "
        f"not keep the volume (div {'f' if spectrum.structure is None else 'J grad H'} is not 0)"
    )


def _largest(values: Array) -> float:
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if known.size else float("nan")


def _interval(values: Array, digits: str = ".1e") -> str:
    """The least and the largest one, or the one that both are to these digits."""
    ends = sorted({f"{value:{digits}}" for value in (np.nanmin(values), np.nanmax(values))}, key=float)
    return " to ".join(ends)


def _ratio_line(spectrum: Spectrum) -> list[str]:
    finished = spectrum.outcome == "finished"
    ratio = float(np.max(spectrum.largest_ratio[finished]))
    if ratio <= RATIO_LIMIT:
        return []
    apart = f"by {ratio:.1e}" if np.isfinite(ratio) else "beyond all numbers"
    logarithm = elementary.log(min(ratio, float(np.finfo(float).max)))
    shorter = spectrum.interval * float(elementary.log(RATIO_LIMIT) / logarithm)
    are_hidden = not np.isfinite(spectrum.end_exponent[finished]).all()
    lost = "those that it hides are NaN" if are_hidden else "the smallest exponents lose digits"
    return [
        f"within an interval of up to {spectrum.interval:g} stretchings differ {apart}, so that round-off "
        f"matters: {lost}; take interval={shorter:.1g} or a shorter one"
    ]

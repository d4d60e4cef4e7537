r"""Tops: rigid bodies in one or two fixed fields, and their twisted relatives, as ready-made systems."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, final

from liepoisson.algebra.exact_numbers import Exact, is_negative, is_zero
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_parameter, read_vector
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.model.system import System
from liepoisson.model.top_parameters import ExactVector, TopParameters, warn_of_impossible_bodies
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebras import so

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


@explains_its_methods
@final
class Top(System):
    r"""The charged or twisted top.

    The bracket is `so(3) @ leibniz(3, epsilon)`, the Hamiltonian $H = \tfrac12\ell\cdot\omega + a\cdot\alpha +
    b\cdot\beta$ with $\omega = I^{-1}\ell$; in the body frame, dimensionless,

    $$\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b,\quad
      \dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a,\quad \dot\beta = \beta\times\omega .$$

    epsilon = 0 is the charged heavy top; b = 0 the uncharged one.  SymPy is imported only when an expression is asked
    for, or when a parameter is symbolic.

    Example:
        >>> lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon="1/3")
        <System 'twisted top' on so(3) ⊗ Leibniz(3, epsilon = 1/3)>

    Args:
        inertia: Principal moments (I1, I2, I3), positive.
        a: Centre of mass, which couples to alpha.
        b: Centre of charge, which couples to beta.
        epsilon: Strength of the cocycle.
        name: How the top is called in texts and files.

    Raises:
        ShapeError: inertia, a or b does not have three components.
        ParameterError: a parameter is not a finite number or a name, or a moment of inertia is not positive.
        BracketError: a parameter is named like a coordinate.

    Warns:
        InertiaWarning: the moments violate I1 + I2 >= I3, so no rigid body has them (the equations do not need it).

    References: Thiffeault and Morrison (2001), sections on the charged heavy top and on the twisted top.
    """

    def __init_subclass__(cls, **_: Any) -> None:
        """Refuses subclasses: runs know a top by its parameters alone, and would not see what another class changes.

        Raises:
            ParameterError: always.
        """
        raise ParameterError(
            f"Top cannot have subclasses, as {cls.__name__} would be: a top is what its parameters say. Make a "
            "System(bracket, hamiltonian), or a function that returns a Top."
        )

    @explains_its_arguments
    def __init__(
        self,
        *,
        inertia: Sequence[Parameter],
        a: Sequence[Parameter] = (0, 0, 0),
        b: Sequence[Parameter] = (0, 0, 0),
        epsilon: Parameter = 0,
        name: str | None = None,
    ) -> None:
        moments = read_vector(inertia, "inertia", "(I1, I2, I3)")
        _check_inertia(moments)
        top = TopParameters(
            inertia=moments,
            a=read_vector(a, "a", "(a1, a2, a3)"),
            b=read_vector(b, "b", "(b1, b2, b3)"),
            epsilon=read_parameter(epsilon, "epsilon"),
        )
        self._top = top
        name = _default_name(top) if name is None else name
        super().__init__(so(3) @ leibniz(3, top.epsilon), top.hamiltonian, name=name, symbols=sorted(top.symbols))
        self.bracket.check_parameter_names(top.symbols)

    @property
    def inertia(self) -> ExactVector:
        """Principal moments of inertia (I1, I2, I3), exact."""
        return self._top.inertia

    @property
    def a(self) -> ExactVector:
        """Centre of mass, exact."""
        return self._top.a

    @property
    def b(self) -> ExactVector:
        """Centre of charge, exact."""
        return self._top.b

    @property
    def epsilon(self) -> Exact:
        """Strength of the cocycle, exact."""
        return self._top.epsilon

    @classmethod
    def free_rigid_body(cls, inertia: Sequence[Parameter]) -> Top:
        """Euler's top: no torque."""
        return cls(inertia=inertia, name="free rigid body")

    @classmethod
    def heavy(cls, inertia: Sequence[Parameter], a: Sequence[Parameter]) -> Top:
        """The heavy top: one field, alpha.

        Like every `Top` it has the nine components l, alpha, beta, where beta is idle, and C1 = |alpha|^2.  For
        surfaces of section take `catalog.system("heavy-top", ...)`, which has six, and C1 = l.alpha: sections have
        dimension 2 there.
        """
        return cls(inertia=inertia, a=a, name="heavy top")

    @classmethod
    def lagrange(cls, *, transverse: Parameter = 1, axial: Parameter = "1/2", a3: Parameter = 1) -> Top:
        """The Lagrange top: I = (transverse, transverse, axial), a = (0, 0, a3)."""
        return cls(inertia=(transverse, transverse, axial), a=(0, 0, a3), name="Lagrange top")

    @classmethod
    def kovalevskaya(cls, epsilon: Parameter = 0) -> Top:
        """The Kovalevskaya top, I = (2, 2, 1), a = (-1, 0, 0); twisted when epsilon is not zero.

        Kovalevskaya's condition is I1 = I2 = 2 I3; the paper prints "I3 = 2 I1", a misprint.  Like every `Top` it has
        the nine components l, alpha, beta, and C1 = |alpha|^2; `catalog.system("kovalevskaya")` has six, without beta,
        and C1 = l.alpha.
        """
        strength = read_parameter(epsilon, "epsilon")
        name = "Kovalevskaya top" if is_zero(strength) else "twisted Kovalevskaya top"
        return cls(inertia=(2, 2, 1), a=(-1, 0, 0), epsilon=epsilon, name=name)

    @classmethod
    def charged_heavy(cls, inertia: Sequence[Parameter], a: Sequence[Parameter], b: Sequence[Parameter]) -> Top:
        """The charged heavy top: two fields, semidirect bracket."""
        return cls(inertia=inertia, a=a, b=b, name="charged heavy top")

    @classmethod
    def charged_lagrange(
        cls, *, transverse: Parameter = 1, axial: Parameter = "1/2", a3: Parameter = 1, b3: Parameter = 1
    ) -> Top:
        """The charged Lagrange top: symmetric, with mass and charge centred on the axis."""
        inertia = (transverse, transverse, axial)
        return cls(inertia=inertia, a=(0, 0, a3), b=(0, 0, b3), name="charged Lagrange top")

    @classmethod
    def twisted(
        cls,
        inertia: Sequence[Parameter],
        a: Sequence[Parameter],
        b: Sequence[Parameter] = (0, 0, 0),
        epsilon: Parameter = 1,
    ) -> Top:
        """The twisted top: the Leibniz bracket with cocycle strength epsilon."""
        return cls(inertia=inertia, a=a, b=b, epsilon=epsilon, name="twisted top")

    @classmethod
    def twisted_lagrange(
        cls,
        *,
        transverse: Parameter = 1,
        axial: Parameter = "1/2",
        a3: Parameter = 1,
        b3: Parameter = 0,
        epsilon: Parameter = 1,
    ) -> Top:
        """The twisted Lagrange top, charged if b3 is not zero; integrable."""
        inertia = (transverse, transverse, axial)
        return cls(inertia=inertia, a=(0, 0, a3), b=(0, 0, b3), epsilon=epsilon, name="twisted Lagrange top")

    @classmethod
    def twisted_kovalevskaya(cls, epsilon: Parameter = 1) -> Top:
        """The twisted Kovalevskaya top, I = (2, 2, 1), a = (-1, 0, 0), b = 0."""
        return cls.kovalevskaya(epsilon)

    def _check_hamiltonian(self) -> None:
        """Nothing is left to check: the Hamiltonian of a top is what its parameters say."""

    def without_value(self, states: ArrayLike) -> dict[str, NDArray[np.bool_]]:
        """Nothing: the Hamiltonian of a top is a polynomial, real at all states."""
        return {}

    def _recognise_top(self) -> TopParameters:
        return self._top

    def _is_held_by(self, top: TopParameters) -> bool:
        return True


def _check_inertia(inertia: ExactVector) -> None:
    for k, moment in enumerate(inertia):
        if is_negative(moment) or is_zero(moment):
            raise ParameterError(
                f"inertia must be three positive moments; got I{k + 1} = {moment}. Give I1, I2, I3 > 0."
            )
    warn_of_impossible_bodies(inertia)


def _default_name(top: TopParameters) -> str:
    if not is_zero(top.epsilon):
        return "twisted top"
    if not all(is_zero(value) for value in top.b):
        return "charged heavy top"
    return "free rigid body" if all(is_zero(value) for value in top.a) else "heavy top"

"""Brackets that are made of one: in other coordinates, of invariants of a symmetry, with constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from liepoisson.facades import function_of
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.poisson_structure import PoissonStructure

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.parameters import GivenValue
    from liepoisson.structure.bracket import Bracket


@explains_its_methods
class Reductions(PoissonStructure):
    """A Poisson tensor from which others are made."""

    def in_variables(
        self, variables: Mapping[str, str | Expr], inverse: Mapping[str, str | Expr], *, check: bool = True
    ) -> Bracket:
        r"""The same bracket in other coordinates y(x).

        $$\{y_a, y_b\} = \sum_{ij} \partial_i y_a\, J_{ij}\, \partial_j y_b .$$

        It is a `PoissonTensor`, whose Casimirs are those of this bracket, in the new coordinates.  Where this bracket
        has angles the new coordinates must be functions on their circles, or angles that go round once.

        Example:
            >>> bent = lp.canonical(1).in_variables({"x": "q1", "y": "p1 + q1^2"}, {"q1": "x", "p1": "y - x^2"})
            >>> bent.poisson_tensor()
            Matrix([
            [ 0, 1],
            [-1, 0]])

        Args:
            variables: The new coordinates, as functions of the old ones.
            inverse: The old coordinates, as functions of the new ones.
            check: Verify the Jacobi identity of the result, which it has if this is a Poisson bracket.

        Raises:
            BracketError: the functions are not inverse to each other, a coordinate is missing, a new one is neither a
                function on the circles of the angles nor an angle, or the bracket has time.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: a name is none that a user may choose.
        """
        return function_of("Reductions.in_variables")(self, variables, inverse, check=check)

    def in_invariants(
        self, invariants: Mapping[str, str | Expr], *, levels: Mapping[str, str | Expr] | None = None
    ) -> Bracket:
        r"""The bracket of functions that are closed under it, such as the invariants of a symmetry: Poisson reduction.

        $$\{f_a, f_b\} = P_{ab}(f_1, \dots, f_k) .$$

        It is a `PoissonTensor` in the functions as coordinates.  That each bracket is a polynomial in them is decided
        exactly, and it is computed, by a Gröbner basis; a denominator may be a polynomial in them, too.  Relations
        between the functions, such as $w_1^2 + w_2^2 + w_3^2 = w_0^2$, are Casimirs of the result, whose value is 0 on
        states that come from here; so are Casimirs of this bracket that are functions of the invariants.

        Example:
            >>> plane = lp.canonical(2).in_invariants(
            ...     {"r": "q1^2 + q2^2", "s": "q1*p1 + q2*p2", "p": "p1^2 + p2^2"}, levels={"L": "q1*p2 - q2*p1"}
            ... )
            >>> plane.poisson_tensor()
            Matrix([
            [   0, 2*r, 4*s],
            [-2*r,   0, 2*p],
            [-4*s, -2*p, 0]])
            >>> plane.casimirs()
            [L**2 - p*r + s**2]

        Args:
            invariants: The functions by the names of the new coordinates, polynomials or rational functions with
                rational coefficients.
            levels: Components of the momentum map that are constant on the reduced phase space, by name: functions
                whose brackets with all invariants are 0.  They are symbolic parameters of the result.

        Raises:
            BracketError: a bracket of two functions is no polynomial in them, the Jacobi identity holds only where
                their relations do, a level does not commute with an invariant, an invariant is neither a function on
                the circles of the angles nor an angle, the bracket has time, or it was not decided within its limits.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: a name is none that a user may choose, or a function is not rational.

        References: [marsden1999], section 10.5; [cox2015], section 7.3.
        """
        return function_of("Reductions.in_invariants")(self, invariants, levels=levels)

    def dirac_bracket(
        self,
        constraints: Sequence[str | Expr] | Mapping[str, str | Expr],
        parameters: Mapping[str, GivenValue] | None = None,
        *,
        symbols: Sequence[str] = (),
    ) -> Bracket:
        r"""The Dirac bracket of constraints of second class, in the same coordinates.

        $$\{f, g\}_D = \{f, g\} - \sum_{ab} \{f, \phi_a\}\, (C^{-1})_{ab}\, \{\phi_b, g\}, \qquad
          C_{ab} = \{\phi_a, \phi_b\} .$$

        It is a `PoissonTensor`, defined where the determinant of C does not vanish.  Its Casimirs are the constraints,
        in their order, and those of this bracket.  Motion that begins where the constraints vanish stays there; a
        Hamiltonian has the same values as before.

        That the determinant does not vanish identically on any part of the set of the constraints is decided for
        rational functions with rational coefficients; for others it is tried at states of this set in 50 digits.

        Example:
            >>> sphere = lp.canonical(names=("x", "y", "z")).dirac_bracket(
            ...     ["x^2 + y^2 + z^2 - 1", "x*p_x + y*p_y + z*p_z"]
            ... )
            >>> sphere.poisson_tensor()[0, 3]
            (y**2 + z**2)/(x**2 + y**2 + z**2)

        Args:
            constraints: The functions phi that vanish, a list or a mapping from names.
            parameters: Values of other names in them.
            symbols: Names in them that stay symbolic and are taken as generic, besides those of the bracket.

        Raises:
            ConstraintError: a combination of them is first class; the error names it.
            BracketError: they contradict each other, their gradients are dependent where they vanish, one is constant,
                the bracket has time, a parameter is called like a coordinate or a symbol of the bracket, or whether
                they are of second class was not decided.
            ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: no list of functions, or one is no function on the circle of an angle.

        References: Dirac, Canad. J. Math. 2 (1950) 129; [marsden1999], section 8.5.
        """
        return function_of("Reductions.dirac_bracket")(self, constraints, parameters, symbols=symbols)

r"""Variations of homoclinic orbits that fall off both ways: where the manifolds of an equilibrium are tangent.

A variation $\dot v = DX(x(t))\,v$ falls off for $t\to\pm\infty$ where v is tangent to the stable and to the unstable
manifold.  The Poisson tensor takes the bounded solutions of the adjoint equation, $\psi = \nabla K$ of an integral, to
these, $v = J\psi = X_K$, and

$$ \int\psi\cdot X_{H_1}dt = -\int\nabla H_1(x(t))\cdot v(t)\,dt . $$

A pair (x, v) is an orbit of the system of variations, homoclinic to $(x_*, 0)$, and is computed as such.

References: [palmer1984].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.compile.field import Field
from liepoisson.errors import OrbitError, ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.stable_manifolds import OFF, StableManifold
from liepoisson.portable import linear

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from liepoisson.model.phase_functions import PhaseFunction
    from liepoisson.model.system import System


@dataclass(frozen=True)
class Variations:
    r"""The system of $(x, v)$ with $\dot v = DX(x)\,v$.

    Attributes:
        system: The system of x.
    """

    system: System

    @property
    def name(self) -> str:
        """The name of the system of x."""
        return self.system.name

    @property
    def component_names(self) -> tuple[str, ...]:
        """Those of x, and of v."""
        return (*self.system.component_names, *(f"d{name}" for name in self.system.component_names))

    def field(self) -> Field:
        """Quadratic if the system is linear or quadratic, else a tape."""
        from sympy import Dummy, Matrix

        from liepoisson.compile.lowering import field_of_equations

        v = [Dummy(f"d{name}", real=True) for name in self.system.component_names]
        rates = [*self.system.equations.values(), *(self.system.jacobian * Matrix(v))]
        return field_of_equations([*self.system.variables, *v], rates)

    def without_value(self, states: Array) -> dict[str, NDArray[np.bool_]]:
        """Where invariants of the system of x are no real numbers, by name."""
        return self.system.without_value(states[..., : states.shape[-1] // 2])


@dataclass(frozen=True)
class Work:
    r"""$-\nabla f(x)\cdot v$ as a function of (x, v).

    Attributes:
        function: f.
    """

    function: PhaseFunction

    def __call__(self, states: Array) -> Array:
        """Values, shape (...), at states of shape (..., 2N)."""
        x, v = np.split(states, 2, axis=-1)
        return -(self.function.gradient(x) * v).sum(axis=-1)

    def gradient(self, states: Array) -> Array:
        """Gradients, shape (..., 2N)."""
        x, v = np.split(states, 2, axis=-1)
        slope = linear.matmul(self.function.hessian(x), v[..., None])[..., 0]
        return -np.concatenate([slope, self.function.gradient(x)], axis=-1)


def common_variation(
    system: System, manifolds: Sequence[StableManifold], states: Array, first: int, run: RunOptions
) -> Array:
    """The unit vectors tangent to both manifolds and orthogonal to the flow, shape (orbit, N).

    Flow and vector have one orientation of the stable manifold, the same for all orbits.

    Args:
        system: The system.
        manifolds: The stable and the unstable manifold.
        states: States on homoclinic orbits, shape (orbit, N).
        first: The number of the first orbit.
        run: How they are followed.

    Raises:
        ParameterError: the manifolds are not of dimension two.
        OrbitError: a state is on no homoclinic orbit, or on one along which the manifolds are not tangent.
    """
    if manifolds[0].away.shape[1] != 2:
        raise ParameterError(
            "integrals: wanted some, or an equilibrium with two growing directions, so that one is beside the flow; "
            f"got one with {manifolds[0].away.shape[1]}"
        )
    flow = system.vector_field(states)
    flow = flow / linear.norm(flow, axis=1, keepdims=True)
    sides, turns = list[Array](), list[Array]()
    for manifold in manifolds:
        orbits = manifold.orbits(states, first, run)
        frames = linear.qr(linear.matmul(system.functions.poisson_tensor(orbits.node), orbits.conormal)).Q
        along = linear.einsum("nia,ni->na", frames[:, 0], flow)
        side = linear.einsum("nia,na->ni", frames[:, 0], np.stack([-along[:, 1], along[:, 0]], axis=1))
        sides.append(side / linear.norm(side, axis=1, keepdims=True))
        steps = linear.matmul(np.swapaxes(frames[:, 1:], 2, 3), linear.matmul(orbits.slope, frames[:, :-1]))
        ends = linear.matmul(manifold.inward, frames[:, -1])
        turns.append(np.sign(linear.det(steps)).prod(axis=1) * np.sign(linear.det(ends)))
    sides[0] = sides[0] * turns[0][:, None]
    sides[1] = sides[1] * np.sign((sides[0] * sides[1]).sum(axis=1, keepdims=True))
    angle = linear.norm(sides[0] - sides[1], axis=1)
    if (apart := angle >= OFF).any():
        k = int(apart.argmax())
        raise OrbitError(
            f"integrals: wanted some, or orbits along which both manifolds are tangent; those of orbit {first + k} are "
            f"{angle[k]:.2g} rad apart beside the flow: transversal in its level, it persists, and nothing splits"
        )
    both = sides[0] + sides[1]
    return both / linear.norm(both, axis=1, keepdims=True)

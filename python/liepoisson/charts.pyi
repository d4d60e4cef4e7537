# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.exact.canonical.canonical_system import CanonicalSystem as CanonicalSystem
from liepoisson.exact.canonical.euler_chart import EulerChart as EulerChart
from liepoisson.exact.canonical.lagrange_reduction import ReducedLagrange as ReducedLagrange
from liepoisson.exact.canonical.leaf_constants import LeafConstants as LeafConstants
from liepoisson.exact.canonical.ordinary_lagrange import OrdinaryLagrange as OrdinaryLagrange
from liepoisson.exact.canonical.quaternion_chart import QuaternionChart as QuaternionChart

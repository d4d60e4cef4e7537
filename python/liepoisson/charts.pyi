# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.exact.charts.euler_chart import EulerChart as EulerChart
from liepoisson.exact.charts.lagrange_reduction import ReducedLagrange as ReducedLagrange
from liepoisson.exact.charts.leaf_constants import LeafConstants as LeafConstants
from liepoisson.exact.charts.ordinary_lagrange import OrdinaryLagrange as OrdinaryLagrange
from liepoisson.exact.charts.quaternion_chart import QuaternionChart as QuaternionChart

# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.model.charts.euler_chart import EulerChart as EulerChart
from liepoisson.model.charts.lagrange_reduction import OrdinaryLagrange as OrdinaryLagrange
from liepoisson.model.charts.lagrange_reduction import ReducedLagrange as ReducedLagrange
from liepoisson.model.charts.leaf_constants import LeafConstants as LeafConstants
from liepoisson.model.charts.quaternion_chart import QuaternionChart as QuaternionChart

# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.numeric.method.gauss import Gauss as Gauss
from liepoisson.numeric.method.lagrange_map import LagrangeMap as LagrangeMap
from liepoisson.numeric.method.runge_kutta import RungeKutta as RungeKutta
from liepoisson.numeric.method.splitting import Splitting as Splitting
from liepoisson.numeric.method.taylor import Taylor as Taylor
from liepoisson.numeric.methods import Auto as Auto

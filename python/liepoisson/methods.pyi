# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.numeric.methods import Auto as Auto
from liepoisson.numeric.methods import Gauss as Gauss
from liepoisson.numeric.methods import LagrangeMap as LagrangeMap
from liepoisson.numeric.methods import RungeKutta as RungeKutta
from liepoisson.numeric.methods import Splitting as Splitting
from liepoisson.numeric.methods import Taylor as Taylor

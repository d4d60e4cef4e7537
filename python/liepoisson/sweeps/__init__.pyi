# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.sweeps.run import sweep as sweep
from liepoisson.sweeps.spec import Axis as Axis
from liepoisson.sweeps.spec import Refinement as Refinement
from liepoisson.sweeps.spec import Starts as Starts
from liepoisson.sweeps.spec import SweepSpec as SweepSpec

# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.damping.damped_system import DampedSystem as DampedSystem
from liepoisson.damping.damped_system import Damping as Damping
from liepoisson.damping.damped_system import Law as Law
from liepoisson.damping.damped_system import double_bracket as double_bracket
from liepoisson.damping.damped_system import metriplectic as metriplectic
from liepoisson.equilibrium.relaxation import relax as relax

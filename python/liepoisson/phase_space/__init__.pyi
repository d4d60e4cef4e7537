# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.numeric.sampling import sample_states as sample_states
from liepoisson.phase_space.leaf import Leaf as Leaf
from liepoisson.phase_space.leaf_equilibria import equilibria as equilibria
from liepoisson.phase_space.leaf_equilibria import equilibrium_near as equilibrium_near
from liepoisson.phase_space.orbit_bounds import bounds as bounds
from liepoisson.phase_space.sleeping import sleeping_top as sleeping_top
from liepoisson.phase_space.stability import equilibrium as equilibrium
from liepoisson.phase_space.starts import Start as Start
from liepoisson.phase_space.starts import find_start as find_start

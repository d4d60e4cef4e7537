# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.equilibrium.equilibrium_families import equilibrium_family as equilibrium_family
from liepoisson.equilibrium.leaf_equilibria import equilibria as equilibria
from liepoisson.equilibrium.leaf_equilibria import equilibrium_near as equilibrium_near
from liepoisson.equilibrium.sleeping import sleeping_top as sleeping_top
from liepoisson.equilibrium.stability import equilibrium as equilibrium
from liepoisson.leaf.leaf import Leaf as Leaf
from liepoisson.leaf.orbit_bounds import bounds as bounds
from liepoisson.leaf.starts import Start as Start
from liepoisson.leaf.starts import find_start as find_start
from liepoisson.numeric.sampling import sample_states as sample_states

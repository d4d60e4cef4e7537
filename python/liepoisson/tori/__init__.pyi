# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.tori.birkhoff_averages import rotation_number as rotation_number
from liepoisson.tori.carried_lattices import monodromy as monodromy
from liepoisson.tori.critical_polynomials import critical_equations as critical_equations
from liepoisson.tori.critical_search import critical_states as critical_states
from liepoisson.tori.diagrams import diagram as diagram
from liepoisson.tori.fibre_regions import regions as regions
from liepoisson.tori.fibres import fibre as fibre
from liepoisson.tori.lagrange_braids import lagrange_monodromy as lagrange_monodromy
from liepoisson.tori.lagrange_braids import thread_loop as thread_loop
from liepoisson.tori.lagrange_diagrams import lagrange_diagram as lagrange_diagram
from liepoisson.tori.lagrange_lattices import lagrange_actions as lagrange_actions
from liepoisson.tori.lagrange_lattices import lagrange_lattice as lagrange_lattice
from liepoisson.tori.lagrange_leaves import leaf_class as leaf_class
from liepoisson.tori.molecules import molecule as molecule
from liepoisson.tori.momentum_maps import momentum_map as momentum_map
from liepoisson.tori.period_lattices import period_lattice as period_lattice

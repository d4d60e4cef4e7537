# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.proofs.box import Box as Box
from liepoisson.proofs.certificate import load_covering_certificate as load_covering_certificate
from liepoisson.proofs.enclosures import enclose_flow as enclose_flow
from liepoisson.proofs.enclosures import enclose_section_map as enclose_section_map
from liepoisson.proofs.equilibrium_enclosures import enclose_equilibria as enclose_equilibria
from liepoisson.proofs.equilibrium_enclosures import prove_equilibrium as prove_equilibrium
from liepoisson.proofs.periodic_enclosures import prove_periodic_orbit as prove_periodic_orbit
from liepoisson.proofs.search import find_certificate as find_certificate
from liepoisson.proofs.theorem import prove_chaos as prove_chaos

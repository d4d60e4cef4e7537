# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.proofs.certificate import load_covering_certificate as load_covering_certificate
from liepoisson.proofs.search import find_certificate as find_certificate
from liepoisson.proofs.theorem import prove_chaos as prove_chaos

# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.structure.lie_algebra import LieAlgebra as LieAlgebra
from liepoisson.structure.lie_algebras import abelian as abelian
from liepoisson.structure.lie_algebras import affine as affine
from liepoisson.structure.lie_algebras import gl as gl
from liepoisson.structure.lie_algebras import heisenberg as heisenberg
from liepoisson.structure.lie_algebras import se as se
from liepoisson.structure.lie_algebras import semidirect_sum as semidirect_sum
from liepoisson.structure.lie_algebras import sine as sine
from liepoisson.structure.lie_algebras import sl as sl
from liepoisson.structure.lie_algebras import so as so
from liepoisson.structure.lie_algebras import su as su

# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.structure.classification import Classification as Classification
from liepoisson.structure.classification import LocalFactor as LocalFactor
from liepoisson.structure.cohomology.cocycle import ChangeOfVariables as ChangeOfVariables
from liepoisson.structure.cohomology.cocycle import Cocycle as Cocycle
from liepoisson.structure.cohomology.cocycle import Obstruction as Obstruction
from liepoisson.structure.cohomology.deformed_algebra import Deformation as Deformation
from liepoisson.structure.cohomology.twist_orbits import TwistForm as TwistForm
from liepoisson.structure.cohomology.twist_orbits import TwistOrbit as TwistOrbit
from liepoisson.structure.cohomology.twist_orbits import TwistOrbits as TwistOrbits
from liepoisson.structure.cohomology.twists import Twists as Twists
from liepoisson.structure.cohomology.twists import cocycles as cocycles
from liepoisson.structure.extension import Extension as Extension
from liepoisson.structure.extensions import crmhd as crmhd
from liepoisson.structure.extensions import leibniz as leibniz
from liepoisson.structure.extensions import semidirect as semidirect
from liepoisson.structure.extensions import trivial as trivial
from liepoisson.structure.normal_forms import normal_forms as normal_forms

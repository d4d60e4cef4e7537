# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.structure.classification import Classification as Classification
from liepoisson.structure.classification import LocalFactor as LocalFactor
from liepoisson.structure.extension import Extension as Extension
from liepoisson.structure.extensions import binary_cubic as binary_cubic
from liepoisson.structure.extensions import crmhd as crmhd
from liepoisson.structure.extensions import leibniz as leibniz
from liepoisson.structure.extensions import semidirect as semidirect
from liepoisson.structure.extensions import trivial as trivial
from liepoisson.structure.normal_forms import normal_forms as normal_forms

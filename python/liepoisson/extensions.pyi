# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.exact.classification import Classification as Classification
from liepoisson.exact.classification import LocalFactor as LocalFactor
from liepoisson.exact.extension import Extension as Extension
from liepoisson.exact.extensions import crmhd as crmhd
from liepoisson.exact.extensions import leibniz as leibniz
from liepoisson.exact.extensions import semidirect as semidirect
from liepoisson.exact.extensions import trivial as trivial
from liepoisson.exact.normal_forms import normal_forms as normal_forms

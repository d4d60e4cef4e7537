# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.model.canonical_system import CanonicalSystem as CanonicalSystem
from liepoisson.model.discrete_symmetries import DiscreteSymmetry as DiscreteSymmetry
from liepoisson.model.discrete_symmetries import discrete_symmetries as discrete_symmetries
from liepoisson.model.phase_functions import PhaseFunction as PhaseFunction
from liepoisson.model.system import System as System
from liepoisson.model.system_file import Integral as Integral
from liepoisson.model.system_file import Reference as Reference
from liepoisson.model.system_file import SystemFile as SystemFile
from liepoisson.model.system_file_reader import read_system as read_system
from liepoisson.model.system_file_reader import read_system_file as read_system_file
from liepoisson.model.system_text import write_system as write_system
from liepoisson.model.tops import Top as Top
from liepoisson.model.vector_field import VectorField as VectorField
from liepoisson.report.describe import Report as Report
from liepoisson.report.describe import inspect as inspect
from liepoisson.report.vector_notation import vector_notation as vector_notation

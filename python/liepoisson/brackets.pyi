# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.structure.automorphisms import Automorphism as Automorphism
from liepoisson.structure.bracket import Bracket as Bracket
from liepoisson.structure.canonical_bracket import canonical as canonical
from liepoisson.structure.casimirs import CasimirReport as CasimirReport
from liepoisson.structure.certificates import CasimirCertificate as CasimirCertificate
from liepoisson.structure.certificates import JacobiCertificate as JacobiCertificate
from liepoisson.structure.certificates import RankCertificate as RankCertificate
from liepoisson.structure.contractions import ContractedBracket as ContractedBracket
from liepoisson.structure.contractions import contraction as contraction
from liepoisson.structure.derivations import Derivation as Derivation
from liepoisson.structure.poisson.semi_invariants import SemiInvariant as SemiInvariant
from liepoisson.structure.strata import Locus as Locus
from liepoisson.structure.strata import Stratum as Stratum
from liepoisson.structure.tensor_bracket import PoissonTensor as PoissonTensor
from liepoisson.structure.tensor_sources import log_canonical as log_canonical
from liepoisson.structure.tensor_sources import nambu as nambu
from liepoisson.structure.tensor_sources import product as product

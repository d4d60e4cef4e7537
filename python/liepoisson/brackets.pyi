# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.exact.automorphisms import Automorphism as Automorphism
from liepoisson.exact.bracket import Bracket as Bracket
from liepoisson.exact.canonical_bracket import canonical as canonical
from liepoisson.exact.casimirs import CasimirReport as CasimirReport
from liepoisson.exact.certificates import JacobiCertificate as JacobiCertificate
from liepoisson.exact.certificates import RankCertificate as RankCertificate
from liepoisson.exact.derivations import Derivation as Derivation
from liepoisson.exact.locus import Locus as Locus
from liepoisson.exact.strata import Stratum as Stratum

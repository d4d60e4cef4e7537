"""Words by which users look for a page and which its text does not have: other tools' names for what it tells.

The search box counts them like words of a heading (static/search.js).
"""

from __future__ import annotations

import json
from pathlib import Path

WORDS = {
    # How to begin, and what may go wrong.
    "installing": "install pip conda wheel download requirements windows mac linux arm size",
    "getting-started": "tutorial quickstart first example begin simulate simulation solve ode dense output interpolate "
    "interpolation tangent vectors variational equations jacobian derivative of the flow",
    "what-can-go-wrong": "pitfalls caveats trap mistake wrong warning bug convergence convergent sticky",
    "glossary": "dictionary terms meaning coadjoint orbit noncanonical momentum map",
    "notation": "symbols conventions sign convention",
    # Systems.
    "systems": "own custom define model user-defined hamiltonian ode right-hand side vector field parameters toml file",
    "brackets": "define own poisson bracket structure constants lie algebra semidirect central extension cocycle "
    "casimir jacobi identity coadjoint exact",
    "cocycles": "cocycle coboundary cohomology harrison hochschild deformation deform obstruction versal unfolding "
    "orbit binary cubic contraction inonu wigner limit rigid twist extension",
    "canonical": "canonical separable hamiltonian pendulum symplectic potential kinetic momenta coordinates escape",
    "angles-and-forcing": "angle periodic coordinate circle torus modulo turn wrap rotation time-dependent time "
    "dependent nonautonomous non-autonomous periodically driven forcing external kicked stroboscopic kapitza floquet",
    "vector-fields": "ode equations right-hand side dissipative friction forcing driven attractor lorenz strange "
    "polynomial invariant surface volterra autonomous",
    "catalog": "models list examples library built-in ready-made literature",
    "tops": "rigid body spinning euler lagrange kovalevskaya goryachev chaplygin heavy top gyroscope quaternion",
    # Integrate.
    "methods": "integrator solver stepper order symplectic geometric runge kutta taylor splitting variational "
    "tolerance accuracy adaptive timestep conservation",
    "frames": "attitude orientation rotation quaternion body space elastica kirchhoff rod animation",
    # Exponents and chaos.
    "exponents": "lyapunov exponent lyapunov convergence converge uncertainty error bars confidence interval "
    "finite-time ftle saturation benettin tangent vectors deviation vectors variational",
    "noise": "stochastic sde random brownian stratonovich langevin thermal temperature bath gibbs fluctuation "
    "kolmogorov fokker planck ensemble hitting time escape kubo",
    "spectrum": "lyapunov spectrum exponents convergence uncertainty error bars confidence tangent vectors "
    "covariant vectors clv clvs ginelli qr gram schmidt hamiltonian flow oseledets kaplan yorke",
    "chaos": "chaos indicators megno sali gali frequency map analysis laskar naff sticky orbit regular "
    "detect tangent deviation alignment rotation number winding number",
    "sweeps": "parameter scan map grid study bifurcation continue continuation resume restart interrupted "
    "interruption checkpoint parallel multiprocessing threads progress energies leaves",
    "cluster": "dask slurm hpc mpi distributed parallel workers resume restart checkpoint interruption parameter sweep",
    # Sections and orbits.
    "sections": "poincare map surface section event events event detection root finding zero crossing missed "
    "crossings never missed find detect return map stop terminal",
    "orbits": "periodic homoclinic heteroclinic reversible symmetry shooting newton monodromy stability "
    "multipliers floquet horseshoe",
    "damping": "friction dissipation double bracket metriplectic entropy relaxation gradient flow",
    "equilibria": "fixed points stationary relative equilibrium stability linear eigenvalues energy casimir "
    "bifurcation critical points steady",
    "leaves": "initial conditions start starts random sampling sample microcanonical energy surface energy "
    "shell level set symplectic leaf coadjoint orbit liouville measure reachable",
    "charts": "canonical coordinates darboux euler angles andoyer serret reduction reduced quaternion singularity",
    # Proofs.
    "integrability": "first integrals constants of motion conserved quantities invariants polynomial killing "
    "integrable liouville certificate prove check",
    "lax": "lax pair isospectral spectral curve integrable",
    "painleve": "painleve property kovalevskaya exponents test laurent pole movable singularity resonances ars "
    "kowalevski",
    "galois": "morales ramis ziglin galois differential nonintegrable non-integrability kovacic variational monodromy",
    "enclosures": "interval arithmetic validated rigorous computer-assisted verified numerics capd krawczyk "
    "interval newton",
    "proof": "rigorous chaos computer-assisted horseshoe covering relations symbolic dynamics topological "
    "entropy theorem",
    # The rest.
    "laboratory": "browser interactive widget notebook jupyter marimo webassembly gui visualize animation app online",
    "gallery/index": "figures plots pictures examples scripts plotting matplotlib publish",
    "command-line": "cli terminal shell commands console options",
    "saved-results": "save saved load reload open read file files format repeat reproduce rerun reproducibility export "
    "pickle hdf5 netcdf xarray",
    "tables": "table dataframe pandas csv spreadsheet excel columns tidy export own figure axes matplotlib",
    "names": "api public functions modules",
    "comparison": "compare alternatives versus other tools software mathematica matlab julia",
    "coming-from-dynamicalsystems": "julia chaostools dynamicalsystems differentialequations orbitdiagram",
    "coming-from-heyoka": "taylor heyoka",
    "coming-from-scipy": "scipy solve_ivp odeint python matlab ode45",
    "coming-from-rebound": "nbody n-body rebound whfast megno",
    "coming-from-sage-and-mathematica": "sage sagemath mathematica maple symbolic lie algebra computer algebra exact "
    "algebras "
    "sage sagemath mathematica maple symbolic lie algebra computer algebra exact algebras",
    "stories/the-paper-in-an-hour": "tutorial twisted top paper reproduce figure walkthrough",
    "stories/from-a-hamiltonian-to-a-verdict": "tutorial integrable chaotic regular decide walkthrough",
    "stories/from-laptop-to-cluster": "tutorial sweep dask resume interrupted parallel notebook walkthrough",
    # Names.
    "reference/orbits.integrate": "hamiltonian flow simulate solve ode output times dense interpolate interpolation "
    "given "
    "trajectory tangent vectors variational events",
    "reference/results.Orbit": "trajectory solution dense output interpolate interpolation evaluate times",
    "reference/sections.section": "poincare event events detection missed find zero crossing root",
    "reference/sections.section_starts": "initial conditions random section energy",
    "reference/sections.section_state": "initial condition point of section energy",
    "reference/phase_space.Leaf": "initial conditions start random sample energy surface microcanonical casimir values",
    "reference/phase_space.sample_states": "initial conditions starts surface leaf random energy microcanonical",
    "reference/phase_space.find_start": "initial condition start energy casimirs",
    "reference/chaos.lyapunov_exponent": "largest maximal convergence uncertainty error bar tangent vector",
    "reference/chaos.lyapunov_spectrum": "exponents covariant vectors clv convergence uncertainty error bar "
    "tangent vectors qr "
    "exponents covariant vectors clv convergence uncertainty error bar tangent vectors qr",
    "reference/chaos.finite_time_exponents": "ftle distribution ensemble random initial conditions",
    "reference/chaos.frequency_drift": "frequency map analysis laskar naff diffusion",
    "reference/chaos.alignment": "sali gali deviation vectors",
    "reference/chaos.decide": "regular chaotic verdict classify",
    "reference/sweeps.sweep": "parameter scan grid map resume restart interruption checkpoint parallel dask",
    "reference/results.CovariantVectors": "clv covariant lyapunov vectors hyperbolicity angles",
    "reference/results.load": "reload open read file repeat",
    "reference/results.rerun": "repeat reproduce reload reproducibility",
    "reference/citations.cite": "bibtex citation doi reference",
    "reference/systems.System": "own custom define model parameters",
    "reference/systems.CanonicalSystem": "own custom canonical hamiltonian coordinates momenta",
    "reference/brackets.Bracket": "define own poisson structure jacobi",
    "reference/algebras.LieAlgebra": "define structure constants exact brackets casimirs",
    "reference/extensions.Extension": "cocycle leibniz semidirect central classification",
    "reference/integrability.first_integrals": "constants of motion conserved quantities invariants polynomial",
}


def write(static: Path) -> None:
    """Write the table beside the scripts that use it."""
    text = json.dumps(WORDS, indent=0, sort_keys=True)
    (static / "search_words.js").write_text(f"window.searchWords = {text};\n", encoding="utf-8")


def unknown(pages: set[str]) -> set[str]:
    """Pages of the table that the site does not have."""
    return set(WORDS) - pages

"""What the letters of the report stand for, in the order in which a reader meets them."""

SYMBOLS: tuple[tuple[str, str], ...] = (
    ("l, α, β", "angular momentum and the two fields; together the state, nine numbers"),
    ("I = (I₁, I₂, I₃)", "principal moments of inertia, I_max the largest"),
    ("ω", "angular velocity, ω = I⁻¹l"),
    ("a, b", "centres of mass and of charge, constant vectors with components a₁, …, b₃"),
    ("ε", "strength of the cocycle; ε = 0 is the charged top, ε ≠ 0 the twisted one"),
    ("H", "energy, l·ω/2 + a·α + b·β, equation (1)"),
    ("{f, g}, J", "Poisson bracket of two functions, and its tensor: {f, g} = ∇f·J∇g with ∇ the gradient"),
    ("C₁, C₂, C₃", "Casimirs |α|² + 2ε l·β, α·β, |β|², equation (7)"),
    ("w, v, η", "constants of a leaf: w² = C₃, v = C₂/w, η = C₁ − v²"),
    ("v⊥, r", "length of the part of α orthogonal to β: v⊥² = r² = η − 2ε l·β"),
    ("q = (φ, ψ, θ), p", "Euler angles and their momenta (p_φ, p_ψ, p_θ)"),
    ("A, L", "rotation matrix from space to body, and the matrix of l = Lp, equations (9) and (10)"),
    ("e∥, e⊥", "unit vectors fixed in space, of β and of the part of α orthogonal to it; e₁, e₂, e₃ are the axes"),
    ("T, V", "kinetic and potential energy; V is equation (15)"),
    ("P", "l·α + ε I₁a₃β₃, the third integral of the twisted Lagrange top, equation (8)"),
    ("K", "the quartic integral of the ordinary Kovalevskaya top"),
    ("t", "time; d/dt is the derivative along the flow of H"),
    ("δl, δα, δβ", "variations of the state: solutions of the equations linearised along an orbit"),
    ("λ(t), ⟨λ(t)⟩", "largest Lyapunov exponent of one start up to the time t, and its mean over the starts"),
    ("λ, c₁, c₀", "coefficients of the fit ⟨λ(t)⟩ = λ + c₁/√t + c₀/t"),
    ("χ²", "squared distance of fitted numbers, with their errors and correlations"),
    ("ℝ, ℂ, ℤ₂", "real numbers, complex numbers, the group of two elements"),
    ("so(3), SO(3), T*SO(3)", "rotation algebra, rotation group, its phase space; ⊗ is the tensor product"),
)
"""Pairs of symbol and meaning."""

"""The claims that are decided by measurement, for the tests of both kinds."""

NUMERICAL = (
    "twisted-kovalevskaya-chaotic",
    "lyapunov-exponent-value",
    "printed-fit",
    "ordinary-exponent-vanishes",
    "dashed-curve-inertia",
    "parameters-fix-exponent",
    "single-exponent",
)

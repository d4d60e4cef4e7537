"""Phase space: leaves and samples on them, bounds, equilibria, frames, surfaces of section."""

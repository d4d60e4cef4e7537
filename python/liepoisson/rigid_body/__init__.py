"""Frames and rods: what a body does in space."""

"""Indicators of chaos, with errors."""

"""The laboratory: any system in a browser, computed there by the same core."""

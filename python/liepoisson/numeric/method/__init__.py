"""The methods of integration, each in a file of its name, as data."""

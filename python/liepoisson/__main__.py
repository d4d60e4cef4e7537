"""`python -m liepoisson` is the command `liepoisson`."""

from liepoisson.cli.main import main

main()

"""Run the commands as ``python -m hoverproof``."""

from hoverproof.cli import main

main()

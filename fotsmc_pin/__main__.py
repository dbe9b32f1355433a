"""`python -m fotsmc_pin` is the command line `fotsmc`."""

from fotsmc_pin.cli import main

main()

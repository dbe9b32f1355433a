"""fractional."""

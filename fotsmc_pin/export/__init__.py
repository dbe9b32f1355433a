"""A tuned controller as C, for where hard real time is."""

from fotsmc_pin.export.export import export_c

__all__ = ["export_c"]

"""Seeing a run: the offline Meshcat page, and figures for papers."""

from fotsmc_pin.view.export import export_html

__all__ = ["export_html"]

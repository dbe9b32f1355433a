"""`write_identification`: what identification found, as one offline page."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import write_text
from fotsmc_pin.view.palette import BLUE, VERMILLION
from fotsmc_pin.view.page import ASSETS
from fotsmc_pin.view.prose import scrolling
from fotsmc_pin.view.report_figures import gallery, drawn
from fotsmc_pin.view.report_tables import html_table
from fotsmc_pin.view.style import new_figure, paper_style

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from fotsmc_pin.identification import Identification, IdentifiedParameter, TorqueCheck

SHOWN = 600
"""Averages that a curve has at most."""

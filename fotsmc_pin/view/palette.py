"""Colours that colour-blind readers can tell apart, after Okabe and Ito (2008)."""

BLUE = "#0072B2"
VERMILLION = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
ORANGE = "#E69F00"
SKY = "#56B4E9"
YELLOW = "#F0E442"
BLACK = "#000000"
GREY = "#5B6572"  # Limits: the colour of no line.

# In the order in which lines take them; yellow is too faint on white and stays out.
COLORS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK)

# Runs in a page are seen on light and on dark ground.
RUN_COLORS = ("#E0661A", "#12A378", "#C76BA0", "#C99700", "#7A7FE0", "#8D8F1D")

# The reference, in the 3D view and its legend.
GHOST_COLOR = "#35a3e0"

# The ball that stands for a payload; `perturb` writes it into the URDF.
PAYLOAD_COLOR = "#2970B8"

# Wrenches: arrows in the page and shades in the plots.
PUSH_COLOR = "#D81B60"

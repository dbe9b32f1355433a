"""Where each number of a stream is stored: rows of `coefficients` and columns of `memory`.

`coefficients` (rows, width) is fixed by the description of an operator and never written again.
`memory` (n, columns) is the whole state: copying it saves a stream, copying it back restores it.
"""

# Rows of `coefficients`. All but the first hold one entry per mode.
HEADER = 0
RATE = 1  # s_k, tempering left out [1/s]
WEIGHT = 2  # w_k
START = 3  # what a first sample of 1 leaves in a mode
DECAY = 4  # factor of a mode over one nominal period
GAIN = 5  # three rows: what value, difference, curvature of a nominal period add to a mode
ROWS = 8

# Columns of the header.
MODES = 0
PERIOD = 1  # nominal [s]
SCHEME = 2
DIFFERENTIATES = 3  # 1: the memory kernel acts on x' + σ x, 0: on x
EXPONENT = 4  # β of the memory kernel t^{-β}/Γ(1-β); 1 stands for no memory
NORMALIZER = 5  # 1/Γ(1-β)
TEMPERING = 6  # σ [1/s]
START_GAIN = 7  # output per unit of the first sample
OUTPUT_GAINS = 8  # three columns: what they add to the output
HEADER_COLUMNS = 11

# Schemes.
LINEAR = 0
QUADRATIC = 1
GRUNWALD_LETNIKOV = 2

# Columns of `memory`. The first two are used in the first row only.
COUNT = 0  # samples seen
LAST_PERIOD = 1  # [s]
LAST = 2  # x_{n-1}
BEFORE_LAST = 3  # x_{n-2}
HISTORY = 4  # the modes' share of the next output, if one nominal period passes until then
FIRST_MODE = 5

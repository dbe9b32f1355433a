"""Studies: the same run many times, over grids and random draws, on all cores or a cluster."""

from fotsmc_pin.studies.cases import Case
from fotsmc_pin.studies.closed_loop import ClosedLoop
from fotsmc_pin.studies.result import Study
from fotsmc_pin.studies.study import study
from fotsmc_pin.studies.study_file import read_study

__all__ = ["Case", "ClosedLoop", "Study", "read_study", "study"]

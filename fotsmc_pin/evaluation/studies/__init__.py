"""Studies: the same run many times, over grids and random draws, on all cores or a cluster."""

from fotsmc_pin.evaluation.studies.cases import Case
from fotsmc_pin.evaluation.studies.closed_loop import ClosedLoop
from fotsmc_pin.evaluation.studies.result import Study
from fotsmc_pin.evaluation.studies.study import study
from fotsmc_pin.evaluation.studies.study_file import read_study

__all__ = ["Case", "ClosedLoop", "Study", "read_study", "study"]

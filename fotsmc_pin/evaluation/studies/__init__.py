"""Studies: the same run many times, over grids and random draws, on all cores or a cluster."""

from fotsmc_pin.evaluation.studies.closed_loop import ClosedLoop
from fotsmc_pin.evaluation.studies.planned_runs import PlannedRun
from fotsmc_pin.evaluation.studies.result import StudyResult
from fotsmc_pin.evaluation.studies.study import check_study, study
from fotsmc_pin.evaluation.studies.study_file import read_study

__all__ = ["PlannedRun", "ClosedLoop", "StudyResult", "check_study", "read_study", "study"]

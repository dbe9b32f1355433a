from . import errors as errors
from . import references as references
from .arms import (
    Arm as Arm,
    Payload as Payload,
    Uniform as Uniform,
    inspect_arm as inspect_arm,
    load_arm as load_arm,
    perturb as perturb,
)
from .control import (
    AdaptiveFONFTSM as AdaptiveFONFTSM,
    CartesianImpedance as CartesianImpedance,
    ComputedTorque as ComputedTorque,
    ContinuousTSM as ContinuousTSM,
    Controller as Controller,
    FONFTSM as FONFTSM,
    FractionalSwitchingSMC as FractionalSwitchingSMC,
    Limits as Limits,
    LinearSMC as LinearSMC,
    NonsingularTSM as NonsingularTSM,
    RobustFONFTSM as RobustFONFTSM,
    Safeguard as Safeguard,
    SpringObserver as SpringObserver,
    SuperTwistingSMC as SuperTwistingSMC,
    TaskSpace as TaskSpace,
    TDEFONTSM as TDEFONTSM,
    TerminalSMC as TerminalSMC,
)
from .fractional import (
    FractionalDerivative as FractionalDerivative,
    FractionalIntegral as FractionalIntegral,
)
from .learning import (
    ModelLearning as ModelLearning,
)
from .simulation import (
    PlantChange as PlantChange,
    Recording as Recording,
    Wrench as Wrench,
    simulate as simulate,
)
from .analysis import (
    Summary as Summary,
    inertia_ratios as inertia_ratios,
    margins as margins,
    summarize as summarize,
)
from .identification import (
    Identification as Identification,
    Log as Log,
    identify as identify,
    identify_payload as identify_payload,
    read_log as read_log,
)
from .evaluation.studies import ClosedLoop as ClosedLoop, StudyResult as StudyResult, study as study
from .evaluation.stress import stress as stress
from .export import export_c as export_c
from .realtime import run_realtime as run_realtime
from .view import export_data as export_data, export_html as export_html, plot as plot

__version__: str

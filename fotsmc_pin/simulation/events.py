"""`PlantChange`: the plant becomes another arm in the middle of a run; what simulate asks of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import Arm
from fotsmc_pin.arms.payload import payload_masses
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, kw_only=True)
class PlantChange:
    """An event of a run: the plant became another arm.

    Attributes:
        time: when [s].
        arm: the arm that the plant was from then on.
        words: what changed by it, in plain words.
    """

    time: float
    arm: Arm
    words: str

    def to_dict(self) -> dict[str, Any]:
        """Return what `from_dict` needs to rebuild it, ready for JSON."""
        return {"time": self.time, "arm": self.arm.to_dict(), "words": self.words}

    @classmethod
    def from_dict(cls, parts: Mapping[str, Any]) -> PlantChange:
        """Rebuild it from `to_dict`."""
        return cls(**{**parts, "arm": Arm.from_dict(parts["arm"])})


def checked_events(
    arm: Arm, given: Mapping[float, Arm] | None, duration: float
) -> tuple[PlantChange, ...]:
    """Return what `simulate(events=...)` was given, in the order of time.

    Raises:
        ArgumentError: no mapping, a time outside the run, or an arm that the plant cannot become.
    """
    if given is None:
        return ()
    checks.instance("events", given, Mapping, "give a mapping from times to arms, {3.0: loaded}")
    timed: list[tuple[float, Arm]] = []
    for time, new in given.items():
        name = f"events[{time!r}]"
        at = checks.finite_number(f"time of {name}", time)
        if not 0.0 < at < duration:
            remedy = f"give a time above 0 and below the run's duration, {duration:g} s"
            raise ArgumentError(f"time of {name}", time, remedy)
        checks.instance(name, new, Arm, "give an arm, as fp.perturb makes it")
        _demand_same_joints(name, arm, new)
        timed.append((at, new))
    timed.sort(key=lambda pair: pair[0])
    stages = [arm, *(new for _, new in timed)]
    words = [_words(before, after) for before, after in pairwise(stages)]
    return tuple(
        PlantChange(time=at, arm=new, words=text)
        for (at, new), text in zip(timed, words, strict=True)
    )


def _demand_same_joints(name: str, arm: Arm, new: Arm) -> None:
    if new.joint_names != arm.joint_names or new.nq != arm.nq:
        ours, theirs = ", ".join(arm.joint_names), ", ".join(new.joint_names)
        one = "; a joint is continuous in one of them only" if ours == theirs else ""
        remedy = f"its joints are {theirs} and the plant's {ours}{one}; perturb the plant's arm"
        raise ArgumentError(name, new, remedy)
    if new.position_units != arm.position_units:
        raise ArgumentError(name, new, "a joint turns in one arm and slides in the other")
    differ = np.flatnonzero(new.effort_limit != arm.effort_limit)
    if differ.size:
        j = int(differ[0])
        remedy = (
            f"its effort limit of {arm.joint_names[j]} is {new.effort_limit[j]:g} and the plant's "
            f"{arm.effort_limit[j]:g}: a run has one; weaken the drive with actuator=... instead"
        )
        raise ArgumentError(name, new, remedy)
    differ = np.flatnonzero(np.isfinite(new.joint_stiffness) != np.isfinite(arm.joint_stiffness))
    if differ.size:
        joint = arm.joint_names[int(differ[0])]
        remedy = f"{joint} has a spring in one arm only; give springs to the same joints of both"
        raise ArgumentError(name, new, remedy)


def _words(before: Arm, after: Arm) -> str:
    """Return what of an arm changed, by the payloads that hang on it and by what `perturb` did."""
    masses = [sum(payload_masses(arm.tree).values()) for arm in (before, after)]
    found = []
    if masses[0] != masses[1]:
        found.append(f"payload {masses[1]:.4g} kg" if masses[1] else "no payload")
    old, new = _told(before), _told(after)
    found += [words for words in new if words not in old]
    still_told = {words.partition(" = ")[0] for words in new}
    found += [f"no longer {w}" for w in old if w.partition(" = ")[0] not in still_told]
    if not found:
        found = ["no change" if before.urdf == after.urdf else f"the arm becomes {after.name}"]
    return "; ".join(found)


def _told(arm: Arm) -> Sequence[str]:
    links = payload_masses(arm.tree)
    return [
        words
        for words in arm.changes
        if words.split(" ", 1)[0] not in links and not words.startswith("drawn from seed")
    ]

"""`LogTable`: the columns of a log by kind and joint, as a file holds them, and what it says."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.checks import did_you_mean
from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.log import COMPENSATED, TORQUES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


@dataclass(kw_only=True, eq=False)
class LogTable:
    """What a file holds, before an arm and the clock are looked at.

    Attributes:
        source: what to call it.
        t: time (N,) [s], in the order of the file.
        q: position of each joint by name (N,) [rad, m]; a continuous joint has its angle.
        v: velocity by name (N,) [rad/s, m/s]; may be empty.
        tau: torque by its kind, "measured" or "commanded", or "" where the file does not say, and
            by name (N,) [N·m, N].
        compensates: what the file says that the robot adds itself; None where it says nothing.
        others: names of further joints that the file has columns of.
        notes: what reading it found.
    """

    source: str
    t: Array
    q: dict[str, Array]
    v: dict[str, Array]
    tau: dict[str, dict[str, Array]]
    compensates: tuple[str, ...] | None = None
    others: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)

    def positions(self, arm: Arm) -> Array:
        """Return the joint positions (N, nv), continuous joints without jumps of a turn."""
        x = self._columns("position", self.q, arm.joint_names)
        turning = [j for j, joint in enumerate(list(arm.model.joints)[1:]) if joint.nq != joint.nv]
        x[:, turning] = np.unwrap(x[:, turning], axis=0)
        ignored = [name for name in self._names if name not in arm.joint_names]
        if ignored:
            self.notes.append(f"ignored joints that {arm.name} has not: {', '.join(ignored)}")
        return x

    def velocities(self, arm: Arm) -> Array | None:
        """Return the velocities (N, nv); None where no joint of the arm has one."""
        if not any(name in self.v for name in arm.joint_names):
            self.notes.append("no velocities: they are taken from the positions")
            return None
        return self._columns("velocity", self.v, arm.joint_names)

    def torques(self, arm: Arm, asked: str | None) -> tuple[str, Array]:
        """Return the kind of torque, "measured" or "commanded", and the torques (N, nv).

        Args:
            arm: the arm.
            asked: the kind that the user asks for; None where the log must say.

        Raises:
            LogError: joints without torque, kinds that are mixed, or a kind that nobody states.
        """
        names = arm.joint_names
        here = {
            kind: columns
            for kind, columns in self.tau.items()
            if any(name in columns for name in names)
        }
        if not here:
            raise LogError("torque", f"{self.source}: no torque for any joint of {arm.name}")
        if asked is None and list(here) == [""]:
            raise LogError(
                "torque",
                f"{self.source} does not say where its torque comes from: give torque='measured' "
                "(sensors, motor currents) or torque='commanded' (what the controller asked for)",
            )
        if asked is None and len(here) > 1:
            self._refuse_mixture(here, names)
        kind = asked or next(iter(here))
        if asked in here or "" not in here:
            columns = here.get(kind)
            if columns is None:
                raise LogError(
                    "torque",
                    f"{self.source} holds {' and '.join(here)} torque and no {asked} one; leave "
                    "torque out",
                )
        else:
            columns = here[""]
        return kind, self._columns(f"{kind} torque", columns, names)

    def kept(self, compensates: Sequence[str] | None) -> tuple[str, ...]:
        """Return what the torque leaves out, from the file or the user.

        Raises:
            LogError: nobody says it, or the two differ.
        """
        stated = self.compensates
        if compensates is None and stated is None:
            raise LogError(
                "torque",
                f"{self.source} does not say whether its torque is total: give compensates=() for "
                "the whole torque at the joints, compensates=('gravity',) where the robot adds the "
                "weight itself (libfranka's commanded torque, UR's direct torque), or ('gravity', "
                "'friction')",
            )
        if compensates is None:
            return stated or ()
        given = (compensates,) if isinstance(compensates, str) else tuple(compensates)
        for word in given:
            if word not in COMPENSATED:
                hint = did_you_mean(word, COMPENSATED)
                raise LogError(
                    "torque", f"compensates = {word!r}: {hint}choose of {', '.join(COMPENSATED)}"
                )
        if stated is not None and set(stated) != set(given):
            told = " and ".join(stated) or "nothing"
            raise LogError(
                "torque",
                f"{self.source} says that the robot compensates {told}, and compensates = {given} "
                "says otherwise: leave one out",
            )
        return given

    @property
    def _names(self) -> list[str]:
        return list(dict.fromkeys((*self.q, *self.others)))

    def _refuse_mixture(self, here: dict[str, dict[str, Array]], names: Sequence[str]) -> None:
        whole = [kind for kind, columns in here.items() if all(name in columns for name in names)]
        if whole and all(kind in TORQUES for kind in here):
            words = " and ".join(here)
            raise LogError(
                "torque",
                f"{self.source} holds {words} torque: say which to take, torque='{whole[0]}'",
            )
        parts = "; ".join(
            f"{kind or 'unstated'} of {', '.join(name for name in names if name in columns)}"
            for kind, columns in here.items()
        )
        raise LogError(
            "torque",
            f"{self.source} mixes kinds of torque ({parts}): a commanded torque is what the "
            "controller asked for, a measured one what acted, and their difference would be taken "
            "for dynamics; give one kind for all joints",
        )

    def _columns(self, what: str, columns: dict[str, Array], names: Sequence[str]) -> Array:
        missing = [name for name in names if name not in columns]
        if missing:
            hint = did_you_mean(missing[0], [name for name in self._names if name not in names])
            raise LogError(
                "columns",
                f"{self.source}: no {what} of {', '.join(missing)}; {hint}"
                f"its joints are {', '.join(self._names) or 'none'}",
            )
        return np.column_stack([columns[name] for name in names])

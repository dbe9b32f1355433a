"""`Clock`: when ticks of a loop are due, and how late they were."""

from __future__ import annotations

import time

SPIN = 2e-4
"""The wait for a tick ends in a busy wait, as a sleep may last this much too long [s]."""
TOO_FAST, WATCHED = 0.8, 50
"""A robot's clock is too fast where so many ticks took less than this share of their time."""


class Clock:
    """The time since the start of a loop, kept by the loop or by the robot.

    Kept by the loop, ticks are due at multiples of `dt`, so that delays do not add up; a tick that
    comes so late that others were due too replaces them. Kept by the robot, a tick is due when its
    `read` returns.

    Attributes:
        now: when the present tick began [s].
        period: time from the last tick to the present one [s].
        missed: ticks that ended after the next one was due.
    """

    def __init__(self, dt: float, *, paced: bool) -> None:
        self._dt, self._paced = dt, paced
        self.now = self.period = self._due = self._start = 0.0
        self.missed = 0

    def most_ticks(self, duration: float) -> int:
        """Return how many ticks there may be at most in so many seconds."""
        if self._paced:
            return int(duration / (TOO_FAST * self._dt)) + 2 * WATCHED
        return int(duration / self._dt) + 2

    def start(self) -> None:
        """Begin at 0 s."""
        self._start = time.perf_counter()

    def await_tick(self, *, keeps_time: bool) -> float:
        """Wait for the next tick where that is our affair; return the time [s].

        With `keeps_time` the loop waits also for a robot that should: its `read` failed.
        """
        if self._paced and not keeps_time:
            return time.perf_counter() - self._start
        while True:
            t = time.perf_counter() - self._start
            if t >= self._due:
                if not self._paced:
                    self._begin(t)
                return t
            if self._due - t > SPIN:
                time.sleep(self._due - t - SPIN)

    def note_read(self) -> float:
        """Return when the present tick began, as the robot was read just now [s]."""
        if self._paced:
            t = time.perf_counter() - self._start
            self.missed += t - self.now > 1.5 * self._dt and self.now > 0.0
            self._begin(t)
            self._due = t
        return self.now

    def is_too_fast(self, ticks: int) -> bool:
        """Return whether a robot's clock ticks faster than the controller was made for."""
        return self._paced and ticks >= WATCHED and self.now < TOO_FAST * self._dt * (ticks - 1)

    def latency(self) -> float:
        """Return the time since the tick was due [s]."""
        return time.perf_counter() - self._start - self._due

    def end_tick(self) -> None:
        """Find when the next tick is due."""
        if not self._paced:
            skipped = int(self.latency() / self._dt)
            self.missed += skipped > 0
            self._due += self._dt * (skipped + 1)
        else:
            self._due += self._dt

    def _begin(self, t: float) -> None:
        self.period, self.now = t - self.now, t

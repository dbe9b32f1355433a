"""Evaluation of control laws over many runs: hard scenarios, studies, and the tuning of gains."""

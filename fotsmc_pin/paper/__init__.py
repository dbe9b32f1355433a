"""The paper, reproduced: its case, its figures, and a verdict on each of its claims."""

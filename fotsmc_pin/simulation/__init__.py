"""The loop of plant, controller and reference, and the recording of what happened."""

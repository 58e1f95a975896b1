"""Runs: a case from its first step to its folder, and from a checkpoint on."""

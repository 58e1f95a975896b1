"""The case file: its models, units, loading and writing. Imports no room; no room imports it."""

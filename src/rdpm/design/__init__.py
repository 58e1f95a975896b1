"""Design of collision parameters: from what a user knows to stiffness, damping, contact steps, with reasons.

Pure functions in SI units; nothing here runs a simulation. See docs/theory/soft_sphere.md.
"""

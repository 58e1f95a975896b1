"""How fluid, bodies and contacts make one step together."""

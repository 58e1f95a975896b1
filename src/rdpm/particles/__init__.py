"""Bodies: their state, their surface markers, and how the fluid moves them."""

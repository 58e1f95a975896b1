"""Studies made of many runs: published cases, speed."""

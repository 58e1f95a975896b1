"""The page in the browser: design, cases, runs as they go, results; it reads and writes files, and keeps nothing else."""

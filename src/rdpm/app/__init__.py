"""The page in the browser: design, cases, runs, results. It reads and writes files, and keeps nothing else."""

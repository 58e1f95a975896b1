"""How the work is shared: threads within a process, and processes."""

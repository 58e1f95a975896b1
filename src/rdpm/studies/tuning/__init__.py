"""Time step and contact steps of a case, found by runs: convergence first, then the range of N_c."""

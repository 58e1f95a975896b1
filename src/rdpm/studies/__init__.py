"""What runs show: phases of a pair, sweeps of parameters."""

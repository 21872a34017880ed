"""Numbers from runs: steady velocity, period, motion type, energy. Nothing here draws or writes."""

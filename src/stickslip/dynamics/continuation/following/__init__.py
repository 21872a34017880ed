"""Following a branch: steps of pseudo-arclength, limit cycles, the end of a branch, and branches that leave another one."""

"""Special points of a branch: test functions, branch points, grazings, events of one's own, and how accurately they are known."""

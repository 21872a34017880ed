"""Which motions attract: basins, coexisting attractors along a parameter, bifurcation diagrams, maps of periods."""

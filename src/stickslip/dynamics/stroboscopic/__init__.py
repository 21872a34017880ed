"""The stroboscopic map: the state after a number of drive periods, sampled once per period.

What depends on whether bodies move or a flow is answered by the coordinates of the states: `Coordinates`, and `FlowCoordinates` of a flow.
Packages above ask them, and whether runs go in lanes of one kernel; what orbits and growth answer differently stands in
`periodic/kinds_of_orbits.py` and `derivatives/growth.py`.
"""

"""The stroboscopic map: the state after a number of drive periods, sampled once per period.

What depends on whether bodies move or a flow is answered by the coordinates of the states: `Coordinates`, and `FlowCoordinates` of a flow.
Functions of the packages above that go one way for each dispatch on them.
"""

"""The stroboscopic map: where a state at t = 0 is after some drive periods, and what is seen at those instants."""

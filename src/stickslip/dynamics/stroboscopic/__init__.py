"""The stroboscopic map: the state after a number of drive periods, sampled once per period."""

from stickslip.inverse.optimisation import *

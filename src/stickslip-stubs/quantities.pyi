from stickslip.basics.quantities import *

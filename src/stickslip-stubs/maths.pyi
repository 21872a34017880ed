from stickslip.basics.maths import *

from stickslip.basics.variables import *

from stickslip.inverse.identification import *

from stickslip.show.figures import *

from stickslip.show.paper import *

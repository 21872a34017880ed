from stickslip.models.machines import *

from stickslip.models.friction import *

from stickslip.models.drives import *

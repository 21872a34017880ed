from stickslip.models.tracks import *

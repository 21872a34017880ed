from stickslip.models.presets import *

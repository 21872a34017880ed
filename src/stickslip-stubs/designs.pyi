from stickslip.studies.designs import *

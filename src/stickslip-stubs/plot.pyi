from stickslip.show.figures import *
from stickslip.show.figures import __getattr__ as __getattr__

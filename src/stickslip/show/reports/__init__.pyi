from .atlas import atlas_page as atlas_page
from .html import page as page, svg_address as svg_address, write as write
from .optimum import optimum_page as optimum_page
from .run import run_page as run_page
from .study import study_page as study_page

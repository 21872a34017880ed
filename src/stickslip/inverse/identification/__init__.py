"""Models beside measured records: comparison, fits with their uncertainty, ranking of laws, design of the next experiment.

Four problems show what a record tells: steady curves of machines (`steady_problem`), mean velocities
(`mean_velocity_problem`), and forces over a prescribed motion (`force_problem`; of machines in `logs_of_machines`). A fourth simulates the
angles that follow a recorded command (`commanded_logs`).
`least_squares` makes one problem of each: the sensor's effects (`sensors`), residuals in standard deviations, and a row for
each number of which something is known beforehand. Search, profiles, bootstrap and ranking see that problem only. Covariances
(`covariance`) take correlated noise into account; `formulas` names the combinations that are determined where single numbers
are not.
"""

from stickslip.basics.lazy_names import listing
from stickslip.inverse.identification.comparing import Comparison, compare
from stickslip.inverse.identification.designing import Design, design
from stickslip.inverse.identification.fit import Fit
from stickslip.inverse.identification.identify import identify
from stickslip.inverse.identification.ranking import Ranking, prediction_errors, rank
from stickslip.inverse.identification.virtual_rig import virtual_rig

__all__ = ["Comparison", "Design", "Fit", "Ranking", "compare", "design", "identify", "prediction_errors", "rank", "virtual_rig"]
__dir__ = listing(__all__)

"""Coefficients of the Rosenbrock methods, as data with their source.

Transformed form (Hairer and Wanner 1996, section IV.7): with W = I/(h gamma) - J,

    W u_i = f(t + c_i h, y + sum_j a_ij u_j) + sum_j C_ij u_j / h + h d_i df/dt,    y_new = y + sum_i b_i u_i.

The last stage of each method is y_new = (last argument of f) + u_s, and u_s is the error estimate. `dense` gives the
continuous extension: y(theta) = (1 - theta) y + theta (y_new + (1 - theta) (k_0 + theta (k_1 + theta k_2))).
Their order conditions are verified in tests/engine/test_tableaux.py.
"""

from __future__ import annotations

from dataclasses import dataclass

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Control:
    """Constants of the step control, found by measuring cost against error over many robots (notes/decisions)."""

    velocity_floor: float = 8e-3  # error weight of v: rtol (floor A omega + |v|)
    inner_floor: float = 5.0  # error weight of z: rtol (floor scale + |z|)
    safety: float = 0.84
    exponent: float = 0.16
    growth: float = 2.67
    growth_rejected: float = 0.86
    growth_event: float = 2.0
    shrink: float = 0.1
    swing: float = 0.52  # change of v in a step near v = 0, in Stribeck velocities
    swing_rate: float = 0.8  # and for each unit of |v| beyond swing_from Stribeck velocities
    swing_from: float = 1.92
    longest: float = 0.15  # of a period
    watchful: float = 1 / 400  # the same where a law balances what is applied: nothing moves then that would keep steps short
    newton: int = 3  # iterations for an event inside the step


@dataclass(frozen=True)
class Tableau:
    """A stiffly accurate Rosenbrock method with an embedded estimate and dense output."""

    name: str
    order: int
    dense_order: int
    gamma: float
    a: Rows
    C: Rows
    c: tuple[float, ...]
    d: tuple[float, ...]
    dense: Rows
    source: str
    control: Control = Control()

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.c)


RODAS4 = Tableau(
    name="Rodas4",
    order=4,
    dense_order=3,
    gamma=0.25,
    a=(
        (),
        (1.544,),
        (0.9466785280815826, 0.2557011698983284),
        (3.314825187068521, 2.896124015972201, 0.9986419139977817),
        (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895),
        (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1.0),
    ),
    C=(
        (),
        (-5.6688,),
        (-2.430093356833875, -0.2063599157091915),
        (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
        (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.7089089320616),
        (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
    ),
    c=(0.0, 0.386, 0.21, 0.63, 1.0, 1.0),
    d=(0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0),
    dense=(
        (10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662, 0.0),
        (-0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872, 0.0),
    ),
    source="E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, section VI.4",
)

RODAS5P = Tableau(
    name="Rodas5P",
    order=5,
    dense_order=4,
    gamma=0.21193756319429014,
    a=(
        (),
        (3.0,),
        (2.849394379747939, 0.45842242204463923),
        (-6.954028509809101, 2.489845061869568, -10.358996098473584),
        (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
        (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946),
        (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0),
        (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0, 1.0),
    ),
    C=(
        (),
        (-14.155112264123755,),
        (-17.97296035885952, -2.859693295451294),
        (147.12150275711716, -1.41221402718213, 71.68940251302358),
        (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
        (24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471),
        (30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623, -28.087943162872662),
        (
            37.80277123390563,
            -3.2571969029072276,
            112.26918849496327,
            66.9347231244047,
            -40.06618937091002,
            -54.66780262877968,
            -9.48861652309627,
        ),
    ),
    c=(0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0),
    d=(0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0),
    dense=(
        (
            25.948786856663858,
            -2.5579724845846235,
            10.433815404888879,
            -2.3679251022685204,
            0.524948541321073,
            1.1241088310450404,
            0.4272876194431874,
            -0.17202221070155493,
        ),
        (
            -9.91568850695171,
            -0.9689944594115154,
            3.0438037242978453,
            -24.495224566215796,
            20.176138334709044,
            15.98066361424651,
            -6.789040303419874,
            -6.710236069923372,
        ),
        (
            11.419903575922262,
            2.8879645146136994,
            72.92137995996029,
            80.12511834622643,
            -52.072871366152654,
            -59.78993625266729,
            -0.15582684282751913,
            4.883087185713722,
        ),
    ),
    source="G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia "
    "Differential Equations package, BIT Numer. Math. 63 (2023) 27",
    control=Control(swing=0.45, swing_from=2.5, inner_floor=9.0),
)

#: By what ``method=`` may be.
TABLEAUX = {tableau.name.lower(): tableau for tableau in (RODAS4, RODAS5P)}

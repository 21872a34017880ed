"""Rows J and G of benchmarks/everyone: joints with gravity and blocks on belts, by a program of SciPy alone, and by formulas.

Prints each row with what the rows' file says and what this program finds; with --write it puts the rows into the file. Contacts slide
forwards, backwards or rest; every change is located on the dense output of DOP853, and what happens after it is decided by forces there.
Rows under LuGre's law are integrated by Radau between the zeros of the slip. None of this is code of the package.

    python verification/rows_for_everyone.py [--write]
"""

import argparse
import json
import math
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

FILE = Path(__file__).parents[1] / "benchmarks" / "everyone" / "rows.json"
FINE = {"rtol": 1e-13, "atol": 1e-15}
OWN = ("DOP853 from event to event, three modes for each contact (verification/rows_for_everyone.py)",)
STIFF = ("Radau between the zeros of the slip (verification/rows_for_everyone.py)", "stickslip, Rosenbrock steps at 1e-11")


# ---- rows ----
def coulomb(kinetic, static, surface=0.0):
    """Equal in both directions."""
    given = {"law": "coulomb", "plus": kinetic, "minus": kinetic, "static_plus": static, "static_minus": static}
    return given | ({"surface": surface} if surface else {})


def lugre(kinetic, static, sigma0, sigma1, sigma2, v_s):
    """The same under LuGre's law."""
    return coulomb(kinetic, static) | {"law": "lugre", "sigma0": sigma0, "sigma1": sigma1, "sigma2": sigma2, "v_s": v_s}


def body(mass, friction, constant=0.0, forces=(), **more):
    """One that starts at rest at 0 if nothing else is said."""
    return {"mass": mass, "forces": list(forces), "constant_force": constant, "friction": friction, **more}


def row(name, about, bodies, period, window, methods, springs=(), tolerance=1e-9, unit=1.0, source="derived for this project"):
    """Over the window from the start."""
    timing = {"period": period, "settle_periods": 0, "window_periods": window, "of_body": 0, "mean_velocity": None}
    said = {"velocity_unit": unit, "tolerance": tolerance, "methods": list(methods), "source": f"{source}, by the methods named"}
    return {
        "id": name,
        "about": about,
        "bodies": list(bodies),
        "springs": list(springs),
        "stops": [],
        **timing,
        "mean_velocity": None,
        **said,
    }


def rows():
    """Joints of a small servo (SI, angles in rad), then blocks on belts."""
    J, G, dry = 0.003, 0.21, coulomb(0.05, 0.06)
    push = {"amplitude": 0.18, "omega": 2 * math.pi, "phase": 0.3}
    bristle = lugre(0.05, 0.06, 40.0, 0.05, 0.005, 0.05)
    ground = {"between": [0, None], "stiffness": 1.0, "damping": 0.0}
    near = [{"between": [i, i + 1], "stiffness": 4.0, "damping": 0.0} for i in range(2)]
    own = [{"between": [i, None], "stiffness": 1.0, "damping": 0.0} for i in range(3)]
    belt = coulomb(1.0, 1.5, 0.1)
    riding = body(1.0, belt, velocity=0.1)
    three = [body(1.0, belt, position=x, velocity=0.1) for x in (0.0, 0.11, 0.3)]
    arm, high, later = {"gravity_torque": G}, {"gravity_torque": G, "position": 2.0}, "in the manner of Burridge and Knopoff 1967"
    soft, slow = push | {"amplitude": 0.035}, {"tolerance": 1e-8}
    return [
        row("J1", "arm let go at 2 rad: where it stops", [body(J, dry, **high)], 1.0, 10, ("energy of each swing", *OWN)),
        row("J2", "arm at .2 rad, which friction holds", [body(J, dry, **arm, position=0.2)], 1.0, 100, ("by hand", *OWN)),
        row("J3", "driven arm, a constant torque beside it", [body(J, dry, 0.03, [push], **arm)], 1.0, 3, OWN),
        row("J4", "arm let go at 2 rad, LuGre friction", [body(J, bristle, **high)], 1.0, 2, STIFF, **slow),
        row("J5", "arm that a torque of .3 N m turns on and on, LuGre", [body(J, bristle, 0.3, **arm)], 1.0, 5, STIFF, **slow),
        row("J6", "joint without gravity, torque below break-away", [body(J, dry, 0.02, [soft])], 1.0, 100, ("by hand", *OWN)),
        row("G1", "block on a belt, static friction above kinetic", [riding], 1.0, 31, ("closed form", *OWN), [ground]),
        row("G2", "three blocks on a belt, springs between them", three, 1.0, 17, OWN, [*own, *near], source=later),
    ]


# ---- the program ----
def pull(row, t, x, v):
    """Forces but friction."""
    total = []
    for q, b in zip(x, row["bodies"], strict=True):
        driven = sum(f["amplitude"] * math.sin(f["omega"] * t + f["phase"]) for f in b["forces"])
        total.append(b["constant_force"] + driven - b.get("gravity_torque", 0.0) * math.sin(q))
    for s in row["springs"]:
        i, j = s["between"]
        other, rate = (0.0, 0.0) if j is None else (x[j], v[j])
        force = s["stiffness"] * (x[i] - other) + s["damping"] * (v[i] - rate)
        total[i] -= force
        if j is not None:
            total[j] += force
    return total


def next_mode(force, friction, rested):
    """0 where static friction holds, or the kinetic one of a contact that slid until now; else the way in which it slides off."""
    hold = friction["static_plus" if force > 0 else "static_minus"]
    return 0 if abs(force) <= hold and rested is not None else int(math.copysign(1, force))


def coulomb_end(row):
    """Positions at the end, by events."""
    n, bodies = len(row["bodies"]), row["bodies"]
    belts = [b["friction"].get("surface", 0.0) for b in bodies]
    y = [b.get("position", 0.0) for b in bodies] + [b.get("velocity", 0.0) for b in bodies]
    t, end = 0.0, row["period"] * (row["settle_periods"] + row["window_periods"])

    def mode_at(i):
        slip = y[n + i] - belts[i]
        return int(math.copysign(1, slip)) if slip else next_mode(pull(row, t, y[:n], y[n:])[i], bodies[i]["friction"], True)

    modes = [mode_at(i) for i in range(n)]

    def rates(t, y):
        force = pull(row, t, y[:n], y[n:])
        slide = [f - m * b["friction"]["plus" if m > 0 else "minus"] for f, m, b in zip(force, modes, bodies, strict=True)]
        return [*y[n:], *(0.0 if m == 0 else s / b["mass"] for m, s, b in zip(modes, slide, bodies, strict=True))]

    def guard(i):
        if modes[i]:
            return lambda t, y: modes[i] * (y[n + i] - belts[i])
        return lambda t, y: min(f["static_plus"] - (own := pull(row, t, y[:n], y[n:])[i]), f["static_minus"] + own)

    while t < end:
        guards = []
        for i in range(n):
            f, own = bodies[i]["friction"], guard(i)
            own.terminal, own.direction = True, -1
            guards.append(own)
        done = solve_ivp(rates, (t, end), y, method="DOP853", events=guards, max_step=0.02, **FINE)
        t, y = float(done.t[-1]), [float(value) for value in done.y[:, -1]]
        for i, times in enumerate(done.t_events):
            if len(times):
                force = pull(row, t, y[:n], y[n:])[i]
                if modes[i]:
                    y[n + i] = belts[i]
                    modes[i] = next_mode(force, bodies[i]["friction"], True)
                else:
                    modes[i] = int(math.copysign(1, force))
                    y[n + i] = belts[i] + modes[i] * 1e-300
    return y[:n]


def lugre_end(row):
    """The position of one body at the end."""
    (b,) = row["bodies"]
    f = b["friction"]

    def rates(t, y, side):
        x, v, z = y
        g = f["plus"] + (f["static_plus"] - f["plus"]) * math.exp(-((v / f["v_s"]) ** 2))
        dz = v - f["sigma0"] * side * v * z / g
        R = f["sigma0"] * z + f["sigma1"] * dz + f["sigma2"] * v
        return [v, (pull(row, t, [x], [v])[0] - R) / b["mass"], dz]

    t, y, end = 0.0, [b.get("position", 0.0), b.get("velocity", 0.0), 0.0], row["period"] * row["window_periods"]
    side = math.copysign(1, pull(row, 0.0, y[:1], y[1:2])[0])
    while t < end:
        turn = lambda t, y, side: side * y[1]  # noqa: E731
        turn.terminal, turn.direction = True, -1
        done = solve_ivp(rates, (t, end), y, method="Radau", args=(side,), events=turn, rtol=1e-12, atol=1e-15)
        t, y, side = float(done.t[-1]), [*map(float, done.y[:, -1])], -side
    return [y[0]]


def value_of(row):
    """The mean velocity."""
    ends = (lugre_end if row["bodies"][0]["friction"]["law"] == "lugre" else coulomb_end)(row)
    return (ends[0] - row["bodies"][0].get("position", 0.0)) / (row["period"] * row["window_periods"])


# ---- formulas ----
def arm_by_energy(G, mu, static, start):
    """Where an arm that is let go stops: each swing loses mu times the way."""
    here, side = start, -1.0
    while abs(G * math.sin(here)) > static:
        lost = lambda there, here=here: G * (math.cos(there) - math.cos(here)) - mu * abs(there - here)  # noqa: E731
        low = here + side * 1e-6
        far = np.linspace(low, here + side * 2 * abs(here), 4001)
        k = next(k for k in range(1, len(far)) if lost(far[k]) < 0.0)
        here, side = brentq(lost, far[k - 1], far[k], xtol=1e-15), -side
    return here


def block_on_belt(time, speed=0.1, kinetic=1.0, static=1.5):
    """Position of a block of mass 1 on a spring of stiffness 1: it rides to x = static, then slides as a cosine about x = kinetic."""
    depth = static - kinetic
    size, phase = math.hypot(depth, speed), math.atan2(speed, depth)
    slide = math.pi + 2 * phase
    begin, t = 0.0, 0.0
    while True:
        ride = (static - begin) / speed
        if time <= t + ride:
            return begin + speed * (time - t)
        t += ride
        if time <= t + slide:
            return kinetic + size * math.cos(time - t - phase)
        t, begin = t + slide, kinetic - depth


FORMULAS = {
    "J1": lambda: (arm_by_energy(0.21, 0.05, 0.06, 2.0) - 2.0) / 10.0,
    "J2": lambda: 0.0,
    "J6": lambda: 0.0,
    "G1": lambda: block_on_belt(31.0) / 31.0,
}


def main():
    """Print or write."""
    given = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    given.add_argument("--write", action="store_true")
    write, file = given.parse_args().write, json.loads(FILE.read_text(encoding="utf-8"))
    kept = {each["id"]: each for each in file["rows"]}
    for each in rows():
        own = value_of(each)
        known = FORMULAS.get(each["id"], lambda own=own: own)()
        each["mean_velocity"] = known
        filed = kept.get(each["id"], {}).get("mean_velocity")
        print(f"{each['id']}: program {own:+.14g}, formula {known:+.14g}, file {filed}")
        if write:
            kept[each["id"]] = each
    if write:
        about, lines = json.dumps(file["about"], ensure_ascii=False), [json.dumps(each, ensure_ascii=False) for each in kept.values()]
        listed = ",\n  ".join(lines)
        FILE.write_text(f'{{\n "about": {about},\n "rows": [\n  {listed}\n ]\n}}\n', encoding="utf-8")


if __name__ == "__main__":
    main()

"""Every law, every drive and every track, with numbers that plain Python can follow; and a robot of any three."""

from __future__ import annotations

import stickslip as ss
from registries import examples

SOFT = {"sigma0": 2e4, "sigma1": 20.0}  # bristles that are soft enough for plain Python

DRIVES = {
    **examples(ss.drives.DRIVES),
    "twophase": ss.drives.TwoPhase(stroke=1e-3, u1=0.05, u2=0.2),
    "sawtooth": ss.drives.Sawtooth(stroke=1e-3, rise=0.02, fall=0.005),
    "threephase": ss.drives.ThreePhase(u1=0.1, w1=10.0, w2=60.0, w3=12.0),
}
TRACKS = {
    "level": ss.Level(),
    "downhill": ss.Incline(tilt=0.03),
    "uphill": ss.Incline(tilt=-0.03),
    "varying": ss.tracks.VaryingFriction(ss.Level(), depth=0.3),
}


def softened(law):
    return law.replace(**{name: value for name, value in SOFT.items() if hasattr(law, name)})


LAWS = {name: softened(law) for name, law in examples(ss.friction.LAWS).items()} | {
    "bristle": ss.friction.LAWS["bristle"].example().replace(sigma0=2e3),
    "ratestate": ss.friction.RateState.example().replace(a=0.06, b=0.08, Dc=2e-5),  # friction proportional to v up to 0.1 mm/s
    "sum": ss.friction.Sum.example(),
    "lugre + viscous": softened(ss.LuGre.example()) + ss.Viscous.example(),
}


def robot(law, drive, track="level"):
    return ss.Robot(body_mass=0.0626, inner_mass=0.0095, drive=DRIVES[drive], friction=LAWS[law], track=TRACKS[track])

"""An amplitude that an actuator has at one frequency is remarked on when it is kept at another."""

import numpy as np

import stickslip as ss

RIG = ss.presets.piezo_beam_rig(voltage=20.0, frequency=33.4, tilt_deg=1.7)
FOUND = "the amplitude was found for 33.4 Hz and is kept at another frequency"


def test_a_beams_amplitude_at_another_frequency_has_a_note():
    moved = RIG.replace({"drive.omega": "40 Hz"})
    assert not any(FOUND in note for note in RIG.notes) and FOUND in moved.notes[0]
    beam = ss.drives.PiezoBeam().drive(voltage=20.0, frequency=40.0)
    assert moved.drive.amplitude > 4 * beam.amplitude  # what the note warns of: 33.4 Hz is the resonance
    assert FOUND in moved.replace({"drive.omega": 250.0}).notes[0]  # it was found for 33.4 Hz, not for the 40 Hz in between
    assert FOUND in RIG.replace({"drive.omega": np.array([200.0, 250.0])}).notes[0]
    assert FOUND in ss.solve(moved, periods=3).notes[0]


def test_remarks_stay_with_what_they_are_about():
    assert RIG.drive.replace(phase=0.2).notes == RIG.drive.notes
    assert RIG.drive.replace(amplitude=5e-4).notes is None
    assert RIG.drive.replace(amplitude=5e-4, omega=250.0).notes is None
    assert RIG.drive.replace(omega=250.0, notes=("measured",)).notes == ("measured",)
    assert ss.Harmonic(amplitude=5e-4, omega=205.0).replace(omega=250.0).notes is None

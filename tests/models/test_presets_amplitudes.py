"""The amplitudes of the paper's rig are written once; pages and examples follow them."""

import re

import stickslip as ss
from house import PAGES, ROOT
from rows import each_row
from stickslip.basics.quantities import AMPLITUDE

PRESET = re.compile(r"tilt_deg=(1\.7|2\.7|4\.7|5\.7)[ ,]+amplitude=([0-9.]+e-[0-9]+)(?=[ ,)\n`])")
#: Amplitudes that the paper prints for figures of section 5, and others of our own examples.
ROUND = {round(1e-5 * n, 9) for n in range(1, 200)} | {1e-6}
TEXTS = [*PAGES, *ROOT.glob("src/**/*.py"), *ROOT.glob("src/**/*.txt"), *ROOT.glob("src/**/*.toml"), *ROOT.glob("examples/*.py")]


def test_every_amplitude_beside_a_tilt_of_the_paper_is_the_inferred_one_or_a_round_one():
    shown, other = 0, []
    for path in TEXTS:
        for tilt, amplitude in PRESET.findall(path.read_text(encoding="utf-8")):
            ours = float(amplitude) == ss.presets.PAPER_AMPLITUDES[float(tilt)]
            shown += ours
            if not ours and float(amplitude) not in ROUND:
                other.append(f"{path.relative_to(ROOT)}: {tilt} degrees, {amplitude} m")
    assert not other and shown > 40
    assert AMPLITUDE["example"] == ss.presets.PAPER_AMPLITUDES[1.7]


@each_row(
    ("tilt", "coulomb", "lugre", "kind"),
    [(1.7, 2.0, 1.8, "I"), (2.7, 3.8, 3.7, "III"), (4.7, 4.0, 3.7, "II"), (5.7, 28.7, 28.1, "IV")],
)
def test_at_the_papers_amplitudes_all_printed_velocities_and_types_come_out(tilt, coulomb, lugre, kind):
    """Section 4, to the last printed digit, with break-away at f0."""
    found = {law: ss.presets.piezo_rig(tilt, ss.presets.PAPER_AMPLITUDES[tilt], law=law) for law in ("coulomb-static", "lugre")}
    assert round(1e3 * float(ss.analysis.periodic_mean_velocity(found["coulomb-static"])), 1) == coulomb
    assert round(1e3 * float(ss.analysis.periodic_mean_velocity(found["lugre"])), 1) == lugre
    assert ss.motion(ss.solve(found["coulomb-static"])).type == kind == ss.motion(ss.solve(found["lugre"])).twin

"""The bench figure of every law, and all laws side by side. Run: python examples/bench_laws.py [law ...]"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import stickslip as ss

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "images" / "laws"
#: The sum that the page on sums shows.
LAWS = {**{name: law.example() for name, law in ss.friction.LAWS.items()}, "sum": ss.friction.Sum.example()}


def draw(found: ss.analysis.Bench | ss.analysis.Benches, name: str) -> None:
    """Write one figure as a PNG of few colours, which is small."""
    path = FOLDER / f"{name}.png"
    figure = ss.plot.bench(found)
    figure.savefig(path, dpi=110, pil_kwargs={"optimize": True})
    plt.close(figure)
    print(path)


def main(names: list[str]) -> None:
    """Measure and draw the laws that are named; of all of them the overview too."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    found = {}
    for name in names or LAWS:
        found[name] = ss.bench(LAWS[name])
        draw(found[name], name)
    if not names:
        draw(ss.analysis.Benches(tuple(bench for name, bench in found.items() if name != "sum")), "all")


if __name__ == "__main__":
    main(sys.argv[1:])

"""Sweeps of flows go by the lines of machines: folders that resume and refuse another flow, starts as axes, one tile after the other."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import stickslip as ss

NUMBERS = {"mu": 1.0, "gap": 1.2, "r": 0.6}


def swing(damped):
    field = lambda t, y, n: (y[1], damped * n.mu * (1 - y[0] ** 2) * y[1] - y[0])  # noqa: E731
    hit = ss.Switch(lambda t, y, n: n.gap - y[0], 0, lambda t, y, n: (n.gap, -n.r * y[1]))
    return ss.SwitchingFlow({0: field}, {0: (hit,)}, None, NUMBERS, ("x", "v"))


def test_a_folder_of_a_flow_is_resumed_to_the_bit_and_refuses_another(tmp_path):
    axes, how = {"mu": [0.9, 1.0, np.nan], "start.x": [0.1, 0.5]}, {"duration": 60.0, "settle": 30.0}
    watched = {"events": {"turns": lambda t, y, n: y[1]}}
    plain = ss.sweep(swing(1.0), **axes, **how, **watched)
    for i in (1, 2):
        ss.sweep(swing(1.0), **axes, **how, **watched, out=tmp_path / str(i), shard=(i, 2), tile=2)
    whole = ss.merge([tmp_path / "1", tmp_path / "2"], tmp_path / "whole")
    again = ss.sweep(swing(1.0), **axes, **how, **watched, out=tmp_path / "whole", resume=True, tile=2)
    assert list(again.data_vars) == list(plain.data_vars) == list(whole.data_vars)
    for name in plain.data_vars:
        assert np.array_equal(again[name].values, plain[name].values, equal_nan=plain[name].dtype.kind == "f"), name
    assert set(plain.motion_type.values[:2].ravel()) == {"periodic"} and (plain.end_mode.values[2] == -1).all()
    assert plain.max_x.dims == ("mu", "start.x") and plain.number_turns.values[0, 0] > 10
    with pytest.raises(ss.InputError, match="is the folder of another study: the robot has other numbers or another kind: the equations"):
        ss.sweep(swing(1.1), **axes, **how, **watched, out=tmp_path / "whole", resume=True, tile=2)


def test_a_flow_without_names_begins_at_a_list():
    fall = ss.SwitchingFlow(lambda t, y, n: (y[1], -n.g), numbers={"g": 10.0})
    grid = ss.sweep(fall, g=[5.0, 10.0], start=[1.0, 0.0], duration=1.0)
    assert grid.end_y0.values == pytest.approx([-1.5, -4.0], rel=1e-14) and grid.end_y1.values == pytest.approx([-5.0, -10.0], rel=1e-14)
    named = ss.sweep(fall, g=[5.0, 10.0], start={"y0": 1.0, "y1": 0.0}, duration=1.0)  # by the names of its columns
    run = ss.solve(fall.replace(g=5.0), start={"y0": 1.0, "y1": 0.0}, duration=1.0)
    assert named.end_y0.values.tolist() == grid.end_y0.values.tolist() and float(run.at(1.0)["y0"]) == named.end_y0.values[0]
    with pytest.raises(ss.InputError, match=r"start = 'top'; allowed is a dict, or a list of one number for each state"):
        ss.sweep(fall, g=[5.0, 10.0], start="top", duration=1.0)
    with ThreadPoolExecutor(2) as pool:
        again = ss.sweep(fall, g=[5.0, 10.0], start=[1.0, 0.0], duration=1.0, executor=pool)
    assert again.end_y1.values.tolist() == grid.end_y1.values.tolist()

"""Ctrl-C at several instants of long calls: a part that says so, no thread left, and the next call right."""

import functools
import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from tests import interrupted_calls

import stickslip as ss
from rows import each_row
from stickslip.basics import interruption
from stickslip.basics.errors import StickslipError
from stickslip.basics.interruption import PROGRESS, held_together, interruptible, look, partial_result, stop_call

HARNESS = Path(interrupted_calls.__file__)
QUICK = ("solve, batch", "sweep, in memory", "lyapunov", "optimise")
ALL = tuple(interrupted_calls.names())
RIG = ss.presets.piezo_rig


def lines_of(name, *shares):
    """What the harness says of a call that is interrupted at these shares of its time."""
    run = subprocess.run(
        [sys.executable, str(HARNESS), name, *map(str, shares)], capture_output=True, text=True, cwd=HARNESS.parent.parent, timeout=900
    )
    assert run.returncode == 0, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


def judged(name, *shares):
    """The claims of every interrupted call."""
    first, *met, last = lines_of(name, *shares)
    assert first["call"] == name and len(met) == len(shares)
    for each in met:
        assert each["threads"] == [] and each["next"] == "0.002014682"
        assert each["ended"] in (("part", "complete", "KeyboardInterrupt") if first["parts"] else ("complete", "KeyboardInterrupt"))
    assert last["again"]
    return met


@pytest.mark.parametrize("name", QUICK)
def test_an_interrupted_call_gives_what_is_finished_and_leaves_nothing_behind(name):
    assert any(each["ended"] == "part" and each["told"] for each in judged(name, 0.1, 0.4))


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_every_long_call_can_be_interrupted_at_five_instants(name):
    judged(name, 0.1, 0.3, 0.5, 0.7, 0.9)


# ---- the rule ----
@pytest.fixture(autouse=True)
def first_press(monkeypatch):
    """No test presses for the third time at once, and SIGINT is not ignored, as it is in what a shell runs in the background."""
    monkeypatch.setattr(interruption, "_pressed_at", (-np.inf, -np.inf))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt_when(works, after=0.05):
    """The result of a call that SIGINT meets."""
    timer = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        return works()
    finally:
        timer.join()


@interruptible
def counted(most):
    done = 0
    with partial_result() as ending:
        while done < most:
            look()
            time.sleep(0.01)
            done += 1
    return done, ending.note(f"{done} of {most}")


def test_ctrl_c_ends_the_outermost_call_and_its_handler_is_pythons_own_again():
    done, note = interrupt_when(lambda: counted(500))
    assert 0 < done < 500 and note == f"interrupted: {done} of 500"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_inner_call_has_no_partial_result_that_could_be_taken_for_a_complete_one():
    inner = []

    @interruptible
    def outer():
        with partial_result() as ending:
            inner.append(counted(500))
        return ending.words

    assert interrupt_when(outer) == "interrupted" and not inner


def test_what_is_done_with_a_complete_result_is_not_interrupted():
    @interruptible
    def complete():
        with partial_result() as ending:
            pass
        for _ in range(20):
            look()
            time.sleep(0.01)
        return ending.interrupted

    assert interrupt_when(complete) is False


def test_where_nothing_is_finished_keyboard_interrupt_goes_on():
    @interruptible
    def found():
        with partial_result() as ending:
            while True:
                look()
                time.sleep(0.01)
        ending.needs(None)

    with pytest.raises(KeyboardInterrupt, match="found was interrupted"):
        interrupt_when(found)


def test_progress_that_says_stop_before_there_is_a_result_is_an_error_and_no_ctrl_c():
    @interruptible
    def found():
        stop_call(PROGRESS)
        look()

    with pytest.raises(StickslipError, match="found: progress returned False before there was a result"):
        found()


def test_a_second_ctrl_c_ends_what_does_not_look():
    @interruptible
    def asleep():
        with partial_result():
            time.sleep(60)

    def twice():
        for _ in range(2):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)

    presses = threading.Timer(0.05, twice)
    presses.start()
    with pytest.raises(KeyboardInterrupt):
        asleep()
    presses.join()


def test_what_is_held_together_is_done_before_ctrl_c_is_raised():
    done = []

    def compiled():
        with held_together():
            time.sleep(0.2)
            done.append(True)

    with pytest.raises(KeyboardInterrupt):
        interrupt_when(compiled)
    assert done == [True]


def test_a_handler_of_the_users_own_stays_in_place():
    pressed = []
    before = signal.signal(signal.SIGINT, lambda *signal: pressed.append(True))
    try:
        assert interrupt_when(lambda: counted(20)) == (20, "") and pressed == [True]
    finally:
        signal.signal(signal.SIGINT, before)


# ---- runs ----
def part_of_a_run(**more):
    return ss.solve(RIG(tilt_deg=1.7, amplitude=5.525e-4, **more), periods=200_000, samples=4, progress=lambda done, most: done < 60)


@pytest.mark.parametrize("law", ["coulomb", "lugre"])
def test_an_interrupted_run_says_when_and_is_the_beginning_of_the_whole_run(law):
    part = part_of_a_run(law=law)
    assert part.interrupted and part.status.startswith("interrupted at t = ") and part.notes[0].startswith("the run was interrupted at")
    whole = ss.solve(RIG(tilt_deg=1.7, amplitude=5.525e-4, law=law), periods=60, samples=4)
    assert np.array_equal(part.strobe_v[:60], whole.strobe_v[:60])


@each_row("analysis", [ss.mean_velocity, ss.motion, ss.energy, ss.dynamics.strobe, ss.analysis.step_per_cycle])
def test_an_analysis_refuses_a_run_that_was_interrupted_and_takes_it_shortened(analysis):
    part = part_of_a_run(law="coulomb")
    with pytest.raises(ss.InputError, match=r"the run was interrupted at t = .* type run\.shortened\(\)"):
        analysis(part)
    analysis(part.shortened())


def test_a_shortened_run_has_the_mean_velocity_of_a_run_of_its_length():
    short = part_of_a_run(law="coulomb").shortened()
    whole = ss.solve(RIG(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=short.periods, samples=4)
    assert short.settle == short.periods // 2 and ss.mean_velocity(short) == pytest.approx(ss.mean_velocity(whole), rel=1e-13)


def test_progress_is_called_at_the_end_of_one_run_too():
    for law in ("coulomb", "lugre"):
        said = []
        ss.solve(RIG(tilt_deg=1.7, amplitude=5.525e-4, law=law), periods=40, progress=lambda *state: said.append(state))  # noqa: B023
        assert said[-1] == (40, 40)


# ---- imports and the compiler ----
def in_a_process(text, **more):
    command = [sys.executable, "-c", textwrap.dedent(text)]
    return subprocess.run(command, capture_output=True, text=True, timeout=600, env={**os.environ, **more})


@pytest.mark.parametrize("after", [0.02, 0.1, 0.2])
def test_an_interrupted_first_import_does_not_poison_the_process(after):
    run = in_a_process(
        f"""
        import os, signal, threading
        import stickslip as ss
        pressed = threading.Timer({after}, os.kill, (os.getpid(), signal.SIGINT))
        pressed.start()
        robot = dict(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
        try:
            ss.solve(ss.presets.piezo_rig(**robot), periods=20)
            pressed.join()
        except KeyboardInterrupt:
            pass
        print(round(ss.mean_velocity(ss.solve(ss.presets.piezo_rig(**robot), periods=20)), 9))
        """
    )
    assert run.stdout.split() == ["0.002014682"], run.stderr


@pytest.mark.slow
@pytest.mark.parametrize("after", [1.0, 2.0, 4.0])
def test_an_interrupt_while_a_kernel_is_compiled_is_not_taken_for_a_damaged_cache(after, tmp_path):
    run = in_a_process(
        f"""
        import os, signal, threading
        import stickslip as ss
        threading.Timer({after}, os.kill, (os.getpid(), signal.SIGINT)).start()
        try:
            ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4), periods=20)
        except KeyboardInterrupt:
            pass
        print(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4), periods=20).status)
        """,
        STICKSLIP_CACHE_DIR=str(tmp_path),
    )
    assert run.stdout.split() == ["finished"] and "cannot be read" not in run.stderr, run.stderr


# ---- the command line ----
def interrupted_command(words, ready, **more):
    """Exit status, stdout and stderr of a command that gets SIGINT once it is at work."""
    run = subprocess.Popen([sys.executable, "-m", "stickslip", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)
    while not ready() and run.poll() is None:
        time.sleep(0.05)
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=300)
    return run.returncode, out, err


def test_an_interrupted_sweep_on_the_command_line_exits_with_130_and_goes_on_later(tmp_path):
    words = ["piezo_rig", "tilt_deg=1.7", "law=coulomb", "amplitude=3e-4..8e-4:40", "omega=120..260:40", "method=rk4", "periods=20"]
    study = tmp_path / "study"
    tiles = lambda: len([*study.glob("tiles/*.nc")]) > 1  # noqa: E731
    code, _, err = interrupted_command(["sweep", *words, "--out", str(study), "--tile", "4"], tiles)
    assert code == interruption_code() and f"type stickslip resume {study} to go on" in err and "sweep was interrupted" in err
    grid = ss.open_study(study)
    assert 0 < int((grid.status <= 1).sum()) < grid.status.size


def test_a_run_on_the_command_line_that_was_complete_at_ctrl_c_keeps_its_file_and_is_not_looked_into(tmp_path, monkeypatch, capsys):
    from stickslip import solvers
    from stickslip.show.cli import main

    really = solvers.solve

    @interruptible
    @functools.wraps(really)
    def pressed(*args, **more):
        run = really(*args, **more)
        interruption._listening.set(interruption.CTRL_C)
        return run

    monkeypatch.setattr(solvers, "solve", pressed)
    path = tmp_path / "run.nc"
    words = ["run", "piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=coulomb", "periods=5", "--data", str(path)]
    assert main(words) == interruption_code()
    out, err = capsys.readouterr()
    assert not out and "was not looked for" in err and ss.load(path).periods == 5


def interruption_code():
    from stickslip.show.cli import INTERRUPTED

    return INTERRUPTED


def test_the_explorer_ends_with_status_0(tmp_path):
    said = tmp_path / "said"
    with said.open("w") as file:
        run = subprocess.Popen(
            [sys.executable, "-m", "stickslip", "explore", "--port", "0", "--no-browser"], stdout=file, stderr=subprocess.PIPE, text=True
        )
    while not said.read_text() and run.poll() is None:
        time.sleep(0.1)
    run.send_signal(signal.SIGINT)
    _, err = run.communicate(timeout=120)
    assert run.returncode == 0, err


def test_names_of_interrupted_calls_are_kept_for_the_command_line():
    before = len(interruption.ended_early)
    interrupt_when(lambda: counted(500))
    assert interruption.ended_early[before:] == ["counted"]

"""A Panel page with what the explorer's benchmark drags: a slider for the amplitude, and two curves."""

import sys

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

import stickslip as ss


def curve(law, amplitude):
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, law=law), periods=40, rtol=1e-4)
    end = run.strobe_times[-1]
    at = run.at(np.clip(np.linspace(end - 3 * run.period_time, end, 769), 0, end))
    return {"t": 1e3 * (at["t"] - at["t"][0]), "v": 1e3 * at["v"]}


def page():
    slider = pn.widgets.FloatSlider(name="amplitude", start=0.0, end=1.6e-3, step=1e-7, value=5.56e-4)
    plot = figure(width=800, height=300)
    sources = {law: ColumnDataSource(curve(law, slider.value)) for law in ("lugre", "coulomb-static")}
    for (law, source), colour in zip(sources.items(), ("#0072B2", "#D55E00"), strict=True):
        plot.line("t", "v", source=source, color=colour, legend_label=law)

    def change(event):
        for law, source in sources.items():
            source.data = curve(law, event.new)

    slider.param.watch(change, "value")
    return pn.Column(slider, pn.pane.Bokeh(plot))


pn.serve(page, port=int(sys.argv[1]), show=False)

"""A Dash page with what the explorer's benchmark drags: a slider for the amplitude, and two curves."""

import sys

import numpy as np
import plotly.graph_objects as go
from dash import Dash, Input, Output, dcc, html

import stickslip as ss


def curve(law, amplitude, colour):
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, law=law), periods=40, rtol=1e-4)
    end = run.strobe_times[-1]
    at = run.at(np.clip(np.linspace(end - 3 * run.period_time, end, 769), 0, end))
    return go.Scatter(x=1e3 * (at["t"] - at["t"][0]), y=1e3 * at["v"], name=law, line={"color": colour})


app = Dash(__name__)
app.layout = html.Div([dcc.Slider(0.0, 1.6e-3, value=5.56e-4, id="amplitude", updatemode="drag", marks=None), dcc.Graph(id="velocity")])


@app.callback(Output("velocity", "figure"), Input("amplitude", "value"))
def draw(amplitude):
    return go.Figure([curve("lugre", amplitude, "#0072B2"), curve("coulomb-static", amplitude, "#D55E00")])


app.run(port=int(sys.argv[1]), debug=False)

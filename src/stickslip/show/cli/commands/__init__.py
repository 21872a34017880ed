"""The commands: each is a file of the same name, with `-` for `_`, which declares its arguments, help and example beside its function.

Nothing is listed elsewhere: help, completion, docs and tests find a command by its file. The first line of the file's docstring is
its line in the list of commands.
"""

#: The order of the list; other commands follow, by name.
FIRST = (
    "run", "check", "sweep", "bench", "export-law", "export-fmu", "map", "resume", "merge", "export", "bifurcation", "atlas", "basins", "lyapunov",
    "report", "init", "read", "fit", "compare", "optimise", "identify", "paper", "explore", "presets", "laws", "drives", "mechanisms", "doctor",
    "warmup", "completion",
)  # fmt: skip

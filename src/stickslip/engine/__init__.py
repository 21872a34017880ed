"""Trace equations, write kernels, compile them, and keep them in the user's cache folder: the only package that knows a compiler.

- `trace` calls the mechanics with symbols (`symbolic`, `graph`) and makes a `system.System`: states with rates, contacts
  (`contacts`, `coupled`, `flight`, `pressed`), guards with what they switch or reset, modes, known instants. `flow_system`
  makes one of a hand-written flow. `refused` says which machines the compiled methods do not take, and why. Whether positions
  count only as differences, whether arcs are closed and what a series needs is asked of the graph.
- Transforms make a new system of one: `tangent` (derivatives along directions of starts and numbers, with their jumps at
  switches), volumes, observables.
- Methods: closed arcs (`closed_arc_conditions`), Taylor series (`rows`, `taylor`, `long_series`, `linear_systems`, `slaved`,
  `slaved_pieces`, `slaving`, `unforeseen`), Rosenbrock steps (`tableaux`), fixed steps.
- Rows of many bodies (`force_tables`, `local_events`): forces that differ in numbers alone are rows of a table, and a kernel that knows
  clusters of moving bodies goes from event to event. Their text does not grow with the number of bodies.
- A kernel's file has what depends on the law; `driver` and `kernels/` are the same for all laws and call the law's functions at
  their addresses. `functions` (`function_body`) writes the driver as one piece of LLVM, `emit` a step's lines, both with `expressions`, and
  `shared_arrays` has the layout of their arrays.
- `traced_law`, `law_steps`, `portable`: a law alone, over a prescribed motion, or as lines of C or MATLAB; `latex`: equations
  as derived.
"""

"""Friction laws, drives, tracks and machines, and the equations of motion that they declare.

A machine is asked in one place for its equations: `mechanics.Mechanics` has what moves (coordinates with masses), what rubs
(contacts with a row g and an offset b each, so that a slip is w = g u + b(t)), accelerations under given friction forces,
loads, jumps and stops, all as functions of plain numbers. `OneBody` reads it off a robot or a mechanism, `SeveralBodies` off
the parts that a `machines.Machine` lists. Floats go in for the judge, arrays for columns of forces, symbols for the engine. A
law of a user's own needs two methods and may leave out the rest: `friction.law_adapter` asks any law in one way, and so do
`drives.drive_adapter` and `machine_adapter`. Where an adapter has a default, nobody else writes `hasattr`.

A `switching_flow.SwitchingFlow` is that declaration written by hand. `controllers` are parts with states of their own. A mirror
image is made of parts, never of equations: `mirroring` turns the fields of a record, `machines.mirrored` what a machine lists. `naming` and
`nondimensional` are about the numbers of a model.
"""

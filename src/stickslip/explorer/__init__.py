"""The explorer: a page on this machine on which a robot's numbers are dragged and its motion is seen at once.

`sliders` lists what can be dragged, `models` makes robots of it, `requests` checks what a page asks for, `effort` refuses what would
take too long, `responses` computes the rest and `frames` packs it; `kernels` compiles beside the server, `sessions` shares the machine
among the pages, `dropped_records` reads records, `exports` and `code` are what can be taken home, `guard` decides who may ask, and
`server` puts it together. The page itself is in ``assets``: one HTML file, one style sheet, small modules, and uPlot.
"""

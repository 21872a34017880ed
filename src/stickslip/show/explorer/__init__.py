"""The explorer: a local page with sliders for a robot's numbers, which shows its motion immediately.

`sliders` lists the numbers, `models` makes robots from them, `requests` checks the requests of a page, `effort` refuses runs that would
take too long, `responses` computes the answers and `frames` packs them; `first_picture` has the answer that the page shows when it
opens; `kernels` compiles in a separate process, `sessions` serves the pages, `dropped_records` reads records, `exports` and `code` make
the downloads, `guard` checks access, and `server` combines these parts. The page itself is in ``assets``: one HTML file, one style
sheet, small modules, and uPlot.
"""

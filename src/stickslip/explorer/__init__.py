"""The explorer: a page on this machine on which a robot's numbers are dragged and its motion is seen at once.

`parameters` lists what can be dragged, `models` makes robots of it, `asked` checks what a page asks for, `answers` computes it, `sessions`
shares the machine among the pages, `guard` decides who may ask, and `server` puts it together. The page itself is in ``assets``.
"""

"""Random machines, one file for each kind: what is drawn for a kind of equations (choices), and for each case of it (numbers)."""

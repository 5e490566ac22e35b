"""Code of one paper each, in the form that any study's folder may have (`machine.modules`):
`metrics.py`, `functions.py` and `audit.py`; and folders of kinds of workspace (`worlds`) and of
panel (`panels`).
"""

"""The commands of `python -m bezierplan`, one file each."""

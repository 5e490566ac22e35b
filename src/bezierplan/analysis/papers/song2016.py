"""song2016: its drawings and its audit, which stand in its files."""

from bezierplan.analysis.papers.drawings import marks as marks
from bezierplan.analysis.papers.rules import audit as audit

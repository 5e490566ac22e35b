"""What only one paper needs: claims that no kind of test fits, and audits of its own numbers. One file a study, named like it.

A file may have functions that claims name (`test: function`), each taking the check, the results by experiment and the published numbers by
file, and returning a mark (+, -, 0 or ?), the effect, its 95 % interval or None, and the number of units; and `audit(published)`, which
returns rows as `analysis.audit` describes.
"""

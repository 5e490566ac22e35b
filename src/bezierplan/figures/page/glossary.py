"""What the words of verdicts mean, as the page says it where they stand."""

WORDS = {
    "agrees": "The published number lies in our 95 % prediction interval for an experiment of the "
    "paper's size, and the interval is narrow enough to exclude most of the values that the paper "
    "prints for competing methods. It need not be near ours: ≈ marks numbers within 10 % of ours.",
    "identified": "The published number is, to the last digit or to the decimals of a rounded "
    "root, the length of a path that an enumeration finds.",
    "disagrees": "The published number lies outside our 95 % prediction interval for an "
    "experiment of the paper's size. It can still be near ours (≈).",
    "inconclusive": "The published number lies in the interval, but so would most others: the "
    "interval is too wide, or has no end on that side. Or the paper does not define the quantity.",
    "supported": "The claim holds: every comparison does (p < 0.05, and a difference that "
    "matters), or one of them if the claim needs only one; the count then says: one suffices.",
    "partly": "Some comparisons of the claim hold, k of n, also when corrected for their number.",
    "contradicted": "The claim fails: no comparison holds when corrected for their number, and in "
    "at least one the opposite does. A claim that needs all together, such as that one method is "
    "the best of eight, fails with one of them; the count then says: all are needed together.",
    "no effect": "The claim fails: the differences that it needs are too small to matter.",
    "depends": "On a reading that no sentence excludes, or on the chance of one experiment.",
    "undecided": "Too few runs, or too wide an interval, to tell.",
    "untestable": "The paper does not say enough to test the claim.",
}

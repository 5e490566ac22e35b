"""Genetic operators on chromosomes of integer genes, each gene a number of `bits` bits, most
significant bit first.

A chromosome (genes,) is one bit string in the order of its genes. Functions that change a
chromosome say so; no function keeps state.
"""

import numpy as np

from bezierplan.geometry import curves
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.sorting import find_first_above

# Maximum number of draws of a bit until the flipped gene is an allele; after that, the gene stays
# as it is.
_FLIP_TRIES = 50


def check_pairs(settings: dict) -> None:
    """Raise ValueError, naming the setting, for a population that cannot be crossed in pairs."""
    if settings["population"] % 2:
        raise ValueError(
            f"population: {settings['population']}; parents are crossed in pairs, so an even "
            "number is needed"
        )


def check_curve(settings: dict, points: str) -> None:
    """Check that a kind of curve has enough free control points and samples.

    points: name of the setting that is the number of free control points.

    Raises ValueError, naming the setting and what is expected.
    """
    curve, samples = settings["curve"], settings["samples"]
    least = curves.least_points(curve) - 2
    if settings[points] < least:
        raise ValueError(
            f"{points}: {settings[points]}; a curve of kind {curve} needs at least {least}"
        )
    pieces = len(curves.piece_matrix(curve, settings[points] + 2))
    if samples < pieces + 1:
        raise ValueError(
            f"samples: {samples}; the {pieces} pieces of this curve need at least {pieces + 1}"
        )


@allocation_free
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """Copy a one-dimensional array, which compiles much faster than numpy's slice assignment."""
    for k in range(len(source)):
        target[k] = source[k]


@compile_kernel
def draw_parents(rng: np.random.Generator, fitness: np.ndarray, draws: int) -> np.ndarray:
    """Draw the indices (draws,) of parents with replacement, in proportion to fitness (n,), all
    above 0 (song2016, eq. 10).
    """
    wheel = np.cumsum(fitness)
    parents = np.empty(draws, np.int64)
    for draw in range(draws):
        # A draw close to 1 can round up to the whole wheel.
        parents[draw] = min(find_first_above(wheel, rng.random() * wheel[-1]), len(fitness) - 1)
    return parents


@allocation_free
def swap_tails(first: np.ndarray, second: np.ndarray, cut: int, bits: int) -> None:
    """Exchange, in place, the bits after the first `cut` bits of two chromosomes (song2016, Section
    III-E: single-point crossover).
    """
    gene = cut // bits
    behind = (1 << (bits - cut % bits)) - 1
    # The gene that the cut divides: bits behind it change over where the two differ.
    difference = (first[gene] ^ second[gene]) & behind
    first[gene] ^= difference
    second[gene] ^= difference
    for later in range(gene + 1, len(first)):
        first[later], second[later] = second[later], first[later]


@compile_kernel
def breed(
    rng: np.random.Generator,
    parents: np.ndarray,
    cost: np.ndarray,
    children: np.ndarray,
    margin: int,
    probability: float,
    unit: int,
    bits: int,
) -> np.ndarray:
    """Write as many children as there are parents (n, genes + 2 margin), and return the indices
    (n,) of the parents drawn.

    Children are copies of parents drawn by the reciprocal of their cost (n,); pairs of them
    exchange their tails with a probability.

    margin: number of fixed genes at both ends.
    unit: number of bits whose multiples are cut.
    """
    drawn = draw_parents(rng, 1.0 / cost, len(cost))
    for i in range(len(drawn)):
        copy(parents[drawn[i]], children[i])
    inner = children[:, margin : children.shape[1] - margin]
    cuts = bits * inner.shape[1] // unit
    for i in range(0, len(drawn), 2):
        # The number is drawn even where no cut is possible, so the other draws do not depend on it.
        if rng.random() < probability and cuts > 1:
            swap_tails(inner[i], inner[i + 1], unit * draw_integer(rng, 1, cuts), bits)
    return drawn


@allocation_free
def is_same(one: np.ndarray, other: np.ndarray) -> bool:
    """Tell whether two chromosomes, or lists of genes, are equal."""
    if len(one) != len(other):
        return False
    for k in range(len(one)):
        if one[k] != other[k]:
            return False
    return True


@allocation_free
def complement_bit(chromosome: np.ndarray, position: int, bits: int) -> None:
    """Complement, in place, one bit of a chromosome (song2016, Section III-E: mutation).

    position: counted from its beginning.
    """
    chromosome[position // bits] ^= 1 << (bits - 1 - position % bits)


@allocation_free
def flip_bit(
    rng: np.random.Generator, chromosome: np.ndarray, gene: int, bits: int, legal: np.ndarray
) -> None:
    """Complement, in place, a random bit of a gene; a bit that makes it no allele is redrawn.

    legal: bool (2**bits,), whether a number is an allele.
    """
    before = chromosome[gene]
    for _ in range(_FLIP_TRIES):
        complement_bit(chromosome, gene * bits + draw_integer(rng, 0, bits), bits)
        if legal[chromosome[gene]]:
            return
        # Draw again from the old gene: of a gene changed twice two bits could differ.
        chromosome[gene] = before


@allocation_free
def change_gene(
    rng: np.random.Generator,
    chromosome: np.ndarray,
    bits: int,
    alleles: np.ndarray,
    legal: np.ndarray,
    flips: bool,
) -> None:
    """Change, in place, a random gene of a chromosome: by `flip_bit`, or to a random allele, maybe
    the old one.
    """
    if flips:
        flip_bit(rng, chromosome, draw_integer(rng, 0, len(chromosome)), bits, legal)
    else:
        # Python draws what stands on the right first: the allele, and then the gene.
        chromosome[draw_integer(rng, 0, len(chromosome))] = alleles[
            draw_integer(rng, 0, len(alleles))
        ]

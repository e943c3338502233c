"""What more ranks would give: the cost model of the program `balance` for a uniform box, with collectives.

    t = n tau + H eta + m N lambda + c log2(P) gamma

a rank's step with n = N_all/P particles, H particles of other ranks within reach, N neighbouring ranks, m messages to each.
Analytic: a rank's cell is a block of n^(1/D) spacings a side, its halo the shell around it; no particle is held in memory.
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from .runner import factors

WIDTH = 3.8  # spacings: reach of the kernel (3 h, h = 1.2) and the lists' skin (0.2), as in `balance`


@dataclass(frozen=True)
class Costs:
    particle: float    # s, tau: computing, for each particle
    halo: float        # s, eta: for each particle of the halo, a step
    latency: float     # s, lambda: for each message
    messages: float    # m: to each neighbour, a step
    collective: float  # s, gamma: for one doubling of the ranks
    collectives: float  # c: a step
    halo_bytes: float  # that a halo particle takes a step


@dataclass(frozen=True)
class Network:
    """An assumption, not a measurement."""
    name: str
    latency: float      # s, a message between nodes
    bandwidth: float    # bytes/s of a node
    ranks_a_node: int   # which share it; all of their traffic is taken to leave the node


HDR = Network("InfiniBand HDR, 200 Gbit/s a node of 64 ranks, 1.5 µs", 1.5e-6, 25e9, 64)


def line(points: list[tuple[float, float]]) -> tuple[float, float]:
    """Intercept and slope that leave the least relative errors (weights 1/y²): a latency of µs is not lost under
    messages of ms."""
    x, y = np.array(points).T
    slope, intercept = np.polyfit(x, y, 1, w=1.0 / y)
    return intercept, slope


def costs_of(rows: list[dict], exchanges: list[dict]) -> Costs | None:
    """None where nothing was measured on several ranks with one thread. The least times count, of steps as of exchanges:
    other work on the machine only adds to them."""
    one = [r for r in rows if r["kind"] == "strong" and r["ranks"] == r["threads"] == 1]
    pair = sorted((r for r in rows if r["kind"] == "strong" and r["ranks"] > 1 and r["threads"] == 1), key=lambda r: r["ranks"])
    measured = sorted((e for e in exchanges if e["ranks"] > 1), key=lambda e: e["ranks"])
    if not one or not pair or not measured:
        return None
    e, two = measured[0], pair[0]
    # An exchange goes to all neighbours at once: time by messages and particles of a rank.
    latency, particle = line([(x["particles"] / x["messages"], x["seconds_least"] / x["messages"]) for x in e["exchanges"]])
    per_byte = particle / (8 * e["fields"])
    ghosts = two["fluid_halo_particles"] + two["wall_halo_particles"]
    halo_bytes = two["bytes_sent_per_step"] / ghosts
    neighbours = 1 if two["ranks"] == 2 else 2  # slabs; wider grids have not been measured where two ranks have
    alone = one[0]
    quickest = alone["seconds_per_step"] * alone["updates_per_second"] / max(alone["updates_per_second_readings"])
    return Costs(particle=quickest / alone["particles"], halo=per_byte * halo_bytes,
                 latency=max(latency, 0.0), messages=two["messages_per_step"] / neighbours,
                 collective=e["collective"]["seconds_least"] / math.log2(e["ranks"]),
                 collectives=two["collectives_per_step"], halo_bytes=halo_bytes)


def on_network(c: Costs, network: Network, ranks: int) -> Costs:
    """Packing stays as measured; what a rank sends goes through its share of the node's link."""
    if ranks <= network.ranks_a_node:
        return c
    inside = math.log2(network.ranks_a_node)
    between = math.log2(ranks) - inside
    return replace(c, halo=c.halo + c.halo_bytes * network.ranks_a_node / network.bandwidth, latency=network.latency,
                   collective=(inside * c.collective + between * network.latency) / (inside + between))


def cell(particles: float, ranks: int, dimension: int = 2) -> tuple[float, float]:
    """Particles in the halo of an inner rank, and its neighbours, for a square box (a cube) in blocks."""
    if dimension == 2:
        counts = factors(ranks)
    else:
        a = max(d for d in range(1, round(ranks ** (1 / 3)) + 1) if ranks % d == 0)
        counts = (a, *factors(ranks // a))
    side = particles ** (1 / dimension)
    wide, own, near = 1.0, 1.0, 1.0
    for n in counts:
        length = side / n
        # The shell ends at the box: one rank along an axis has nobody beside it, and none has more than all.
        wide *= min(length + 2 * WIDTH, side) if n > 1 else length
        own *= length
        near *= min(2 * math.ceil(WIDTH / length) + 1, n)
    return wide - own, near - 1


def seconds(particles: float, ranks: int, c: Costs, dimension: int = 2) -> float:
    """Of a step."""
    halo, neighbours = cell(particles, ranks, dimension)
    return (particles / ranks * c.particle + halo * c.halo + neighbours * c.messages * c.latency
            + c.collectives * math.log2(ranks) * c.collective)


def efficiency(particles: float, ranks: int, c: Costs, network: Network | None = None, dimension: int = 2) -> float:
    """Strong: of the time that one rank would take for all."""
    there = on_network(c, network, ranks) if network else c
    return particles * c.particle / (ranks * seconds(particles, ranks, there, dimension))

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rates of a machine with all its ranks at work at once, as JSON on rank 0:  mpirun -n 2 haptos_scaling_rates.py

bandwidth  bytes a second that each rank reads, of an array larger than its cache (dot product)
flops      of each rank, in dense products
latency    seconds of a message of 8 bytes to the next rank, while one comes from the other side
link       bytes a second that each rank sends so
reduction  seconds of a reduction of 8 bytes

The slowest rank counts, and of several rounds the fastest. NumPy and mpi4py; OPENBLAS_NUM_THREADS=1 for ranks of one core.
"""
import json
import time

import numpy
from mpi4py import MPI

WORLD = MPI.COMM_WORLD


def best(run, count=1, rounds=10):
    """Seconds of one of `count` calls. Collective."""
    seconds = []
    for _ in range(rounds):
        WORLD.Barrier()
        start = time.perf_counter()
        for _ in range(count):
            run()
        seconds.append(WORLD.allreduce(time.perf_counter() - start, MPI.MAX) / count)
    return min(seconds)


def ring(size):
    """Sends `size` numbers to the next rank."""
    given, taken = numpy.zeros(size), numpy.zeros(size)
    to, source = (WORLD.rank + 1) % WORLD.size, (WORLD.rank - 1) % WORLD.size
    return lambda: WORLD.Sendrecv(given, to, 0, taken, source, 0)


def rates():
    large, square = numpy.ones(1 << 25), numpy.ones((512, 512))
    one, result = numpy.zeros(1), numpy.zeros(1)
    return {"ranks": WORLD.size, "bandwidth": large.nbytes / best(lambda: large @ large), "flops": 2 * 512 ** 3 / best(lambda: square @ square),
            "latency": best(ring(1), 20, 100), "link": (8 << 17) / best(ring(1 << 17), 3, 50),
            "reduction": best(lambda: WORLD.Allreduce(one, result), 20, 100)}


if __name__ == "__main__":
    told = rates()
    if WORLD.rank == 0:
        print(json.dumps(told))

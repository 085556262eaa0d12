# SPDX-License-Identifier: BSD-3-Clause
"""Two rings in each other, plane strain, under the pressure MEAN + WAVE cos 2 theta outside: displacement and pressure between them."""
import numpy as np

INNER, CONTACT, OUTER, YOUNG, POISSON = 0.2, 0.6, 1.0, 1e9, 0.2
MEAN, WAVE = 1e7, 1e6
_STIFFNESS, _RATIO = YOUNG / (1 - POISSON ** 2), POISSON / (1 - POISSON)


def cos2(x):
    return (x[:, 0] ** 2 - x[:, 1] ** 2) / (x[:, 0] ** 2 + x[:, 1] ** 2)


def waves(r):
    """Of (A r^2 + B r^4 + C r^-2 + D) cos 2 theta as Airy's function: E' u_r and pressure on r over cos 2 theta, E' u_theta and shear over
    sin 2 theta, in the order u_r, u_theta, pressure, shear; as factors of A, B, C, D [4 x 4 (x points)]."""
    r = np.asarray(r, float)
    none, one = np.zeros_like(r), np.ones_like(r)
    return np.array([[-2 * (1 + _RATIO) * r, -4 * _RATIO * r ** 3, 2 * (1 + _RATIO) / r ** 3, 4 / r],
                     [2 * (1 + _RATIO) * r, (6 + 2 * _RATIO) * r ** 3, 2 * (1 + _RATIO) / r ** 3, -2 * (1 - _RATIO) / r],
                     [2 * one, none, 6 / r ** 4, 4 / r ** 2],
                     [2 * one, 6 * r ** 2, -6 / r ** 4, -2 / r ** 2]])


class Rings:
    """sticks: as one ring; else no shear between them."""

    def __init__(self, sticks=False):
        inside, between, outside = (waves(r) for r in (INNER, CONTACT, OUTER))
        rows = [(inside[2], 0), (inside[3], 0), (0, outside[2]), (0, outside[3]), (between[2], -between[2]), (between[0], -between[0])]
        rows += [(between[1], -between[1]), (between[3], -between[3])] if sticks else [(between[3], 0), (0, between[3])]
        matrix = np.array([np.concatenate([np.broadcast_to(part, 4) for part in row]) for row in rows])
        scale = np.abs(matrix).max(axis=1)
        self.factors = np.linalg.solve(matrix / scale[:, None], np.array([0, 0, WAVE, 0, 0, 0, 0, 0]) / scale).reshape(2, 4)

    def pressure(self, x):
        """Between the rings: of the mean by Lame, of the wave by Airy's function."""
        mean = MEAN * (1 - (INNER / CONTACT) ** 2) / (1 - (INNER / OUTER) ** 2)
        return mean + waves(CONTACT)[2] @ self.factors[1] * cos2(x)

    def displacement(self, x, body):
        """(u_r, u_theta) [n x 2] in the inner (0) or outer (1) ring."""
        r, theta = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
        mean = -MEAN * (1 + POISSON) / YOUNG / (1 - (INNER / OUTER) ** 2) * ((1 - 2 * POISSON) * r + INNER ** 2 / r)
        radial, around = np.einsum("ckn,k->cn", waves(r)[:2], self.factors[body]) / _STIFFNESS
        return np.stack([mean + radial * np.cos(2 * theta), around * np.sin(2 * theta)], axis=1)

    def displacement_xy(self, x, body):
        c, s = (x[:, :2] / np.hypot(x[:, 0], x[:, 1])[:, None]).T
        radial, around = self.displacement(x, body).T
        return np.stack([radial * c - around * s, radial * s + around * c], axis=1)

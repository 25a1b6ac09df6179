# SPDX-License-Identifier: MIT
"""Shells of the paper's scenes made closed, for methods that need an inside. They change shapes of a scene, a dict, in place."""


def shape(scene, name):
    return next(s for s in scene["shapes"] if s["name"] == name)


def thicken(scene, name, depth):
    """A flat plate in the plane z = 0 becomes the top of a box `depth` metres deep."""
    plate = shape(scene, name)
    x, y = (max(abs(v[axis]) for v in plate["vertices"]) for axis in (0, 1))
    plate["vertices"] = [[i, j, k] for i in (-x, x) for j in (-y, y) for k in (-depth, 0)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    plate["triangles"] = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def close_tube(scene, name):
    """Fans close a tube of one ring of segments along z, whose first half of vertices is its lower rim."""
    tube = shape(scene, name)
    n = len(tube["vertices"]) // 2
    tube["vertices"] += [[0, 0, tube["vertices"][0][2]], [0, 0, tube["vertices"][n][2]]]
    for i in range(n):
        j = (i + 1) % n
        tube["triangles"] += [[2 * n, j, i], [2 * n + 1, n + i, n + j]]


def close_prism(scene, name):
    """The catapult's edge, a roof of two slopes, gets a floor and two ends."""
    shape(scene, name)["triangles"] += [[2, 4, 5], [2, 5, 3], [0, 4, 2], [1, 3, 5]]

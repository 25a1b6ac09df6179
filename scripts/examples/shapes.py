# SPDX-License-Identifier: MIT
"""Meshes of the examples: pairs of vertices (n, 3), m, and faces (m, 3). None has a thickness, and none needs one."""
import numpy


def band(radii, heights, segments):
    """The surface of revolution through circles of these radii at these heights, about z; a radius of 0 is closed by a
    fan of faces that share no vertex with another."""
    angles = 2 * numpy.pi * numpy.arange(segments) / segments
    vertices = [(r * numpy.cos(a), r * numpy.sin(a), h) for r, h in zip(radii, heights) for a in angles]
    faces = []
    for level in range(len(radii) - 1):
        for k in range(segments):
            a, b = level * segments + k, level * segments + (k + 1) % segments
            c, d = a + segments, b + segments
            if radii[level] > 0:
                faces.append((a, b, d))
            if radii[level + 1] > 0:
                faces.append((a, d, c))
    return numpy.array(vertices), numpy.array(faces)


def cup(radius_bottom=0.03, radius_top=0.04, height=0.1, segments=12):
    """An open cup that stands on its bottom."""
    return band([0, radius_bottom, radius_top], [0, 0, height], segments)


def ring(radius=0.05, width=0.02, segments=16):
    """A ribbon closed to a ring, about z."""
    return band([radius, radius], [-width / 2, width / 2], segments)


def bin_of(width, depth, height):
    """An open bin of four walls and a floor; its floor lies in z = 0, in the middle of x and y."""
    x, y = width / 2, depth / 2
    vertices = [(sx * x, sy * y, z) for z in (0, height) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    faces = [(0, 1, 2), (0, 2, 3)]
    for a in range(4):
        b = (a + 1) % 4
        faces += [(a, b, b + 4), (a, b + 4, a + 4)]
    return numpy.array(vertices), numpy.array(faces)


def layers(count, spacing, width, bottom):
    """Places of a grid of this spacing, layer above layer from the height `bottom`, within a square of this width about
    z."""
    side = max(int(width // spacing), 1)
    for k in range(count):
        row, column = divmod(k % side**2, side)
        middle = (side - 1) / 2
        yield spacing * (column - middle), spacing * (row - middle), bottom + spacing * (k // side**2)


def random_rotations(count, generator):
    """Unit quaternions w x y z, uniform over all rotations."""
    q = generator.normal(size=(count, 4))
    return q / numpy.linalg.norm(q, axis=1, keepdims=True)

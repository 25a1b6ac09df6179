#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How densely do cups pack that fall into a bin? Cups nest: the space that they enclose may add up to more than they
take.

Prints for each taper (top radius over bottom radius) the share of the heap's volume that the cups enclose, counted for
each cup, below the height that 95 % of their vertices do not exceed; straight cups cannot nest, tapered ones may.
"""
import argparse

import numpy

import flotilla
import shapes

HEIGHT, BOTTOM = 0.1, 0.03  # m


def rotated(rotation, vectors):
    """q v q^-1 for vectors of shape (n, 3)."""
    w, u = rotation[0], rotation[1:]
    cross = numpy.cross(u, vectors)
    return vectors + 2 * (w * cross + numpy.cross(u, cross))


def density(taper, cups, width, duration, seed, picture=None):
    """Enclosed volume over volume of the heap."""
    top = taper * BOTTOM
    vertices, faces = shapes.cup(BOTTOM, top, HEIGHT)
    scene = flotilla.Scene(settings={"friction": 0.3, "seed": seed})
    enclosed = cups * numpy.pi * HEIGHT * (BOTTOM**2 + BOTTOM * top + top**2) / 3
    height = HEIGHT + 4 * enclosed / width**2  # the bin holds them all, however loosely they lie
    scene.add_body(scene.add_shape(shapes.bin_of(width, width, height)), type="static")
    shape = scene.add_shape((vertices, faces), name="cup", surface_density=2)
    spacing = 2.05 * numpy.linalg.norm(vertices, axis=1).max()
    rotations = shapes.random_rotations(cups, numpy.random.default_rng(seed))
    for place, rotation in zip(shapes.layers(cups, spacing, width, spacing / 2), rotations):
        scene.add_body(shape, position=place, rotation=rotation)
    world = flotilla.World(scene)
    world.step(round(duration / scene.settings.time_step))
    if picture:
        flotilla.picture(world, picture, width=800, height=600)
    corners = numpy.concatenate([position + rotated(rotation, vertices)
                                 for position, rotation in zip(world.positions[1:], world.rotations[1:])])
    return enclosed / (width**2 * numpy.quantile(corners[:, 2], 0.95))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cups", type=int, default=60, help="in the bin (default 60)")
    parser.add_argument("--width", type=float, default=0.45, help="of the bin, m (default 0.45)")
    parser.add_argument("--tapers", type=float, nargs="+", default=[1.0, 1.2, 1.5, 2.0])
    parser.add_argument("--seeds", type=int, default=3, help="heaps for each taper (default 3)")
    parser.add_argument("--duration", type=float, default=5, help="of the fall, s (default 5)")
    parser.add_argument("--picture", help="PNG of the last heap")
    options = parser.parse_args()
    print("taper  density  spread")
    for taper in options.tapers:
        values = [density(taper, options.cups, options.width, options.duration, seed, options.picture)
                  for seed in range(options.seeds)]
        print(f"{taper:5.2f}  {numpy.mean(values):7.3f}  {numpy.std(values):6.3f}")


if __name__ == "__main__":
    main()

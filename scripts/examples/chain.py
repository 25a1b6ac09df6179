#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A chain of ribbon rings hangs from a fixed one. Prints what each ring pulls at the one above: at rest the weight of
all below it.

Rings have no thickness: what holds the chain together is that no ring ever passes through another.
"""
import argparse

import numpy

import flotilla
import shapes

RADIUS, WIDTH, DENSITY = 0.05, 0.02, 20.0  # m, m, kg/m^2
HALF = numpy.sqrt(0.5)
EDGEWISE = ((HALF, HALF, 0, 0), (HALF, 0, HALF, 0))  # axes along y and along x


def make_chain(links):
    """Ring 0 is fixed, each next one hangs a little below where it will rest."""
    scene = flotilla.Scene(settings={"friction": 0.3, "time_step": 1 / 120})
    shape = scene.add_shape(shapes.ring(RADIUS, WIDTH), surface_density=DENSITY)
    pitch = 2 * RADIUS - 2.2 * WIDTH / 2  # the rings clear each other by more than half their width
    for k in range(links):
        scene.add_body(shape, name=f"link{k}", type="dynamic" if k else "static", position=(0, 0, -k * pitch),
                       rotation=EDGEWISE[k % 2])
    return scene


def pulls(world):
    """N, of each ring at the one above, upwards on the ring itself."""
    contacts = world.contacts_view
    force = contacts["impulse"][:, 2] / world.settings.time_step
    return numpy.array([force[(contacts["body_a"] == k - 1) & (contacts["body_b"] == k)].sum()
                        for k in range(1, len(world))])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--links", type=int, default=12, help="rings, the fixed one included (default 12)")
    parser.add_argument("--duration", type=float, default=6, help="s (default 6)")
    parser.add_argument("--picture", help="PNG of the end")
    options = parser.parse_args()
    scene = make_chain(options.links)
    world = flotilla.World(scene)
    world.step(round(options.duration / scene.settings.time_step))
    vertices, faces = shapes.ring(RADIUS, WIDTH)
    corners = vertices[faces]
    crossed = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = numpy.linalg.norm(crossed, axis=1).sum() / 2
    weight = 9.8 * DENSITY * area
    print("link  height, m   pull, N   weight below, N")
    for k, pull in enumerate(pulls(world), start=1):
        print(f"{k:4d}  {world.positions[k, 2]:9.4f}  {pull:8.4f}  {weight * (options.links - k):8.4f}")
    if options.picture:
        flotilla.picture(world, options.picture, width=500, height=1000, elevation=10, sun_samples=4, sky_samples=16)


if __name__ == "__main__":
    main()

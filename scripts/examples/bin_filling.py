#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Piles for synthetic data: things of the scene "household" fall into a bin; of every pile poses and a picture.

Writes DIR/pile-K.npz (names, shapes, positions (n, 3) in m, rotations (n, 4) as w x y z) and DIR/pile-K.png. No two
bodies of a pile intersect; --verify proves it with code that shares nothing with the solver.
"""
import argparse
import os
import tempfile

import numpy

import flotilla
import shapes


def small_things():
    """Shapes of the household, without those more than twice as large as the median, and the largest diameter."""
    shapes_there = [s for s in flotilla.make_scene("household", seed=1).shapes if s.mass_kind != "none"]
    sizes = numpy.array([2 * numpy.linalg.norm(s.vertices, axis=1).max() for s in shapes_there])
    small = sizes <= 2 * numpy.median(sizes)
    return [s for s, take in zip(shapes_there, small) if take], sizes[small].max()


def make_scene(bodies, seed):
    """Things in random poses on a grid above a bin, too far apart to touch."""
    generator = numpy.random.default_rng(seed)
    things, size = small_things()
    width = 2.1 * size
    scene = flotilla.Scene(settings={"friction": 0.4, "seed": seed})
    scene.add_body(scene.add_shape(shapes.bin_of(width, width, size), name="bin"), name="bin", type="static")
    for thing in things:
        scene.add_shape(thing, name=thing.name, **{thing.mass_kind: thing.mass_value})
    rotations = shapes.random_rotations(bodies, generator)
    for k, place in enumerate(shapes.layers(bodies, 1.01 * size, width, 0.6 * size)):
        thing = things[generator.integers(len(things))]
        scene.add_body(thing.name, name=f"{thing.name}-{k}", position=place, rotation=rotations[k])
    return scene


def prove(scene, duration):
    """Every step of the fall, from its record."""
    with tempfile.TemporaryDirectory() as folder:
        flotilla.run(scene, folder, duration=duration)
        report = flotilla.verify(folder)
    if not report.proved:
        raise SystemExit("\n".join(str(fault) for fault in report.faults))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bodies", type=int, default=40, help="in a pile (default 40)")
    parser.add_argument("--piles", type=int, default=3, help="how many (default 3)")
    parser.add_argument("--duration", type=float, default=5, help="of the fall, s (default 5)")
    parser.add_argument("--width", type=int, default=800, help="of the pictures, pixels (default 800)")
    parser.add_argument("--verify", action="store_true", help="prove every pile")
    parser.add_argument("--output", default="out/piles", help="folder (default out/piles)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    for seed in range(options.piles):
        scene = make_scene(options.bodies, seed)
        if options.verify:
            prove(scene, options.duration)
        world = flotilla.World(scene)
        world.step(round(options.duration / scene.settings.time_step))
        stem = os.path.join(options.output, f"pile-{seed}")
        numpy.savez_compressed(f"{stem}.npz", names=world.names, shapes=[body.shape for body in scene.bodies],
                               positions=world.positions, rotations=world.rotations)
        flotilla.picture(world, f"{stem}.png", width=options.width, height=options.width * 3 // 4)
        inside = (world.positions[1:, 2] > 0).sum()
        print(f"{stem}: {inside} of {options.bodies} bodies above the floor, {len(world.contacts)} contacts, "
              f"fastest {numpy.linalg.norm(world.velocities, axis=1).max():.3f} m/s")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A vibrating feeder bowl carries flat parts around. The bowl turns and lifts in small strokes at once, so that parts
are pressed to it on the way forward and lighter on the way back; prints how far each went around, and the mean speed.
"""
import argparse

import numpy

import flotilla
import shapes

INNER, OUTER, WALL = 0.10, 0.20, 0.06  # m: the track is a flat ring between two walls
FREQUENCY, LIFT, TURN = 25.0, 0.0003, 0.004  # Hz, m and rad, half of the strokes
STEPS_PER_STROKE = 16


def strokes(duration):
    """Keyframes of the bowl: up while it turns forward, down while it turns back."""
    for k in range(round(duration * FREQUENCY * STEPS_PER_STROKE) + 1):
        phase = 2 * numpy.pi * k / STEPS_PER_STROKE
        angle = TURN * numpy.sin(phase)
        yield (k / (FREQUENCY * STEPS_PER_STROKE), (0, 0, LIFT * numpy.sin(phase)),
               (numpy.cos(angle / 2), 0, 0, numpy.sin(angle / 2)))


def make_scene(parts, duration, seed):
    scene = flotilla.Scene(settings={"time_step": 1 / (FREQUENCY * STEPS_PER_STROKE), "friction": 0.5, "restitution": 0,
                                     "seed": seed})
    bowl = scene.add_shape(shapes.band([INNER, INNER, OUTER, OUTER], [WALL, 0, 0, WALL], 48), name="bowl")
    scene.add_body(bowl, name="bowl", type="kinematic", keyframes=strokes(duration))
    part = scene.add_shape(shapes.band([0, 0.015], [0, 0], 6), name="part", surface_density=8)
    for k in range(parts):
        angle, layer = 2 * numpy.pi * (k % 18) / 18, k // 18
        scene.add_body(part, position=(0.15 * numpy.cos(angle), 0.15 * numpy.sin(angle), 0.004 + 0.01 * layer))
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--parts", type=int, default=12)
    parser.add_argument("--duration", type=float, default=2, help="s (default 2)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--picture", help="PNG of the end")
    options = parser.parse_args()
    world = flotilla.World(make_scene(options.parts, options.duration, options.seed))
    went = numpy.zeros(options.parts)
    places, before = world.positions_view[1:], None  # where the parts are, whenever it is looked at
    for _ in range(round(options.duration * FREQUENCY)):
        world.step(STEPS_PER_STROKE)
        angle = numpy.arctan2(places[:, 1], places[:, 0])
        if before is not None:
            went += (angle - before + numpy.pi) % (2 * numpy.pi) - numpy.pi
        before = angle
    for k, way in enumerate(went):
        print(f"part {k}: {numpy.degrees(way):7.2f} degrees around")
    print(f"mean {went.mean() * 0.15 / options.duration * 1000:.2f} mm/s")
    if options.picture:
        flotilla.picture(world, options.picture, width=800, height=600)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: MIT
import os
import subprocess
import types

import numpy
import pytest

import flotilla


def grid_plate(size=1.0, cells=1):
    """A flat plate without thickness, as trimesh's meshes are: vertices (n, 3) and faces (m, 3)."""
    line = numpy.linspace(0, size, cells + 1)
    vertices = numpy.array([(x, y, 0.0) for y in line for x in line])
    faces = []
    for row in range(cells):
        for column in range(cells):
            corner = row * (cells + 1) + column
            faces += [(corner, corner + 1, corner + cells + 2), (corner, corner + cells + 2, corner + cells + 1)]
    return types.SimpleNamespace(vertices=vertices, faces=numpy.array(faces))


@pytest.fixture
def plate():
    return grid_plate()


@pytest.fixture
def falling():
    """A plate 0.1 m above a larger fixed one."""
    scene = flotilla.Scene()
    ground = scene.add_shape(grid_plate(3.0), name="ground")
    thing = scene.add_shape(grid_plate(), name="plate", surface_density=10)
    scene.add_body(ground, type="static", position=(-1, -1, 0))
    scene.add_body(thing, name="falls", position=(0, 0, 0.1), angular_velocity=(0.3, 0.2, 0.1))
    return scene


@pytest.fixture
def command():
    """Runs the command; it must succeed."""
    def call(*arguments):
        words = [os.environ["FLOTILLA_COMMAND"], *map(str, arguments)]
        return subprocess.run(words, check=True, capture_output=True, text=True).stdout
    return call

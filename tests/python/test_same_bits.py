# SPDX-License-Identifier: MIT
"""A World of Python's has the bits of the command's run, whatever the number of threads and the way in."""
import json

import pytest

import flotilla

STEPS = 20


@pytest.fixture(scope="module")
def scene_text():
    return flotilla.make_scene("household", bodies=12, seed=3).to_json()


@pytest.fixture
def recorded(scene_text, tmp_path, command):
    file = tmp_path / "scene.json"
    file.write_text(scene_text)
    command("run", file, "--steps", STEPS, "--output", tmp_path / "run", "--quiet", "--threads", 1)
    return file, flotilla.read_steps(tmp_path / "run")["state_hash"]


@pytest.mark.parametrize("options", [{"threads": 1}, {"threads": 2}, {"executor": "serial"}])
def test_step_by_step(recorded, options):
    file, hashes = recorded
    world = flotilla.World(file, **options)
    assert [world.step().state_hash for _ in range(STEPS)] == list(hashes)


def test_every_way_to_give_a_scene(recorded, scene_text):
    file, hashes = recorded
    for scene in (file, str(file), scene_text, json.loads(scene_text), flotilla.read_scene(scene_text)):
        assert flotilla.World(scene, threads=1).step(STEPS).state_hash == hashes[-1]


def test_a_run_and_its_resumption(recorded, tmp_path):
    file, hashes = recorded
    totals = flotilla.run(file, tmp_path / "again", steps=STEPS, threads=1,
                          after_step=lambda report: report.step < STEPS // 2)
    assert not totals.complete and totals.steps == STEPS // 2
    totals = flotilla.run(file, tmp_path / "again", steps=STEPS, resume=True, threads=2)
    assert totals.complete and totals.resumed_after == STEPS // 2
    assert list(flotilla.read_steps(tmp_path / "again")["state_hash"]) == list(hashes)
    assert flotilla.compare_runs(tmp_path / "run", tmp_path / "again").same_bits

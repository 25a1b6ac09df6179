# SPDX-License-Identifier: MIT
"""Edits as values and files: what a World records makes the same run again, here and by the command."""
import json

import numpy
import pytest

import flotilla


@pytest.fixture
def scene(falling):
    """The bodies of `falling`, one more high up, and a group."""
    falling.add_body("plate", name="high", position=(0, 0, 4), group="loose")
    return falling


def edit_all(world, plate):
    """An edit of every kind, some of them after steps."""
    falls, high = world.find("falls"), world.find("high")
    shape = world.add_shape(plate, name="extra", mass=2)
    added = world.add_body(shape, name="added", position=(0, 0, 8))
    world.set_pose(high, (0, 0, 6), (0, 1, 0, 0))
    world.set_velocity(falls, (0, 0, 1), (0.1, 0, 0))
    world.set_material(falls, 0.4, 0.2)
    world.set_force(falls, (0, 0, 1), (0, 0, 0.1))
    world.apply_force(falls, (1, 0, 0), world.body(1).center_of_mass)
    world.apply_torque(falls, (0, 0.1, 0))
    world.apply_impulse(high, (0, 0, 1), world.body(2).center_of_mass)
    world.step(2)
    world.set_gravity((0, 0, -5))
    world.set_group(falls, "loose")
    world.ignore_groups("loose", "loose")
    world.ignore_pair(falls, added)
    world.set_type(high, "static")
    world.set_script(added, [(world.time + 1, (0, 0, 9))])
    world.step(3)
    world.remove_body(high)
    world.wake(falls)
    return world.step(4).state_hash


def recorded(scene, plate):
    world = flotilla.World(scene, threads=1)
    world.record_edits()
    return world, edit_all(world, plate)


def test_a_record_holds_every_kind(scene, plate):
    world, _ = recorded(scene, plate)
    edits = world.recorded_edits
    assert [edit.kind for edit in edits] == [
        "add_shape", "add_body", "set_pose", "set_velocity", "set_material", "set_force", "apply_force", "apply_force",
        "apply_impulse", "set_gravity", "set_group", "ignore_groups", "ignore_pair", "set_type", "set_script",
        "remove_body", "wake"]
    assert [edit.step for edit in edits] == 9 * [0] + 6 * [2] + 2 * [5]
    assert repr(edits[0]) == "Edit(step=0, kind='add_shape')"
    world.record_edits(False)
    world.set_gravity((0, 0, -9))
    assert len(world.recorded_edits) == len(edits)


def test_edits_made_again_have_the_same_bits(scene, plate):
    world, expected = recorded(scene, plate)
    other, answers = flotilla.World(scene, threads=2), []
    for edit in world.recorded_edits:
        while other.steps < edit.step:
            other.step()
        answers.append(other.apply(edit))
    assert other.step(world.steps - other.steps).state_hash == expected
    assert answers[0] == 2 and answers[1] == flotilla.BodyId(3) and answers[9] is None
    assert [shape.name for shape in other.scene_now().shapes] == ["ground", "plate", "extra"]


def test_runs_have_the_shapes_of_their_time(scene, plate, tmp_path):
    world = flotilla.World(scene, threads=1)
    world.record_edits(True)
    for scale in (1, 2):
        shape = world.add_shape(plate, mass=1, scale=scale)
        body = world.add_body(shape, position=(0, 0, 30), name=f"of scale {scale}")
        world.step(2)
        world.remove_body(body)
        world.remove_shape(shape)
    edits = tmp_path / "edits.json"
    flotilla.write_edits(world.recorded_edits, scene, edits)
    assert [edit.kind for edit in flotilla.read_edits(edits, scene)] == 2 * [
        "add_shape", "add_body", "remove_body", "remove_shape"]
    for given in (world.recorded_edits, edits):
        totals = flotilla.run(scene, tmp_path / "run", steps=4, edits=given, threads=1, overwrite=True)
        assert totals.last.step == 4
    assert flotilla.verify(tmp_path / "run").proved
    flotilla.export_run(tmp_path / "run", "glb", tmp_path / "run.glb")


def test_a_run_names_shapes_as_a_world_does(scene, plate, tmp_path):
    world = flotilla.World(scene, threads=1)
    world.record_edits(True)
    world.add_body(world.add_shape(plate, mass=1), position=(0, 0, 30))
    world.step(3)
    totals = flotilla.run(scene, tmp_path / "run", steps=3, edits=world.recorded_edits, threads=1)
    assert totals.last.state_hash == world.state_hash


def test_files_and_runs_of_edits(scene, plate, tmp_path, command):
    world, expected = recorded(scene, plate)
    file, edits = tmp_path / "scene.json", tmp_path / "edits.json"
    flotilla.write_scene(scene, file)
    flotilla.write_edits(world.recorded_edits, scene, edits)
    command("run", file, "--edits", edits, "--steps", world.steps, "--output", tmp_path / "command", "--quiet")
    assert flotilla.read_steps(tmp_path / "command")["state_hash"][-1] == expected
    document = json.loads(edits.read_text())
    for k, given in enumerate((world.recorded_edits, edits, str(edits), edits.read_text(), document,
                               flotilla.read_edits(edits, file))):
        totals = flotilla.run(scene, tmp_path / f"run{k}", steps=world.steps, edits=given)
        assert totals.last.state_hash == expected, k
    assert flotilla.verify(tmp_path / "run0").proved
    frames = flotilla.read_frames(tmp_path / "run0")
    assert frames.bodies == ["body0", "falls", "high", "added"]
    assert frames.cluster[-1, 2] == flotilla.ClusterState.ABSENT == frames.cluster[0, 3]


def test_misuse_is_refused(scene, tmp_path):
    with pytest.raises(flotilla.InputError, match="edits"):
        flotilla.read_edits({"flotilla_edits": 1}, scene)
    with pytest.raises(flotilla.InputError, match="nobody"):
        flotilla.read_edits({"flotilla_edits": 1, "edits": [{"step": 1, "remove_body": "nobody"}]}, scene)
    with pytest.raises(flotilla.IoError):
        flotilla.read_edits(tmp_path / "nowhere.json", scene)
    with pytest.raises(TypeError, match="edits are a list"):
        flotilla.read_edits(42, scene)
    with pytest.raises(TypeError, match="must be an Edit"):
        flotilla.run(scene, steps=1, edits=[1])
    (edit,) = flotilla.read_edits({"flotilla_edits": 1, "edits": [{"step": 3, "remove_body": "high"}]}, scene)
    later = flotilla.read_edits({"flotilla_edits": 1, "edits": [{"step": 1, "wake": "falls"}]}, scene)
    with pytest.raises(flotilla.InputError, match="sorted"):
        flotilla.run(scene, steps=5, edits=[edit, *later])
    edit.step = 0
    assert flotilla.run(scene, steps=2, edits=[edit, *later]).complete
    world = flotilla.World(scene)
    world.apply(edit)
    with pytest.raises(flotilla.InputError):
        world.apply(edit)
    with pytest.raises(TypeError):
        world.apply("wake")
    with pytest.raises(flotilla.InputError):
        flotilla.write_edits([edit, edit], scene, tmp_path / "twice.json")


def test_a_run_says_what_it_did_before_a_script_ended_it():
    scene, told = flotilla.make_scene("closing-walls"), []
    scene.settings.unsatisfiable_script = "error"
    with pytest.raises(flotilla.ScriptError) as caught:
        flotilla.run(scene, duration=100, blocked=told.append)
    (totals,) = told
    assert totals.steps == caught.value.step - 1 and numpy.isfinite(totals.total_ms) and not totals.complete

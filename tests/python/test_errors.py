# SPDX-License-Identifier: MIT
"""Every exception of the library is the class of its name, with its data."""
import pytest

import flotilla


def walls(error_setting):
    scene = flotilla.make_scene("closing-walls")
    scene.settings.unsatisfiable_script = error_setting
    return scene


def test_all_derive_from_error():
    for kind in (flotilla.InputError, flotilla.IoError, flotilla.OverlapError, flotilla.ScriptError,
                 flotilla.BrokenPromise):
        assert issubclass(kind, flotilla.Error)
    assert issubclass(flotilla.InputError, ValueError)


def test_an_invalid_scene_names_all_its_problems():
    scene = {"flotilla_scene": 1, "gravity": [0, 0], "shapes": [], "bodys": []}
    with pytest.raises(flotilla.InputError) as caught:
        flotilla.World(scene)
    places = [problem.where for problem in caught.value.problems]
    assert "/gravity" in places and "/bodys" in places
    assert all(problem.reason for problem in caught.value.problems)
    assert str(caught.value).count("\n") == len(places) - 1


def test_a_missing_file():
    with pytest.raises(flotilla.IoError, match="nowhere.json"):
        flotilla.World("nowhere.json")


def test_bodies_that_intersect(plate):
    with pytest.raises(flotilla.OverlapError) as caught:
        flotilla.World(flotilla.scene_from_meshes([plate, plate], positions=[(0, 0, 0), (0.5, 0.5, 0)]))
    (pair,) = caught.value.pairs
    assert pair[:4] == (0, 1, "body0", "body1") and pair.triangle_pairs >= 1


def test_a_script_that_cannot_go_on_leaves_the_world_as_it_was():
    world = flotilla.World(walls("error"))
    with pytest.raises(flotilla.ScriptError) as caught:
        world.step(10_000)
    assert caught.value.step == world.steps + 1
    assert caught.value.pairs[0].name_a and caught.value.pairs[0].a != caught.value.pairs[0].b
    before = world.state_hash
    with pytest.raises(flotilla.ScriptError):
        world.step()
    assert world.state_hash == before
    flotilla.World(walls("hold")).step(caught.value.step)


def test_a_run_that_a_script_ends_can_be_read(tmp_path):
    with pytest.raises(flotilla.ScriptError) as caught:
        flotilla.run(walls("error"), tmp_path / "run", duration=100)
    assert len(flotilla.read_frames(tmp_path / "run")) == caught.value.step


def test_exceptions_can_be_made_by_hand():
    assert flotilla.BrokenPromise("text", 3, (0, 1, "a", "b")).pair.name_b == "b"
    assert flotilla.InputError("text").problems == () and str(flotilla.InputError("text")) == "text"

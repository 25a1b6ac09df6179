# SPDX-License-Identifier: MIT
import copy
import json
import types

import numpy
import pytest

import flotilla


def test_a_scene_reads_back_from_all_it_is_written_to(falling, tmp_path):
    flotilla.write_scene(falling, tmp_path / "scene.json")
    for source in (tmp_path / "scene.json", falling.to_json(), falling.to_dict()):
        again = flotilla.read_scene(source)
        assert again.to_json() == falling.to_json()
        assert flotilla.World(again).scene_hash == flotilla.World(falling).scene_hash


def test_meshes_become_bodies(plate):
    scene = flotilla.scene_from_meshes([plate, plate, (plate.vertices, plate.faces)],
                                       positions=[(0, 0, 0), (0, 0, 1), (0, 0, 2)], static=[0],
                                       settings={"friction": 0.5})
    assert len(scene.shapes) == 2 and [body.shape for body in scene.bodies] == [0, 0, 1]
    assert [body.type for body in scene.bodies] == ["static", "dynamic", "dynamic"]
    assert scene.bodies[1].friction == 0.5
    assert (scene.shapes[0].vertices == plate.vertices).all() and (scene.shapes[0].faces == plate.faces).all()
    assert flotilla.check_scene(scene).intersections == []


def test_what_is_set_in_a_body_is_set_in_the_scene(falling):
    body = falling.bodies[1]
    body.position, body.velocity, body.friction, body.name = numpy.array((1, 2, 3)), [1, 0, 0], 0.7, "renamed"
    same = falling.bodies[1]
    assert (same.position == (1, 2, 3)).all() and (same.velocity == (1, 0, 0)).all()
    assert (same.friction, same.name) == (0.7, "renamed")
    for _ in range(100):  # the list of bodies moves in memory; the place stays
        falling.add_body("plate")
    body.restitution = 0.25
    assert falling.bodies[1].restitution == 0.25
    del falling
    assert body.name == "renamed"


def test_copies_of_scenes_are_their_own(falling):
    for duplicate in (copy.copy(falling), copy.deepcopy(falling)):
        duplicate.bodies[1].position = (7, 7, 7)
        assert falling.bodies[1].position[2] == 0.1


def test_rows_of_two_are_segments_and_of_one_points():
    scene = flotilla.Scene(gravity=(0, 0, 0))
    corners = numpy.array([(0, 0, 0), (3.0, 0, 0), (0, 4, 0)])
    wire = scene.add_shape((corners, [(0, 1), (0, 2)]), line_density=2)
    cloud = scene.add_shape((corners, [[0], [1], [2]]), mass=3)
    assert [shape.mass_kind for shape in scene.shapes] == ["line_density", "mass"]
    assert scene.shapes[wire].faces.tolist() == [[0, 1, 1], [0, 2, 2]]
    assert scene.shapes[cloud].faces.tolist() == [[0, 0, 0], [1, 1, 1], [2, 2, 2]]
    scene.add_body(wire, angular_velocity=(0, 0, 1))
    scene.add_body(cloud, position=(0, 0, 1))
    assert flotilla.read_scene(scene.to_dict()).to_json() == scene.to_json()
    world = flotilla.World(scene)
    world.step(3)
    assert world.angular_velocities[0][2] == pytest.approx(1)
    with pytest.raises(flotilla.InputError, match="segments"):
        scene.add_shape((corners, [(0, 1, 2, 0)]))
    with pytest.raises(flotilla.InputError, match="line_density"):
        scene.add_shape((corners, [(0, 1)]), line_density=1, mass=1)


def test_masses_of_all_kinds(plate):
    scene = flotilla.Scene()
    scene.add_shape(plate, surface_density=2)
    scene.add_shape(plate, mass=3, inertia=(1, 2, 3), center_of_mass=(0.5, 0.5, 0))
    scene.add_shape(plate, mass=3, inertia=numpy.diag((1, 2, 3)), scale=2)
    scene.add_shape(plate)
    assert [shape.mass_kind for shape in scene.shapes] == ["surface_density", "mass", "mass", "none"]
    assert scene.shapes[2].vertices.max() == 2
    with pytest.raises(flotilla.InputError, match="one of"):
        scene.add_shape(plate, mass=1, density=1)


def test_shapes_tell_what_replaces_their_own(plate):
    scene = flotilla.Scene()
    scene.add_shape(plate, mass=3, inertia=(1, 2, 3), center_of_mass=(0.5, 0.5, 0))
    scene.add_shape(plate, mass=3)
    first, second = scene.shapes
    assert (first.inertia == numpy.diag((1, 2, 3))).all() and (first.center_of_mass == (0.5, 0.5, 0)).all()
    assert second.inertia is None and second.center_of_mass is None


def test_every_field_of_a_body_reads_back(plate):
    scene = flotilla.Scene()
    shape = scene.add_shape(plate, mass=1, name="plate")
    scene.add_body(shape, name="slider", locked=["z", "x", "ry"], force=(1, 2, 3), torque=(0, 0, 1), group="rail")
    scene.add_body(shape, name="rail", type="static", position=(0, 0, 1), group="rail")
    scene.ignore_groups("rail", "rail")
    scene.ignore_bodies("slider", "rail")
    written = scene.to_dict()
    assert written["bodies"][0]["locked"] == ["x", "z", "ry"] and written["bodies"][0]["group"] == "rail"
    assert written["ignore"] == {"groups": [["rail", "rail"]], "bodies": [["slider", "rail"]]}
    for again in (scene, flotilla.read_scene(written), flotilla.read_scene(scene.to_json())):
        slider = again.bodies[0]
        assert slider.locked == ("x", "z", "ry") and slider.group == "rail"
        assert (slider.force == (1, 2, 3)).all() and (slider.torque == (0, 0, 1)).all()
        assert again.ignored_groups == [("rail", "rail")] and again.ignored_bodies == [("slider", "rail")]
    slider = scene.bodies[0]
    slider.locked, slider.force, slider.torque, slider.group = (), (0, 0, 0), (0, 0, 0), ""
    assert slider.locked == () and "locked" not in scene.to_dict()["bodies"][0]
    lid = scene.bodies[1]
    lid.type, lid.keyframes = "kinematic", [(0, (0, 0, 1)), (2, (0, 0, 3), (0, 1, 0, 0))]
    assert [k[0] for k in lid.keyframes] == [0, 2] and (lid.keyframes[1][1] == (0, 0, 3)).all()
    for wrong in (["w"], ["xy"], [""], ["r"]):
        with pytest.raises(flotilla.InputError, match="an axis is"):
            slider.locked = wrong
    with pytest.raises(flotilla.InputError, match="an axis is"):
        scene.add_body(shape, locked=("rw",))
    with pytest.raises(TypeError):
        slider.force = "up"
    with pytest.raises(TypeError, match="2 numbers, where 3 are due"):
        slider.force = (1, 2)
    with pytest.raises(flotilla.InputError):
        lid.keyframes = [(0,)]
    scene.add_body(shape, name="heavy", position=(0, 0, 5), force=(float("inf"), 0, 0))
    with pytest.raises(flotilla.InputError, match="force"):
        flotilla.World(scene)


def test_keyframes_move_a_body(plate):
    scene = flotilla.Scene(settings={"time_step": 0.1})
    scene.add_body(scene.add_shape(plate), type="kinematic", keyframes=[(0, (0, 0, 5)), (1, (0, 0, 4), (1, 0, 0, 0))])
    assert scene.bodies[0].keyframes[1][0] == 1 and scene.bodies[0].position[2] == 5
    world = flotilla.World(scene)
    world.step(5)
    assert world.positions[0, 2] == pytest.approx(4.5, abs=1e-12)


def test_settings_are_checked_and_typed():
    settings = flotilla.Settings("accurate", friction=numpy.float64(0.3), sleeping=True)
    assert settings.friction == 0.3 and settings.sleeping is True and settings.trajectory == "rigid"
    assert isinstance(settings.collision_iterations, int)
    settings.time_step = 0.1
    assert settings.time_step == 0.1 and settings.validate() == []
    assert set(settings.to_dict()) == {info.key for info in flotilla.list_settings()}
    assert flotilla.Settings() == flotilla.Settings("balanced") != settings
    for key, value in (("friction", -1), ("friction", "much"), ("sleeping", 3), ("ccd", "cubical"), ("substeps", 1.5)):
        with pytest.raises(flotilla.InputError):
            setattr(settings, key, value)
    with pytest.raises(flotilla.InputError, match="did you mean \"friction\""):
        flotilla.Settings(frction=1)
    with pytest.raises(flotilla.InputError, match="preset"):
        flotilla.Settings("fast")
    with pytest.raises(AttributeError):
        settings.friktion = 1


def test_presets_and_settings_of_files(falling):
    text = falling.to_json()
    assert flotilla.read_scene(text, preset="accurate", settings={"friction": 0.9}).settings.friction == 0.9
    assert flotilla.read_scene(text, preset="accurate").settings.substeps == 4
    with pytest.raises(flotilla.InputError, match="scene.settings"):
        flotilla.World(falling, preset="accurate")


@pytest.mark.parametrize("mesh, kind", [
    (types.SimpleNamespace(vertices=[(0, 0)], faces=[(0, 0, 0)]), flotilla.InputError),
    (types.SimpleNamespace(vertices=[(0, 0, 0)], faces=[(0, 0, 0, 0)]), flotilla.InputError),
    (types.SimpleNamespace(vertices=[(0, 0, 0)], faces=[(0.5, 0, 0)]), flotilla.InputError),
    (types.SimpleNamespace(vertices=[(0, 0, 0)], faces=[(0, 0, -1)]), flotilla.InputError),
    (types.SimpleNamespace(vertices=[(0, 0, 0)], faces=[(0, 0, 2**31)]), flotilla.InputError),
    (types.SimpleNamespace(vertices="abc", faces=[(0, 0, 0)]), ValueError),
    ("mesh", TypeError),
    (None, TypeError),
])
def test_meshes_that_are_none(mesh, kind):
    with pytest.raises(kind):
        flotilla.Scene().add_shape(mesh)


def test_a_face_beyond_the_vertices_is_found_with_its_place(plate):
    scene = flotilla.Scene()
    scene.add_body(scene.add_shape((plate.vertices, [(0, 1, 9)]), surface_density=1))
    with pytest.raises(flotilla.InputError) as caught:
        flotilla.World(scene)
    assert caught.value.problems[0].where == "/shapes/0/triangles/0"


def test_bodies_that_are_none(falling, plate):
    with pytest.raises(flotilla.InputError, match="did you mean \"plate\""):
        falling.add_body("plates")
    with pytest.raises(flotilla.InputError, match="shape 5"):
        falling.add_body(5)
    with pytest.raises(flotilla.InputError, match="static"):
        falling.add_body("plate", type="statik")
    with pytest.raises(TypeError):
        falling.add_body("plate", position=(0, 0))
    with pytest.raises(TypeError):
        falling.add_body("plate", position="abc")
    with pytest.raises(flotilla.InputError, match="keyframe"):
        falling.add_body("plate", keyframes=[(0,)])
    with pytest.raises(flotilla.InputError, match="positions must have shape"):
        flotilla.scene_from_meshes([plate], positions=[(0, 0)])
    with pytest.raises(flotilla.InputError, match="static"):
        flotilla.scene_from_meshes([plate], static=[1])
    assert len(falling.bodies) == 2


def test_dicts_may_hold_arrays(falling):
    scene = falling.to_dict()
    scene["bodies"][1]["position"] = numpy.array((0.0, 0.0, 0.5))
    assert flotilla.read_scene(scene).bodies[1].position[2] == 0.5
    scene["bodies"][1]["position"] = object()
    with pytest.raises(TypeError, match="object"):
        flotilla.read_scene(scene)


def test_the_library_of_scenes():
    names = [entry.name for entry in flotilla.list_scenes()]
    assert "boats-in-bowl" in names
    scene = flotilla.make_scene("household", bodies=12, seed=5)
    assert len(scene.bodies) == 12
    assert scene.to_json() == flotilla.make_scene("household", bodies=12, seed=5).to_json()
    with pytest.raises(flotilla.InputError, match="did you mean"):
        flotilla.make_scene("houshold")


def test_scenes_of_another_program(tmp_path):
    (tmp_path / "fixture.json").write_text(json.dumps({
        "timestep": 0.02, "max_time": 3, "rigid_body_problem": {"rigid_bodies": [
            {"vertices": [[0, 0, 0], [1, 0, 0], [0, 0, 1], [0, 1, 0]],
             "faces": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]}]}}))
    origin = flotilla.scene_origin(tmp_path / "fixture.json")
    assert origin.format == "Rigid-IPC" and origin.duration == 3 and isinstance(origin.warnings, list)
    assert flotilla.read_scene(tmp_path / "fixture.json").settings.time_step == 0.02
    assert flotilla.scene_origin(flotilla.Scene()).format == ""


def test_plans_and_checks(falling, plate, tmp_path):
    assert all(topic and text for topic, text in flotilla.plan(falling))
    check = flotilla.check_scene(falling)
    assert (check.dynamic_bodies, check.static_bodies, check.triangles) == (1, 1, 4)
    assert check.mass == pytest.approx(10, abs=1e-9)
    crossing = flotilla.check_scene(flotilla.scene_from_meshes([plate, plate])).intersections
    assert crossing[0].triangles_a.shape[1:] == (3, 3) and crossing[0].triangle_pairs >= 1
    flotilla.write_intersections(crossing, tmp_path / "crossing.obj")
    assert (tmp_path / "crossing.obj").read_text().count("\nf ") == len(crossing[0].triangles_a) + len(
        crossing[0].triangles_b)
    assert (check.locked_bodies, check.driven_bodies) == (0, 0)
    falling.bodies[1].locked, falling.bodies[1].torque = ("x",), (0, 0, 1)
    check = flotilla.check_scene(falling)
    assert (check.locked_bodies, check.driven_bodies) == (1, 1)
    with pytest.raises(flotilla.InputError):
        flotilla.check_scene(json.loads("{}"))

# SPDX-License-Identifier: MIT
"""Worlds that change between steps."""
import copy
import gc
import pickle

import numpy
import pytest

import flotilla


@pytest.fixture
def world(falling):
    return flotilla.World(falling, threads=1)


def test_bodies_come_and_go(world, plate):
    shape = world.add_shape(plate, surface_density=5)
    first = world.add_body(shape, position=(0, 0, 1), velocity=(0, 0, -1))
    assert isinstance(first, flotilla.BodyId) and (first.index, first.generation) == (2, 0)
    assert len(world) == world.num_bodies == 3 and world.types == ["static", "dynamic", "dynamic"]
    named = world.add_body(1, name="second", position=(0, 0, 2), friction=0.7)
    assert world.find("second") == named == world.id(3) and world.names[3] == "second"
    world.step(10)
    world.remove_body(first)
    assert not world.contains(first) and world.contains(named)
    assert len(world) == 4 and world.num_bodies == 3 and world.names[2] == "" and world.types[2] == ""
    assert world.ids == [world.id(0), world.id(1), named]
    again = world.add_body(shape, position=(0, 0, 9))
    assert again.index == first.index and again.generation == 1 and again != first
    with pytest.raises(flotilla.InputError):
        world.remove_body(first)
    assert world.step(5).step == 15


def test_an_edit_that_is_refused_changes_nothing(world):
    before = world.state_hash
    with pytest.raises(flotilla.OverlapError) as caught:
        world.add_body(1, position=(0, 0, 0))
    assert caught.value.pairs
    with pytest.raises(flotilla.OverlapError):
        world.set_pose(world.id(1), (0, 0, 0))
    for wrong in (lambda: world.add_body(9), lambda: world.set_type(world.id(1), "statik"),
                  lambda: world.find("nobody"), lambda: world.wake(flotilla.BodyId(7)), lambda: world.set_material(world.id(1), -1, 0)):
        with pytest.raises(flotilla.InputError):
            wrong()
    for wrong in (lambda: world.wake(1), lambda: world.add_body(1, colour="red"), lambda: world.set_gravity("down")):
        with pytest.raises(TypeError):
            wrong()
    assert world.state_hash == before and len(world) == 2


def test_forces_move_bodies_as_newton_says(plate):
    scene = flotilla.Scene(gravity=(0, 0, 0), settings={"time_step": 0.01})
    scene.add_body(scene.add_shape(plate, mass=2))
    world = flotilla.World(scene, threads=1)
    body, centre = world.id(0), world.centers_of_mass[0]
    world.set_force(body, (4, 0, 0))
    world.step(10)  # 4 N on 2 kg for 0.1 s
    assert world.velocities[0] == pytest.approx((0.2, 0, 0), abs=1e-12)
    world.set_force(body, (0, 0, 0))
    world.apply_force(body, (0, 200, 0), world.centers_of_mass[0])
    world.step(2)  # one step of 200 N
    assert world.velocities[0] == pytest.approx((0.2, 1, 0), abs=1e-12)
    world.apply_impulse(body, (0, 0, 6), world.centers_of_mass[0])
    assert world.velocities[0] == pytest.approx((0.2, 1, 3), abs=1e-12)
    world.apply_torque(body, (0, 0, 1))
    world.step()
    assert world.angular_velocities[0, 2] > 0
    world.set_velocity(body, (0, 0, 0))
    assert not world.velocities.any() and not world.angular_velocities.any()
    world.set_gravity((0, 0, -10))
    world.step(10)
    assert world.gravity[2] == -10 and world.velocities[0, 2] == pytest.approx(-1, abs=1e-12)
    assert world.step().energy == pytest.approx(world.energy, rel=1e-12)
    assert (centre[:2] > 0).all()


def test_questions_about_bodies(world):
    hit = world.ray((0.4, 0.4, 5), (0, 0, -2), 10)
    assert hit.body == world.find("falls") and hit.point == pytest.approx((0.4, 0.4, 0.1), abs=1e-12)
    assert hit.distance == pytest.approx(4.9, abs=1e-12) and hit.normal == pytest.approx((0, 0, 1), abs=1e-12)
    assert world.ray((50, 0, 5), (0, 0, -1), 10) is None
    assert world.closest(world.id(0), world.id(1)).distance == pytest.approx(0.1, abs=1e-12)
    assert world.overlapping(1, (0, 0, 0.1)) == [world.id(1)] and world.overlapping(1, (0, 0, 3)) == []
    assert world.bodies_in((0, 0, 0.05), (1, 1, 0.2)) == [world.id(1)]
    assert {world.id(0), world.id(1), world.id(1)} == {flotilla.BodyId(0), flotilla.BodyId(1)}
    with pytest.raises(flotilla.InputError):
        world.ray((0, 0, 0), (0, 0, 0), 1)


def test_what_is_known_of_a_body(world, plate):
    shape = world.add_shape(plate, name="extra", mass=2)
    body = world.add_body("extra", name="locked", position=(0, 0, 2), locked=("x", "rz"), force=(0, 0, 1), group="some",
                          friction=0.7)
    assert world.name(body) == "locked" and world.generation(2) == 0
    described = world.description(body)
    assert isinstance(described, flotilla.Body) and described.shape == shape and described.friction == 0.7
    assert described.locked == ("x", "rz") and described.group == "some" and (described.force == (0, 0, 1)).all()
    described.name = "other"  # of the description alone
    assert world.name(body) == "locked"
    world.set_user_data(body, 2**64 - 1)
    assert world.user_data(body) == 2**64 - 1 and world.user_data(world.id(0)) == 0
    assert world.clone().user_data(body) == 2**64 - 1
    world.remove_body(body)
    assert world.generation(2) == 1
    for wrong in (lambda: world.name(body), lambda: world.description(body), lambda: world.user_data(body),
                  lambda: world.set_user_data(body, 1), lambda: world.generation(9), lambda: world.contacts_of(body),
                  lambda: world.add_body("extr"), lambda: world.overlapping("extr", (0, 0, 0))):
        with pytest.raises(flotilla.InputError):
            wrong()
    for wrong in (lambda: world.set_user_data(world.id(0), -1), lambda: world.set_user_data(world.id(0), 2**64)):
        with pytest.raises(TypeError):
            wrong()
    assert world.overlapping("plate", (0, 0, 0.1)) == [world.id(1)]


def test_a_locked_body_falls_along_its_rail_alone(plate):
    scene = flotilla.Scene(settings={"time_step": 0.01})
    scene.add_body(scene.add_shape(plate, mass=2), locked=("x", "y", "rx", "ry", "rz"), force=(5, 0, 2 * 9.8 - 2),
                   torque=(1, 1, 1))
    world = flotilla.World(scene, threads=1)
    world.step(10)
    assert world.velocities[0] == pytest.approx((0, 0, -0.1), abs=1e-12) and not world.angular_velocities.any()


def test_who_may_pass_through_whom(world):
    falls = world.find("falls")
    world.set_group(falls, "loose")
    world.set_group(world.id(0), "ground")
    world.ignore_groups("loose", "ground")
    world.step(20)
    assert world.positions[1, 2] < -1  # through the ground
    with pytest.raises(flotilla.OverlapError):
        world.set_pose(falls, (0, 0, 0))
        world.ignore_groups("loose", "ground", False)
    world.set_pose(falls, (0, 0, 1))
    world.ignore_groups("loose", "ground", ignored=False)
    world.ignore_pair(falls, world.id(0))
    world.set_pose(falls, (0, 0, 0))
    with pytest.raises(flotilla.OverlapError):
        world.ignore_pair(falls, world.id(0), ignored=False)
    world.set_pose(falls, (0, 0, 0.1), (1, 0, 0, 0))
    world.ignore_pair(falls, world.id(0), ignored=False)
    world.set_velocity(falls, (0, 0, 0))
    world.step(40)
    assert world.positions[1, 2] > 0
    for wrong in (lambda: world.set_group(flotilla.BodyId(9), "a"), lambda: world.ignore_pair(falls, falls)):
        with pytest.raises(flotilla.InputError):
            wrong()


def test_a_script_takes_a_body_from_where_it_is(world):
    falls = world.find("falls")
    world.step(3)
    start, now = world.positions[1], world.time
    world.set_script(falls, [(now + 1, start + (0, 0, 2)), (now + 2, (0, 0, 5), (0, 1, 0, 0))])
    assert world.types[1] == "kinematic" and len(world.description(falls).keyframes) >= 3
    world.step(12)  # half a second
    assert world.positions[1] == pytest.approx(start + (0, 0, 1), abs=1e-9)
    world.step(60)
    assert world.positions[1] == pytest.approx((0, 0, 5), abs=1e-9)
    for wrong in ([(0, (0, 0, 1))], [(9, (0, 0, 1)), (9, (0, 0, 2))], [(9,)], [(float("nan"), (0, 0, 1))]):
        with pytest.raises(flotilla.InputError):
            world.set_script(falls, wrong)
    with pytest.raises((TypeError, RuntimeError)):
        world.set_script(falls, 5)


def test_what_touches_a_body_carries_it(world):
    world.step(80)
    touching = world.contacts_of(world.find("falls"))
    assert touching.force == pytest.approx((0, 0, 98), abs=0.98) and touching.torque == pytest.approx(0, abs=0.5)
    assert (touching.contacts == world.contacts).all() and len(touching.contacts) >= 3
    assert world.contacts_of(world.id(0)).force == pytest.approx(-touching.force, abs=1e-12)
    assert world.step(200).sleeping == 1 and world.contacts_of(world.id(1)).contacts["asleep"].all()


def test_memory_in_use(world):
    memory = world.memory
    assert memory.total == memory.shapes + memory.bodies + memory.contacts + memory.pairs
    assert 1000 < memory.total < 1_000_000 and repr(memory).startswith("MemoryUse(shapes=")


def test_clones_go_on_alike_with_other_threads(world):
    world.step(5)
    others = [world.clone(), world.clone(threads=3), world.clone(executor="serial")]
    expected = world.step(10).state_hash
    assert [other.step(10).state_hash for other in others] == 3 * [expected]
    with pytest.raises(flotilla.InputError):
        world.clone(threads=-1)
    with pytest.raises(TypeError):
        world.clone(3)


def test_arrays_outlive_edits(world):
    kept = world.positions
    before = kept.copy()
    for k in range(50):
        world.add_body(1, position=(0, 0, 1 + k))
    del world
    gc.collect()
    assert (kept == before).all()


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda world: pickle.loads(pickle.dumps(world))])
def test_copies_of_edited_worlds_have_their_bits(world, plate, duplicate):
    world.add_body(world.add_shape(plate, mass=1), position=(0, 0, 1))
    world.step(3)
    other = duplicate(world)
    assert world.step(8).state_hash == other.step(8).state_hash
    assert (world.positions == other.positions).all()


def test_snapshots_hold_edits(world, plate):
    empty = world.snapshot()
    shape = world.add_shape(plate, mass=1)
    world.add_body(shape, position=(0, 0, 1))
    world.step(4)
    edited = world.snapshot()
    expected = world.step(4).state_hash
    world.restore(empty)
    assert len(world) == 2
    world.restore(edited)
    assert len(world) == 3 and world.step(4).state_hash == expected


def test_the_scene_of_the_moment_has_what_came_and_not_what_went(world, plate, tmp_path):
    world.add_body(world.add_shape(plate, mass=1), name="new", position=(0, 0, 1))
    world.remove_body(world.find("falls"))
    world.set_gravity((0, 0, -1))
    now = world.scene_now()
    assert [body.name for body in now.bodies] == ["body0", "new"] and len(now.shapes) == 3
    assert (now.gravity == (0, 0, -1)).all() and (now.bodies[1].position == (0, 0, 1)).all()
    assert now.ignored_bodies == [] and now.ignored_groups == []
    report = flotilla.picture(world, tmp_path / "p.png", width=64, height=48, sun_samples=1, sky_samples=4)
    assert report.bodies == 2
    assert numpy.isfinite(world.positions).all()


def test_the_scene_of_the_moment_says_what_may_pass(world):
    world.ignore_pair(world.find("falls"), world.id(0))
    world.set_group(world.find("falls"), "rope")
    world.ignore_groups("rope", "rope")
    now = world.scene_now()
    assert [tuple(sorted(pair)) for pair in now.ignored_bodies] == [("body0", "falls")]
    assert now.ignored_groups == [("rope", "rope")]
    world.ignore_groups("later", "rope")  # of bodies that are yet to come
    assert world.scene_now().ignored_groups == [("rope", "rope")]
    world.step(120)
    again = flotilla.World(world.scene_now(), threads=1)  # where it fell through the plate: no overlap to refuse
    assert again.positions[1, 2] < 0
    world.ignore_pair(world.find("falls"), world.id(0), ignored=False)
    assert world.scene_now().ignored_bodies == []


def test_shapes_without_a_name_get_a_free_one(plate):
    scene = flotilla.Scene()
    scene.add_shape(plate, mass=1)
    world = flotilla.World(scene, threads=1)
    world.record_edits(True)
    assert [world.add_shape(plate, mass=2), world.add_shape(plate, mass=3, name=None)] == [1, 2]
    assert [shape.name for shape in world.scene_now().shapes] == ["shape0", "shape1", "shape2"]
    world.add_body("shape2", name=None, position=(0, 0, 1))
    with pytest.raises(flotilla.InputError, match="one of that name"):
        world.add_shape(plate, mass=1, name="shape1")
    again = flotilla.World(scene, threads=1)
    for edit in world.recorded_edits:
        again.apply(edit)
    assert again.state_hash == world.state_hash and again.scene_now().bodies[0].shape == 2


def test_shapes_are_let_go_of(world, falling, plate):
    kept, gone = world.add_shape(plate, mass=2, name="kept"), world.add_shape(plate, mass=2, name="gone")
    body = world.add_body(gone, position=(0, 0, 9))
    with pytest.raises(flotilla.InputError, match='"gone": body'):
        world.remove_shape("gone")
    world.remove_body(body)
    other = world.add_shape(plate, mass=5, name="other")
    world.remove_shape(gone)
    with pytest.raises(flotilla.InputError, match="was removed"):
        world.add_body(gone)
    with pytest.raises(flotilla.InputError, match="of the scene"):
        world.remove_shape(0)
    world.add_body("other", position=(0, 0, 9), name="last")
    now = world.scene_now()
    assert [shape.name for shape in now.shapes] == [shape.name for shape in falling.shapes] + ["kept", "other"]
    assert now.shapes[now.bodies[-1].shape].name == "other" and flotilla.World(now, threads=1).step().step == 1
    assert world.add_shape(plate, mass=2, name="new") == gone and other == gone + 1
    size = None
    for k in range(40):
        shape = world.add_shape(plate, mass=1, scale=1 + k / 40)
        body = world.add_body(shape, position=(0, 0, 30))
        world.step()
        world.remove_body(body)
        world.remove_shape(shape)
        size = world.memory.shapes if size is None else size
        assert world.memory.shapes == size


def test_a_snapshot_brings_its_shapes(world, falling, plate):
    shape = world.add_shape(plate, mass=2)
    world.add_body(shape, name="of it", position=(0, 0, 9))
    other = flotilla.World(falling, threads=1, snapshot=world.snapshot())
    other.add_body("shape2", position=(0, 0, 19))
    assert [body.shape for body in other.scene_now().bodies] == [0, 1, shape, shape]
    other.add_shape(plate, mass=3, name="later")
    other.restore(world.snapshot())
    with pytest.raises(flotilla.InputError, match="later"):
        other.add_body("later", position=(0, 0, 29))

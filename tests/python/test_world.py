# SPDX-License-Identifier: MIT
import copy
import gc
import pickle
import threading

import numpy
import pytest

import flotilla


def test_a_free_body_falls_by_the_closed_form():
    scene = flotilla.Scene(gravity=(0, 0, -10), settings={"time_step": 0.01})
    triangle = scene.add_shape(([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), surface_density=1)
    scene.add_body(triangle, velocity=(2, 0, 0))
    world = flotilla.World(scene)
    report = world.step(10)
    assert (report.step, world.steps, len(world)) == (10, 10, 1)
    assert world.time == report.time == pytest.approx(0.1, abs=1e-12)
    assert world.velocities == pytest.approx(numpy.array([(2, 0, -1)]), abs=1e-12)
    assert world.positions == pytest.approx(numpy.array([(0.2, 0, -0.05)]), abs=1e-12)
    assert report.momentum == pytest.approx(numpy.array((1, 0, -0.5)), abs=1e-12)


def test_arrays_have_their_shapes_and_say_what_body_says(falling):
    world = flotilla.World(falling)
    world.step(3)
    for name, shape in (("positions", (2, 3)), ("rotations", (2, 4)), ("centers_of_mass", (2, 3)),
                        ("velocities", (2, 3)), ("angular_velocities", (2, 3)), ("turns", (2, 3))):
        array = getattr(world, name)
        assert array.shape == shape and array.dtype == float, name
    body = world.body(1)
    for one, all_of_them in ((body.position, world.positions), (body.rotation, world.rotations),
                             (body.center_of_mass, world.centers_of_mass), (body.velocity, world.velocities),
                             (body.angular_velocity, world.angular_velocities)):
        assert (one == all_of_them[1]).all()
    assert world.names == ["body0", "falls"] and world.types == ["static", "dynamic"]
    assert (world.way(1)[-1].position == body.position).all()
    assert world.way(1)[-1].turn == pytest.approx(world.turns[1], abs=0)


def test_contacts_carry_the_weight(falling):
    world = flotilla.World(falling)
    world.step(80)
    contacts = world.contacts
    assert contacts.dtype.names == ("body_a", "body_b", "point", "normal", "distance", "impulse", "asleep",
                                     "across")
    assert len(contacts) >= 3 and set(contacts["body_a"]) == {0} and set(contacts["body_b"]) == {1}
    assert numpy.linalg.norm(contacts["normal"], axis=1) == pytest.approx(1, abs=1e-12)
    force = contacts["impulse"].sum(axis=0) / world.settings.time_step
    assert force == pytest.approx((0, 0, 10 * 9.8), abs=0.01 * 98)  # a plate of 10 kg at rest
    activity = world.activity
    assert activity.dtype.names == ("contacts", "cluster", "cost") and len(activity) == 2
    assert activity["contacts"][1] == len(contacts)
    assert flotilla.ClusterState(activity["cluster"][1]) in (flotilla.ClusterState.FREE, flotilla.ClusterState.ASLEEP)


def test_arrays_outlive_steps_and_the_world(falling):
    world = flotilla.World(falling)
    world.step(5)
    kept = {name: getattr(world, name)
            for name in ("positions", "rotations", "velocities", "angular_velocities", "contacts")}
    before = {name: array.copy() for name, array in kept.items()}
    world.step(5)
    del world
    gc.collect()
    for name, array in kept.items():
        assert (array == before[name]).all(), name


def test_a_restored_world_goes_on_with_the_same_bits(falling):
    world = flotilla.World(falling)
    world.step(4)
    snapshot = world.snapshot()
    assert isinstance(snapshot, bytes)
    world.step(6)
    expected = world.state_hash
    world.restore(snapshot)
    assert world.steps == 4
    world.step(6)
    assert world.state_hash == expected
    other = flotilla.World(falling, snapshot=snapshot, threads=2)
    other.step(6)
    assert other.state_hash == expected


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda world: pickle.loads(pickle.dumps(world))])
def test_copies_and_pickles_go_on_with_the_same_bits(falling, duplicate):
    world = flotilla.World(falling, executor="serial")
    world.step(4)
    other = duplicate(world)
    assert other.scene_hash == world.scene_hash
    assert world.step(5).state_hash == other.step(5).state_hash


def test_a_snapshot_that_is_damaged_changes_nothing(falling):
    world = flotilla.World(falling)
    world.step(2)
    snapshot, before = world.snapshot(), world.state_hash
    for bad in (b"", snapshot[:-1], bytes([snapshot[0] ^ 1]) + snapshot[1:]):
        with pytest.raises(flotilla.InputError):
            world.restore(bad)
    assert world.state_hash == before
    with pytest.raises(TypeError):
        world.restore("text")


def test_other_threads_run_while_a_world_steps_and_may_not_look_into_it():
    world = flotilla.World(flotilla.make_scene("boats-in-bowl", bodies=60), threads=1)
    steps = 40  # of several milliseconds each once the boats meet
    reports, refused, turns = [], 0, 0
    thread = threading.Thread(target=lambda: reports.append(world.step(steps)))
    thread.start()
    while thread.is_alive():
        turns += 1
        try:
            world.positions
        except flotilla.Error as error:
            assert "another thread" in str(error)
            refused += 1
    thread.join()
    assert refused > 0 and turns > steps
    assert reports[0].step == world.steps == steps
    assert world.positions.shape == (60, 3)


def test_two_worlds_step_side_by_side():
    worlds = [flotilla.World(flotilla.make_scene("stack"), threads=1) for _ in range(2)]
    threads = [threading.Thread(target=world.step, args=(20,)) for world in worlds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert worlds[0].state_hash == worlds[1].state_hash


def test_the_scene_of_the_moment_starts_where_the_world_is(falling):
    world = flotilla.World(falling)
    world.step(6)
    now = world.scene_now()
    assert (now.bodies[1].position == world.positions[1]).all()
    assert flotilla.World(now).velocities[1] == pytest.approx(world.velocities[1], abs=1e-12)
    assert (world.scene().bodies[1].position == (0, 0, 0.1)).all()


def test_the_world_does_not_follow_changes_of_its_scene(falling):
    world = flotilla.World(falling)
    falling.bodies[1].position = (0, 0, 9)
    falling.settings.time_step = 0.5
    assert world.positions[1, 2] == 0.1 and world.settings.time_step == 1 / 24
    world.settings.friction = 0.9  # of a copy
    assert world.settings.friction == 0.1


def test_reports_have_every_field(falling):
    report = flotilla.World(falling).step()
    fields = report.to_dict()
    assert fields["step"] == 1 and fields["warnings"] == flotilla.StepWarning(0)
    assert fields["momentum"].shape == fields["angular_momentum"].shape == (3,)
    assert len(fields["phase_ms"]) == 13 and sum(fields["phase_ms"].values()) > 0
    assert 0 <= fields["state_hash"] < 2**64
    assert repr(report).startswith("StepReport(step=1, time=")


def test_misuse_is_refused(falling):
    world = flotilla.World(falling)
    for wrong in (0, -1):
        with pytest.raises(flotilla.InputError, match="at least 1"):
            world.step(wrong)
    with pytest.raises(TypeError):
        world.step(1.5)
    with pytest.raises(TypeError):
        world.step("2")
    with pytest.raises(flotilla.InputError, match="body 2 does not exist"):
        world.body(2)
    with pytest.raises(flotilla.InputError, match="body 7"):
        world.way(7)
    with pytest.raises(TypeError):
        world.body(-1)
    with pytest.raises(AttributeError):
        world.positions = numpy.zeros((2, 3))
    with pytest.raises(flotilla.InputError, match="threads"):
        flotilla.World(falling, threads=-1)
    with pytest.raises(flotilla.InputError, match="did you mean \"parallel\""):
        flotilla.World(falling, executor="paralel")
    with pytest.raises(TypeError, match="a scene is"):
        flotilla.World(42)
    with pytest.raises(TypeError):
        flotilla.World(falling, 4)  # options are named
    assert world.steps == 0

# SPDX-License-Identifier: MIT
"""Arrays over the memory of a World: they show what it is, cannot be written to, and never outlive what they show."""
import gc
import threading
import weakref

import numpy
import pytest

import flotilla

OF_BODIES = ("positions", "rotations", "centers_of_mass", "velocities")
PINNED = (*(f"{name}_view" for name in OF_BODIES), "angular_momenta_view")


@pytest.fixture
def world(falling):
    return flotilla.World(falling, threads=1)


def test_they_follow_the_world_without_copies(world):
    views = {name: getattr(world, f"{name}_view") for name in OF_BODIES}
    momenta = world.angular_momenta_view
    for edit in (lambda: None, world.step, lambda: world.set_pose(world.id(1), (0, 0, 2), (0, 1, 0, 0)), world.step,
                 lambda: world.set_velocity(world.id(1), (1, 2, 3), (4, 5, 6)), lambda: world.step(50)):
        edit()
        for name, view in views.items():
            copied = getattr(world, name)
            assert view.shape == copied.shape and view.dtype == float and (view == copied).all(), name
            assert numpy.shares_memory(view, getattr(world, f"{name}_view"))
            assert not numpy.shares_memory(view, copied)
    assert momenta.shape == (2, 3) and not momenta[0].any()


def test_angular_momenta_are_those_of_the_report(plate):
    scene = flotilla.Scene(gravity=(0, 0, 0))
    scene.add_body(scene.add_shape(plate, mass=2), angular_velocity=(0.3, 0.2, 0.1))
    world = flotilla.World(scene, threads=1)
    momentum = world.angular_momenta_view
    report = world.step(3)  # a body whose centre of mass rests
    assert momentum[0] == pytest.approx(report.angular_momentum, abs=1e-12) and momentum[0].any()


def test_nobody_writes_to_them(world):
    world.step(60)
    for name in (*PINNED, "contacts_view"):
        view = getattr(world, name)
        assert not view.flags.writeable and not view.flags.owndata
        with pytest.raises(ValueError):
            view[0] = 0
        with pytest.raises(ValueError):
            view.flags.writeable = True
        with pytest.raises(AttributeError):
            setattr(world, name, view)


def test_they_keep_their_world_alive(falling):
    world = flotilla.World(falling, threads=1)
    world.step(3)
    view, part, contacts = world.positions_view, world.rotations_view[1:, 2], world.contacts_view
    expected = view.copy(), part.copy(), contacts.copy()
    gone = weakref.ref(world)
    del world
    gc.collect()
    assert gone() is not None
    assert (view == expected[0]).all() and (part == expected[1]).all() and (contacts == expected[2]).all()
    del view, part
    gc.collect()
    assert gone() is None
    assert (contacts == expected[2]).all()  # these hold their list alone


@pytest.mark.parametrize("name", PINNED)
def test_places_cannot_move_while_one_is_in_use(world, name):
    empty = world.snapshot()
    view = getattr(world, name)
    with pytest.raises(flotilla.InputError, match="uses the memory"):
        world.add_body(1, name="third", position=(0, 0, 3))
    assert len(world) == 2
    world.remove_body(world.id(1))
    assert world.add_body(1, position=(0, 0, 3)).index == 1  # its place was there already
    del view
    world.add_body(1, name="third", position=(0, 0, 5))
    view = getattr(world, name)[:, 1:]  # a part holds it as well
    with pytest.raises(flotilla.InputError, match="number of places"):
        world.restore(empty)
    assert len(world) == 3 and view.shape[0] == 3
    del view
    world.restore(empty)
    assert len(world) == 2


def test_a_world_goes_back_in_place_as_often_as_it_likes(world):
    start, view = world.snapshot(), world.positions_view
    before = view.copy()
    for _ in range(5):
        world.step(4)
        assert (view != before).any()
        world.restore(start)
        assert (view == before).all() and (view == world.positions).all()


def test_they_show_a_cancelled_step_as_if_it_never_was(world):
    world.step(3)
    views = [getattr(world, name) for name in PINNED]
    before = [view.copy() for view in views]
    world.set_observer(lambda phase: phase != "stage7_static_contact")
    with pytest.raises(flotilla.StepCancelled):
        world.step()
    assert all((view == kept).all() for view, kept in zip(views, before))


def test_other_worlds_are_not_bound_by_them(world):
    view = world.positions_view
    other = world.clone()
    other.add_body(1, position=(0, 0, 3))
    other.step(5)
    assert len(other) == 3 and (view == world.positions).all() and world.steps == 0


def test_contacts_stay_what_they_were(world):
    world.step(60)
    view = world.contacts_view
    assert view.dtype == world.contacts.dtype and (view == world.contacts).all() and len(view) >= 3
    assert numpy.shares_memory(view, world.contacts_view)
    kept = view.copy()
    world.apply_impulse(world.id(1), (0, 0, 50), world.centers_of_mass[1])
    world.step(3)
    assert (view == kept).all() and len(world.contacts_view) == 0
    del world
    gc.collect()
    assert (view == kept).all()


def test_a_step_on_another_thread_refuses_new_ones_and_leaves_old_ones():
    world = flotilla.World(flotilla.make_scene("household", bodies=40), threads=1)
    view = world.positions_view
    thread = threading.Thread(target=world.step, args=(20,))
    thread.start()
    refused = 0
    while thread.is_alive():
        try:
            world.velocities_view
        except flotilla.Error as error:
            assert "another thread" in str(error)
            refused += 1
        assert numpy.isfinite(view).all()
    thread.join()
    assert refused > 0 and (view == world.positions).all()

# SPDX-License-Identifier: MIT
"""Whom a World calls in a step: what they may do, and what becomes of a step that they end."""
import copy
import gc
import threading
import weakref

import pytest

import flotilla


class HostFault(BaseException):
    """Of the caller's own: no Exception even."""


@pytest.fixture
def world(falling):
    return flotilla.World(falling, threads=1)


def test_an_observer_is_told_the_stages_in_order(world):
    seen = []
    world.set_observer(seen.append)  # None goes on
    report = world.step(2)
    stages = ["stage1_collisions", "stage3_static_contact", "stage5_failsafe", "stage7_static_contact"]
    assert seen == 2 * stages and set(stages) < set(report.phase_ms)
    world.set_observer(None)
    world.step()
    assert len(seen) == 8


@pytest.mark.parametrize("last", ["stage1_collisions", "stage3_static_contact", "stage5_failsafe",
                                  "stage7_static_contact"])
def test_a_step_that_an_observer_ends_never_was(falling, last):
    world, other = flotilla.World(falling, threads=2), flotilla.World(falling, threads=2)
    for w in (world, other):
        w.step(10)
    before, positions = world.state_hash, world.positions
    world.set_observer(lambda phase: phase != last)
    with pytest.raises(flotilla.StepCancelled, match=f"step 11: .*{last}"):
        world.step(3)

    def throws(phase):
        if phase == last:
            raise HostFault("mine")
    world.set_observer(throws)
    with pytest.raises(HostFault, match="mine"):
        world.step()
    assert world.steps == 10 and world.state_hash == before and (world.positions == positions).all()
    world.set_observer(None)
    assert world.step(5).state_hash == other.step(5).state_hash


def test_an_observer_may_not_use_the_world(world):
    for wrong in (lambda: world.positions, lambda: world.positions_view, lambda: world.step(), lambda: world.wake(world.id(1)),
                  lambda: world.set_observer(None), lambda: world.snapshot()):
        def observer(phase):
            wrong()
        world.set_observer(observer)
        with pytest.raises(flotilla.Error, match="in a step"):
            world.step()
        world.set_observer(None)
    assert world.steps == 0 and world.step().step == 1


def test_what_an_observer_answers_is_yes_or_no(world):
    world.set_observer(lambda phase: "perhaps")
    with pytest.raises(RuntimeError):
        world.step()
    assert world.steps == 0


def test_forces_from_a_callback_are_newtons(plate):
    scene = flotilla.Scene(gravity=(0, 0, 0), settings={"time_step": 0.01})
    scene.add_body(scene.add_shape(plate, mass=2))
    world, given = flotilla.World(scene, threads=1), []

    def push(same):
        given.append(same is world and same.steps == len(given))
        same.apply_force(same.id(0), (4, 0, 0), same.centers_of_mass[0])
    world.set_force_callback(push)
    world.step(10)
    assert given == 10 * [True] and world.velocities[0] == pytest.approx((0.2, 0, 0), abs=1e-12)
    world.set_force_callback(None)
    world.step(10)
    assert world.velocities[0] == pytest.approx((0.2, 0, 0), abs=1e-12)


def test_a_callback_edits_as_its_caller_would(falling):
    def add(world):
        world.add_body(1, position=(0, 0, 1 + world.steps), velocity=(0, 0, -1))
    called, edited = flotilla.World(falling), flotilla.World(falling)
    called.set_force_callback(add)
    for _ in range(6):
        add(edited)
        edited.step()
        called.step()
        assert called.state_hash == edited.state_hash
    start = called.snapshot()
    called.step()
    called.set_force_callback(lambda world: world.restore(start))
    assert called.step().step == 7  # it went back, and then on


def test_what_a_force_callback_throws_leaves_its_edits_alone(world):
    def fails(same):
        same.set_gravity((0, 0, -1))
        raise HostFault("before the step")
    world.set_force_callback(fails)
    with pytest.raises(HostFault, match="before the step"):
        world.step()
    assert world.steps == 0 and world.gravity[2] == -1
    world.set_force_callback(lambda same: same.step())
    with pytest.raises(flotilla.Error, match="in a step already"):
        world.step()
    with pytest.raises(flotilla.InputError):  # errors of the library come out as themselves
        world.set_force_callback(lambda same: same.remove_body(flotilla.BodyId(7)))
        world.step()
    world.set_force_callback(lambda same: same.set_force_callback(None))
    assert world.step(2).step == 2


def test_other_threads_are_refused_while_a_callback_runs(world):
    inside, go_on, refused = threading.Event(), threading.Event(), []

    def waits(same):
        same.positions
        inside.set()
        go_on.wait(30)
    world.set_force_callback(waits)
    thread = threading.Thread(target=world.step)
    thread.start()
    inside.wait(30)
    try:
        world.positions
    except flotilla.Error as error:
        refused.append(str(error))
    go_on.set()
    thread.join()
    assert refused == ["the World is in a step of another thread"] and world.steps == 1


def test_a_log_has_warnings_and_refusals(falling):
    lines = []
    falling.settings.static_iterations, falling.settings.contact_solver = 1, "pgs"
    world = flotilla.World(falling, threads=1)
    world.set_log(lines.append)
    world.step(80)
    assert any(line.startswith("step ") and "tolerance" in line for line in lines)
    lines.clear()
    with pytest.raises(flotilla.InputError):
        world.set_material(world.id(1), -1, 0)
    assert len(lines) == 1 and lines[0].startswith("refused: ")
    world.set_log(None)
    with pytest.raises(flotilla.InputError):
        world.set_material(world.id(1), -1, 0)
    assert len(lines) == 1

    def throws(line):
        raise HostFault(line)
    world.set_log(throws)
    before = world.state_hash
    with pytest.raises(HostFault, match="refused"):
        world.set_material(world.id(1), -1, 0)
    world.set_log(None)
    assert world.state_hash == before and world.step().step == 81


def test_callbacks_must_be_callable(world):
    for name in ("set_force_callback", "set_observer", "set_log"):
        with pytest.raises(TypeError, match="callable"):
            getattr(world, name)(42)
        with pytest.raises(TypeError):
            getattr(world, name)()
    assert world.step().step == 1


def test_copies_have_no_callbacks(world):
    seen = []
    world.set_observer(seen.append)
    world.set_force_callback(lambda same: seen.append("force"))
    for other in (copy.copy(world), world.clone()):
        other.step()
    assert seen == []


def test_a_callback_that_holds_its_world_is_collected_with_it(falling):
    class Owner:
        def __init__(self):
            self.world = flotilla.World(falling, threads=1)
            self.world.set_force_callback(self.push)
            self.world.set_observer(lambda phase: self is not None)
            self.world.set_log(lambda line: self)

        def push(self, world):
            assert world is self.world
    owner = Owner()
    owner.world.step()
    gone = weakref.ref(owner), weakref.ref(owner.world)
    del owner
    gc.collect()
    assert gone[0]() is None and gone[1]() is None

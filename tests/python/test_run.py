# SPDX-License-Identifier: MIT
"""Runs, and all that can be done with their folders."""
import os
import threading

import numpy
import pytest

import flotilla

STEPS = 12


@pytest.fixture
def folder(falling, tmp_path):
    totals = flotilla.run(falling, tmp_path / "run", steps=STEPS, trace=tmp_path / "trace.json.gz",
                          contacts=tmp_path / "contacts.csv")
    assert totals.complete and totals.steps == totals.last.step == STEPS and totals.bodies == 2
    return tmp_path / "run"


def test_frames_are_the_worlds_poses(falling, folder):
    frames = flotilla.RunFolder(folder).frames()
    assert len(frames) == STEPS + 1 and frames.bodies == ["body0", "falls"]
    assert frames.positions.shape == frames.velocities.shape == frames.angular_velocities.shape == (STEPS + 1, 2, 3)
    assert frames.rotations.shape == (STEPS + 1, 2, 4)
    assert frames.contacts.shape == frames.cluster.shape == frames.cost.shape == (STEPS + 1, 2)
    assert list(frames.step) == list(frames.frame) == list(range(STEPS + 1))
    world = flotilla.World(falling)
    for k in range(STEPS + 1):
        assert frames.time[k] == world.time
        assert (frames.positions[k] == world.positions).all() and (frames.rotations[k] == world.rotations).all()
        assert (frames.velocities[k] == world.velocities).all()
        assert (frames.angular_velocities[k] == world.angular_velocities).all()
        world.step()


def test_a_range_of_frames(folder):
    frames = flotilla.read_frames(folder, first=1, last=9, every=4)
    assert list(frames.frame) == [1, 5, 9]
    for wrong in ({"first": 99}, {"every": 0}):
        with pytest.raises(flotilla.InputError):
            flotilla.read_frames(folder, **wrong)


def test_frames_outlive_their_folder(folder):
    positions = flotilla.read_frames(folder).positions
    copy = positions.copy()
    for file in folder.iterdir():
        file.unlink()
    assert (positions == copy).all()
    with pytest.raises(flotilla.IoError):
        flotilla.RunFolder(folder)


def test_steps_are_columns(falling, folder):
    steps = flotilla.RunFolder(folder).steps()
    for name, kind in (("step", numpy.int64), ("time", numpy.float64), ("contacts", numpy.int64),
                       ("state_hash", numpy.uint64)):
        assert steps[name].dtype == kind
    assert all(column.shape == (STEPS,) for column in steps.values())
    world = flotilla.World(falling)
    reports = [world.step() for _ in range(STEPS)]
    for name in ("energy", "min_distance", "state_hash", "pairs", "warnings", "lift", "residual"):
        assert list(steps[name]) == [getattr(report, name) for report in reports], name
    assert list(steps["momentum_z"]) == [report.momentum[2] for report in reports]
    float_columns = {name for name, column in steps.items() if column.dtype == numpy.float64}
    for name in float_columns & set(reports[0].to_dict()):
        assert isinstance(getattr(reports[0], name), float), name
    for name in set(steps) - float_columns:
        assert isinstance(getattr(reports[0], name), int), name


def test_a_torn_row_is_left_out(folder):
    file = folder / "steps.csv"
    file.write_text(file.read_text()[:-5])
    assert len(flotilla.read_steps(folder)["step"]) == STEPS - 1
    file.write_text("step,time\n1\n")
    with pytest.raises(flotilla.IoError, match="fields"):
        flotilla.read_steps(folder)


def test_verify_proves_the_run_and_finds_a_planted_fault(falling, folder, tmp_path):
    progress = []
    report = flotilla.verify(folder, progress=progress.append)
    assert report.proved and report.frames == STEPS + 1 and report.motions == STEPS and progress[-1] == 1
    scene, poses = tmp_path / "scene.json", tmp_path / "poses.csv"
    flotilla.write_scene(falling, scene)
    flotilla.export_run(folder, "csv", poses)
    assert flotilla.verify(scene, poses).proved
    rows = poses.read_text().splitlines()
    fields = rows[-1].split(",")
    fields[4:7] = "0.5", "0.5", "-0.5"  # through the ground
    poses.write_text("\n".join([*rows[:-1], ",".join(fields)]) + "\n")
    fault = flotilla.verify(scene, poses, motion="always")
    assert not fault.proved and fault.faults[0].kind in ("crossing", "intersection") and str(fault.faults[0])
    with pytest.raises(flotilla.InputError, match="motion"):
        flotilla.verify(folder, motion="sometimes")
    with pytest.raises(flotilla.IoError):
        flotilla.verify(tmp_path / "nowhere")


def test_exports_reports_and_summaries(folder, tmp_path):
    for name in ("csv", "glb", "usd"):
        output = tmp_path / f"out.{name}"
        flotilla.export_run(folder, name, output)
        frames, size = flotilla.estimate_export(folder, name)
        assert frames == STEPS + 1 and output.stat().st_size > 0 and size > 0
        if name == "csv":  # of so small a run the other formats are mostly their headers
            assert 2 / 3 < size / output.stat().st_size < 4 / 3
    with pytest.raises(flotilla.InputError, match="did you mean"):
        flotilla.export_run(folder, "cvs", tmp_path / "x")
    page = flotilla.write_report(folder, tmp_path / "page.html", verify=True)
    assert page.frames == STEPS + 1 and page.verification.proved
    assert page.bytes == (tmp_path / "page.html").stat().st_size
    summary = flotilla.summarize_run(folder)
    assert (summary.status, summary.frames, summary.last_step, summary.problems) == ("complete", STEPS + 1, STEPS, [])
    assert summary.command_line == ["flotilla.run"]


def test_traces_and_contacts(folder):
    trace = flotilla.analyze_trace([folder.parent / "trace.json.gz"], cores=[1, 4])
    assert trace.steps == STEPS and trace.cores == [1, 4] and len(trace.total.speedup) == 2
    assert trace.total.work_ms > 0 and trace.rows
    assert (folder.parent / "contacts.csv").read_text().startswith("step,")


def test_pictures_of_everything(falling, folder, tmp_path):
    world = flotilla.World(falling)
    world.step(STEPS)
    small = {"width": 64, "height": 48, "sun_samples": 1, "sky_samples": 4}
    file = tmp_path / "scene.json"
    flotilla.write_scene(falling, file)
    pictures = []
    for k, source in enumerate((world, folder, falling, file)):
        report = flotilla.picture(source, tmp_path / f"{k}.png", **small)
        assert report.bodies == 2
        pictures.append((tmp_path / f"{k}.png").read_bytes())
    assert pictures[0] == pictures[1] != pictures[2] == pictures[3]
    assert flotilla.picture(folder, tmp_path / "f.png", frame=3, **small).time == pytest.approx(3 / 24, abs=1e-12)
    with pytest.raises(flotilla.InputError, match="width"):
        flotilla.picture(world, tmp_path / "x.png", width=1)
    with pytest.raises(TypeError):
        flotilla.picture(world, tmp_path / "x.png", breadth=100)


def test_pictures_of_steps(falling, folder, tmp_path):
    world = flotilla.World(falling)
    world.step(STEPS)
    small = {"width": 64, "height": 48, "sun_samples": 1, "sky_samples": 4}
    file, steps = tmp_path / "scene.json", []
    flotilla.write_scene(falling, file)
    reports = [flotilla.write_step_picture(world, tmp_path / "0.png", **small),
               flotilla.write_step_picture(folder, tmp_path / "1.png", STEPS, **small),
               flotilla.write_step_picture(file, tmp_path / "2.png", step=STEPS, **small,
                                           progress=lambda done, total: steps.append((done, total)))]
    assert steps == [(k + 1, STEPS) for k in range(STEPS)]
    for k, r in enumerate(reports):
        assert (r.step, r.bodies, r.contacts) == (STEPS, 2, len(world.contacts))
        assert (tmp_path / f"{k}.png").read_bytes() == (tmp_path / "0.png").read_bytes()
    of_world = reports[0]
    pairs = of_world.loaded_pairs + of_world.sleeping_pairs + of_world.touching_pairs + of_world.near_pairs
    assert pairs == (of_world.proved_by_query + of_world.proved_by_boxes + of_world.proved_by_cluster
                     + of_world.proved_by_rest + of_world.not_proved)
    flotilla.write_step_picture(world, tmp_path / "proofs.png", lines="proofs", **small)
    with pytest.raises(flotilla.InputError, match="lines"):
        flotilla.write_step_picture(world, tmp_path / "x.png", lines="hints")
    for arguments, options in (((world, tmp_path / "x.png", 3), {}), ((file, tmp_path / "x.png"), {}),
                               ((world, tmp_path / "x.png"), {"breadth": 100}),
                               ((world, tmp_path / "x.png"), {"width": "wide"})):
        with pytest.raises(TypeError):
            flotilla.write_step_picture(*arguments, **options)


def test_runs_are_compared(falling, folder, tmp_path):
    flotilla.run(falling, tmp_path / "same", steps=STEPS, executor="serial")
    assert flotilla.compare_runs(folder, tmp_path / "same").same_bits
    falling.bodies[1].velocity = (0, 0, 1e-9)
    flotilla.run(falling, tmp_path / "other", steps=STEPS)
    report = flotilla.compare_runs(folder, tmp_path / "other")
    assert not report.same_bits and not report.promise_broken
    assert report.first_state.step == 1 and report.first_frame.first.name == "falls"


def test_runs_that_were_resumed_have_the_same_bits(tmp_path):
    scene = flotilla.make_scene("household", bodies=20, seed=2)
    flotilla.run(scene, tmp_path / "whole", steps=40)
    flotilla.run(scene, tmp_path / "resumed", steps=40, after_step=lambda report: report.step < 29)
    flotilla.run(scene, tmp_path / "resumed", steps=40, resume=True)
    report = flotilla.compare_runs(tmp_path / "whole", tmp_path / "resumed")
    assert report.same_bits and report.first_step is None and report.steps_compared == 40
    if report.first_work is not None:  # pairs known to be apart are not examined
        assert [value.name for value in report.first_work.columns] == ["pairs"]


@pytest.mark.parametrize("kind", ["csv", "glb", "usd", "report"])
def test_output_goes_where_links_and_pipes_lead(folder, tmp_path, kind):
    def write(path):
        if kind == "report":
            flotilla.write_report(folder, path)
        else:
            flotilla.export_run(folder, kind, path)

    plain, target, link, pipe = (tmp_path / "out" / name for name in ("plain", "target", "link", "pipe"))
    plain.parent.mkdir()
    write(plain)
    link.symlink_to("target")
    write(link)
    assert link.is_symlink() and target.read_bytes() == plain.read_bytes()
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    write(pipe)
    reader.join()
    assert pipe.is_fifo() and read == [plain.read_bytes()]
    assert sorted(file.name for file in plain.parent.iterdir()) == ["link", "pipe", "plain", "target"]


def test_callbacks_end_runs_and_their_errors_come_out(falling, tmp_path):
    totals = flotilla.run(falling, steps=9, after_step=lambda report: None)
    assert totals.complete
    seen = []
    totals = flotilla.run(falling, steps=9, after_step=lambda report: seen.append(report.step) or len(seen) < 4)
    assert not totals.complete and seen == [1, 2, 3, 4]

    def fails(report):
        raise KeyError("of the caller")

    with pytest.raises(KeyError, match="of the caller"):
        flotilla.run(falling, tmp_path / "run", steps=9, after_step=fails)
    notes = []
    flotilla.run(falling, tmp_path / "fresh", steps=1, resume=True, note=notes.append)
    assert any("no run to resume" in text for text in notes)


def test_misuse_is_refused(falling, folder, tmp_path):
    with pytest.raises(flotilla.InputError, match="not both"):
        flotilla.run(falling, steps=1, duration=1)
    with pytest.raises(flotilla.InputError, match="steps"):
        flotilla.run(falling, steps=-1)
    for duration in (-1, float("nan"), float("inf")):
        with pytest.raises(flotilla.InputError, match="duration"):
            flotilla.run(falling, duration=duration)
    with pytest.raises(flotilla.InputError):
        flotilla.run(falling, folder, steps=1)  # holds a run already
    with pytest.raises(flotilla.InputError, match="frame_every"):
        flotilla.run(falling, tmp_path / "x", steps=1, frame_every=0)
    with pytest.raises(flotilla.IoError):
        flotilla.read_frames(tmp_path)
    with pytest.raises(flotilla.IoError):
        flotilla.evaluate_ccd_file(tmp_path / "none.csv")


def test_files_of_queries(tmp_path):
    with pytest.raises(flotilla.InputError, match="method"):
        flotilla.evaluate_ccd_file(tmp_path / "none.csv", method="exact")

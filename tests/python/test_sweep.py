# SPDX-License-Identifier: MIT
import pytest

import flotilla


def test_a_campaign_compares_its_points(tmp_path):
    done = []
    report = flotilla.sweep("stack", tmp_path, vary={"preset": ["preview", "balanced"]}, bodies=3, duration=0.2,
                            reference="accurate", metrics=["height", "residual"],
                            progress=lambda *state: done.append(state))
    assert report.exit_code == 0 and report.problems == [] and report.members == report.complete == 3
    assert [point.label for point in report.points][:2] == ["preset=preview", "preset=balanced"]
    assert [metric.name for metric in report.metrics] == ["height", "residual"]
    assert report.points[0].cost.mean > 0 and report.points[0].errors[0].starts == 1
    assert done and (tmp_path / "sweep.html").exists()
    again = flotilla.sweep("stack", tmp_path, vary={"preset": ["preview", "balanced"]}, bodies=3, duration=0.2,
                           reference="accurate", metrics=["height", "residual"], resume=True,
                           run=lambda member: pytest.fail("all members are complete"))
    assert again.complete == 3


def test_members_may_be_run_otherwise(tmp_path):
    def run(member):
        totals = flotilla.run(member.scene, member.folder, steps=member.steps, preset=member.preset,
                              settings=member.settings, frame_every=member.frame_every,
                              threads=member.threads, resume=True)
        return 0 if totals.complete else 6, "", 0.0

    report = flotilla.sweep("stack", tmp_path, vary={"friction": [0.1, 0.5]}, bodies=3, steps=4, run=run)
    assert report.complete == 2 and report.axes[0].values == ["0.1", "0.5"]


def test_failures_are_the_members_own(tmp_path):
    report = flotilla.sweep("stack", tmp_path, vary={"friction": [0.1, 0.5]}, bodies=3, steps=4,
                            run=lambda member: (5, "the disk is full", 0.0))
    assert report.complete == 0 and report.exit_code == 5 and "the disk is full" in report.problems[0]

    def fails(member):
        raise KeyError("of the caller")

    with pytest.raises(KeyError, match="of the caller"):
        flotilla.sweep("stack", tmp_path, vary={"friction": [0.1]}, bodies=3, steps=4, overwrite=True, run=fails)


def test_misuse_is_refused_before_the_first_run(tmp_path):
    with pytest.raises(flotilla.InputError, match="frction"):
        flotilla.sweep("stack", tmp_path, vary={"frction": [1]})
    with pytest.raises(flotilla.InputError):
        flotilla.sweep("stak", tmp_path, vary={"friction": [1]})
    assert not list(tmp_path.iterdir())
    assert {"height", "position"} <= {metric.name for metric in flotilla.sweep_metrics()}

"""What the topology algorithms make of a plan."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from jfto.analysis.comparison import FORM_NAMES, compare
from jfto.pipeline.run import Run
from jfto_msgs_py.records.site import GroundStation


def test_the_plans_form_is_ours_and_every_form_is_there(tiny_run: tuple[Path, Run]) -> None:
    """The form that is flown stands last; the elastic one lists no less than the literal one."""
    plan = tiny_run[1].plan
    for form, name in FORM_NAMES.items():
        found = compare(replace(plan, topology=form), 5)
        assert found.ours.name == name
        assert found.results[-1] is found.ours
        assert {one.name for one in found.results} == {
            "MTP",
            "A-LMST",
            "CPAPO",
            *FORM_NAMES.values(),
        }
    by_name = {one.name: one for one in found.results}
    literal, elastic = by_name["C-TOP literal"], by_name["C-TOP elastic"]
    assert elastic.active.mean_throughput_mbps >= literal.active.mean_throughput_mbps
    assert (by_name["C-TOP closed"].heard >= literal.heard).all()
    assert elastic.degree.max() <= plan.k_min + plan.delta


def test_the_rate_to_the_ground_is_told_where_there_is_a_station(
    tiny_run: tuple[Path, Run],
) -> None:
    """A station amid the fleet is within everybody's way; one far off makes all deaf."""
    plan = tiny_run[1].plan
    assert compare(plan, 5).ours.ground is None
    amid = GroundStation(tuple(plan.positions_m.mean(axis=(0, 1))), 30.0)
    near = compare(replace(plan, ground_stations=(amid,)), 5).ours.ground
    assert near is not None
    assert near.deaf_share == 0
    assert (near.own_time_bps > 0).all()
    assert (near.one_band_bps <= near.own_time_bps * (1 + 1e-6)).all()
    far = GroundStation((1e6, 0.0, 0.0), 30.0)
    none = compare(replace(plan, ground_stations=(far,)), 5).ours.ground
    assert none is not None
    assert none.deaf.all()
    assert np.array_equal(none.own_time_bps, np.zeros(plan.slots.count + 1))
    both = compare(replace(plan, ground_stations=(far, amid)), 5).ours.ground
    assert both is not None
    np.testing.assert_allclose(both.own_time_bps, near.own_time_bps, rtol=1e-6)

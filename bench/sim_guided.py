"""Stream the recorded GUIDED references to the simulator and print how it follows them.

Usage: python bench/sim_guided.py TIMING_FOLDER
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink
from support.pilot import Pilot

# fields ignored: position 7, velocity 56, acceleration 448, yaw 1024, yaw rate 2048
MASKS = {"P": 0xFF8, "PV": 0xFC0, "PVA": 0xE00, "V": 0xFC7, "VA": 0xE07}
MASKS = {name: (mask | 0xC00) & ~0x200 for name, mask in MASKS.items()}


def fly(table: np.ndarray, fields: str, rate_hz: float = 10.0) -> np.ndarray:
    """Returns (north, east, up) of the vehicle at the reference's times, (T, 3)."""
    vehicle = Vehicle(VehicleConfig(home_lat_deg=46.6, home_lon_deg=8.5, home_alt_m=488.0))
    pilot = Pilot(vehicle)
    pilot.take_off(float(table["ref_u"][0]))
    pilot.run(5.0)
    times, begin, out = table["t_s"], vehicle.time_s, []
    names = ("ref_n", "ref_e", "ref_u", "ref_vn", "ref_ve", "ref_vu", "ref_an", "ref_ae", "ref_au")
    sent = -1.0
    for now in times:
        while vehicle.time_s - begin < now - 1e-6:
            elapsed = vehicle.time_s - begin
            if elapsed >= sent + 1.0 / rate_hz - 1e-6:
                sent = elapsed
                n, e, u, vn, ve, vu, an, ae, au = (
                    float(np.interp(elapsed, times, table[name])) for name in names
                )
                pilot.send(
                    mavlink.MAVLink_set_position_target_local_ned_message(
                        0, 1, 1, 1, MASKS[fields], n, e, -u, vn, ve, -vu, an, ae, -au, 0.0, 0.0
                    )
                )
            pilot.run(0.02)
        east, north, up = vehicle.body.position_m
        out.append((north, east, up))
    return np.array(out)


def main() -> None:
    """Stream, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    args = parser.parse_args()
    print("error to the reference, rms / max in m; distance between the two flights, rms in m")
    print(f"{'fields':6} {'measured':>20} {'simulated':>20} {'between':>10}")
    for fields in MASKS:
        table = np.genfromtxt(args.folder / f"guided_{fields}_10hz.csv", delimiter=",", names=True)
        flown = fly(table, fields)
        reference = np.stack([table["ref_n"], table["ref_e"]], -1)
        truth = np.stack([table["true_n"], table["true_e"]], -1)
        cells = []
        for track in (truth, flown[:, :2]):
            error = np.linalg.norm(track - reference, axis=-1)
            cells.append(f"{math.sqrt(np.mean(error**2)):6.2f} / {error.max():5.2f}")
        apart = math.sqrt(np.mean(np.sum((flown[:, :2] - truth) ** 2, -1)))
        print(f"{fields:6} {cells[0]:>20} {cells[1]:>20} {apart:10.2f}", flush=True)


if __name__ == "__main__":
    main()

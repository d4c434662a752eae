"""What a raster's heights are: their unit, and what they are measured from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pyproj import CRS

from jfto_msgs_py.errors import TerrainError
from jfto_world.terrain.placing import MODERN_ELLIPSOIDS
from jfto_world.terrain.products import Product

_US_FOOT_M = 1200 / 3937
# Names of units as GDAL, PROJ and people write them, in metres.
UNITS_M = {
    **dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0),
    **dict.fromkeys(("dm", "decimetre", "decimeter"), 0.1),
    **dict.fromkeys(("cm", "centimetre", "centimeter"), 0.01),
    **dict.fromkeys(("mm", "millimetre", "millimeter"), 0.001),
    **dict.fromkeys(("ft", "foot", "feet", "international foot"), 0.3048),
    **dict.fromkeys(
        ("us_ft", "us-ft", "ftus", "us survey foot", "us survey feet", "foot_us"), _US_FOOT_M
    ),
}
ELLIPSOID, SEA_LEVEL = "ellipsoid", "sea_level"
_NO_DATUM = "mean sea level (the file names no vertical datum)"
_SAME = 1e-9


@dataclass(frozen=True)
class DeclaredHeights:
    """What a scenario says of the heights where the file does not; "" says nothing.

    `unit` is a key of UNITS_M; `datum` is "ellipsoid", "sea_level" or the name of a geoid.
    """

    unit: str = ""
    datum: str = ""


@dataclass(frozen=True)
class HeightReference:
    """Metres per unit of height, name of the datum, and whether that is the ellipsoid.

    `notes` say what was taken for granted.
    """

    to_metres: float
    datum: str
    above_ellipsoid: bool
    notes: tuple[str, ...] = ()


def height_reference(
    band_unit: str | None,
    crs: CRS,
    path: Path,
    declared: DeclaredHeights,
    product: Product | None,
) -> HeightReference:
    """The reference of a band in a CRS, from the file or, where that is silent, as declared.

    `product` is what the file's name tells, None where it tells nothing. Raises TerrainError where
    unit or datum are unknown, contradict themselves or contradict what is declared.
    """
    vertical = crs.sub_crs_list[1] if crs.is_compound else None
    to_metres = _to_metres(band_unit, crs, vertical, path, declared.unit)
    own_datum, own_ellipsoid = _datum(crs, vertical, path)
    if own_ellipsoid or declared.datum.lower() == ELLIPSOID:
        _need_modern_ellipsoid(crs, path)
    if not declared.datum:
        if own_datum:
            return HeightReference(to_metres, own_datum, own_ellipsoid)
        if product is not None:
            return HeightReference(to_metres, product.datum, product.above_ellipsoid)
        return HeightReference(to_metres, _NO_DATUM, above_ellipsoid=False, notes=(_silent(path),))
    ellipsoid = declared.datum.lower() == ELLIPSOID
    if own_datum and (ellipsoid != own_ellipsoid or not _agree(own_datum, declared.datum)):
        raise TerrainError(
            f"{path} has heights above {own_datum}, but terrain.vertical_datum declares "
            f"{declared.datum}. Leave that key out, or correct the file (gdal_edit.py -a_srs)."
        )
    if own_datum:
        return HeightReference(to_metres, own_datum, own_ellipsoid)
    names = {ELLIPSOID: f"ellipsoid of {_horizontal_name(crs)}", SEA_LEVEL: "mean sea level"}
    name = names.get(declared.datum.lower(), f"{declared.datum} (mean sea level)")
    return HeightReference(to_metres, f"{name} (as declared)", ellipsoid)


def _need_modern_ellipsoid(crs: CRS, path: Path) -> None:
    """Refuse heights above an old ellipsoid, which lies up to hundreds of metres elsewhere."""
    ellipsoid = crs.ellipsoid.name if crs.ellipsoid else "unknown"
    if not MODERN_ELLIPSOIDS.search(ellipsoid):
        raise TerrainError(
            f"{path} has heights above the ellipsoid {ellipsoid}, for which no geoid is known. "
            "Convert it with gdalwarp -t_srs EPSG:4979, or to heights above sea level."
        )


def _silent(path: Path) -> str:
    return (
        f"{path} does not say what its heights are measured from: they are taken for heights above "
        "sea level. If they are above the ellipsoid, as GNSS and photogrammetry give them, "
        "altitudes are wrong by up to 100 m; declare terrain.vertical_datum"
    )


def _agree(own: str, declared: str) -> bool:
    """Whether two datums of one sort may be the same: a named geoid must be the file's."""
    return declared.lower() in (ELLIPSOID, SEA_LEVEL) or declared.lower() in own.lower()


def _datum(crs: CRS, vertical: CRS | None, path: Path) -> tuple[str, bool]:
    """Name of the datum of the file's own heights, "" for none, and whether it is the ellipsoid."""
    if vertical is None:
        threefold = len(crs.axis_info) == 3
        return (f"ellipsoid of {crs.name}", True) if threefold else ("", False)
    if vertical.axis_info[0].direction.lower() == "down":
        raise TerrainError(
            f"{path} holds depths ({vertical.name}), not heights. Turn their sign (gdal_calc.py), "
            "or name an elevation model."
        )
    # Esri writes heights above the ellipsoid as a vertical system on a horizontal datum, "D_…".
    datum = vertical.datum.name if vertical.datum else ""
    ellipsoid = "ellipsoid" in vertical.name.lower() or datum.startswith("D_")
    return vertical.name, ellipsoid


def _to_metres(
    band_unit: str | None, crs: CRS, vertical: CRS | None, path: Path, declared: str
) -> float:
    said: dict[str, float] = {}
    if band_unit and band_unit.strip():
        name = band_unit.strip()
        if name.lower() in UNITS_M:
            said[f"the band's unit {name!r}"] = UNITS_M[name.lower()]
        elif not declared:
            raise TerrainError(
                f"{path} has heights in {name[:30]!r}, a unit that is not known. Declare it with "
                f"terrain.vertical_unit ({', '.join(_CHOICES)}), or convert the file to metres."
            )
    axis = vertical or (crs if len(crs.axis_info) == 3 else None)
    if axis is not None:
        axes = axis.axis_info
        said[f"the vertical system {axis.name!r}"] = axes[-1].unit_conversion_factor
    if declared:
        said["terrain.vertical_unit"] = UNITS_M[declared]
    if not said:
        _need_metric_map(crs, path)
        return 1.0
    first = next(iter(said.values()))
    if any(abs(other / first - 1) > _SAME for other in said.values()):
        told = ", ".join(f"{name} is {value:.7g} m" for name, value in said.items())
        raise TerrainError(
            f"{path} has contradicting units of height: {told}. Correct the file "
            "(gdal_edit.py -units), or what is declared."
        )
    return first


_CHOICES = ("m", "dm", "cm", "ft", "us_ft")


def _need_metric_map(crs: CRS, path: Path) -> None:
    """Refuse heights without a unit where the map is in feet: they are as likely in feet."""
    horizontal = crs.sub_crs_list[0] if crs.is_compound else crs
    unit = horizontal.axis_info[0] if horizontal.axis_info else None
    if horizontal.is_projected and unit and abs(unit.unit_conversion_factor - 1) > _SAME:
        raise TerrainError(
            f"{path} names no unit for its heights, but its map ({horizontal.name}) is in "
            f"{unit.unit_name}: heights may be in feet or in metres. Declare terrain.vertical_unit "
            "(us_ft, ft or m)."
        )


def _horizontal_name(crs: CRS) -> str:
    base = crs.geodetic_crs
    return base.name if base is not None else crs.name

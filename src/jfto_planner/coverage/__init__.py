"""Where to take photos, and what they show."""

from jfto_planner.coverage.camera import Camera
from jfto_planner.coverage.certificate import CoverageCertificate, certify_coverage
from jfto_planner.coverage.plan_coverage import Coverage, CoverageNote, plan_coverage
from jfto_planner.coverage.settings import CoverageSettings

__all__ = [
    "Camera",
    "Coverage",
    "CoverageCertificate",
    "CoverageNote",
    "CoverageSettings",
    "certify_coverage",
    "plan_coverage",
]

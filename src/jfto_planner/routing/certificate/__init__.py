"""Independent check of a plan: positions and routes in, violations out."""

from jfto_planner.routing.certificate.certify import certify, plan_instants
from jfto_planner.routing.certificate.ground import GroundRule
from jfto_planner.routing.certificate.instants import Instants
from jfto_planner.routing.certificate.routes import fly

__all__ = ["GroundRule", "Instants", "certify", "fly", "plan_instants"]

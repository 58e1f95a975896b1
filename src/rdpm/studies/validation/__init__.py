"""Published cases against this build."""

from rdpm.studies.validation.registry import CASES, validate
from rdpm.studies.validation.result import Chart, Curve, Row

__all__ = ["CASES", "Chart", "Curve", "Row", "validate"]

"""How bodies touch: the law and one of four ways to give its parameters."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import StrictBool, model_validator

from rdpm.config.fields import Model, choice, number, whole
from rdpm.config.rule import RuleError, listed

__all__ = ["DEFAULT_CONTACT", "Contact"]

DEFAULT_CONTACT = {"contact_steps": 8.0, "restitution": 0.9}

_RESTITUTION = 0.9  # of most hard spheres within 10 %, where only the overlap is designed
_TANGENTIAL_RATIO = 2 / 7  # a homogeneous sphere then has equal normal and tangential contact periods

Way = Literal["contact-steps", "stiffness-damping", "stiffness-restitution", "max-overlap"]

_WAYS: dict[frozenset[str], Way] = {
    frozenset({"contact_steps", "restitution"}): "contact-steps",
    frozenset({"stiffness", "damping"}): "stiffness-damping",
    frozenset({"stiffness", "restitution"}): "stiffness-restitution",
    frozenset({"max_overlap", "impact_speed", "restitution"}): "max-overlap",
}
_PARAMETERS = ("contact_steps", "restitution", "stiffness", "damping", "max_overlap", "impact_speed")


class Contact(Model):
    """Contacts between bodies, and of bodies with walls.

    Attributes
    ----------
    model : "soft-sphere"
        Linear spring and dashpot; the only law in this version.
    contact_steps : float, [-], optional
        Duration of every contact in fluid steps, 4 to 1000; with `restitution`.
    restitution : float, [-], optional
        Dry normal coefficient of restitution, 0 < e <= 1.
    stiffness : float, [N/m], optional
        Normal stiffness of all pairs; with `damping` or `restitution`.
    damping : float, [N s/m], optional
        Normal damping of all pairs, >= 0.
    max_overlap : float, [-], optional
        Largest overlap over the smaller diameter, 0 to 0.5, at `impact_speed`; `restitution` is 0.9 when
        left out.
    impact_speed : float, [m/s], optional
        > 0.
    ending : "zero-force" or "zero-overlap"
        Where a contact ends; at zero overlap the force is briefly attractive.
    friction : float, [-]
        Coulomb's coefficient, >= 0.
    tangential_ratio : float, [-], optional
        Tangential over normal stiffness, 0 to 1; 2/7 when `poisson_ratio` is left out too.
    poisson_ratio : float, [-], optional
        0 to 0.5; instead of `tangential_ratio`.
    lubrication : bool
        Whether the squeeze film thinner than the grid resolves is modelled; with a fluid only.
    lubrication_roughness : float, [-]
        Gap over radius below which the film no longer thins, 0 < value <= 0.1.
    overlap_limit : float, [-]
        Overlap over the smaller diameter at which a run stops, 0 < value <= 0.5.
    substeps : int, optional
        Contact steps in a fluid step; chosen from the contact time when left out.
    """

    model: Annotated[
        Literal["soft-sphere"], choice("soft-sphere", later=("hertz", "hard-sphere", "repulsive"))
    ] = "soft-sphere"
    contact_steps: Annotated[float | None, number("", least=4.0, most=1000.0)] = None
    restitution: Annotated[float | None, number("", above=0.0, most=1.0)] = None
    stiffness: Annotated[float | None, number("N/m", above=0.0)] = None
    damping: Annotated[float | None, number("N s/m", least=0.0)] = None
    max_overlap: Annotated[float | None, number("", above=0.0, most=0.5)] = None
    impact_speed: Annotated[float | None, number("m/s", above=0.0)] = None
    ending: Annotated[Literal["zero-force", "zero-overlap"], choice("zero-force", "zero-overlap")] = (
        "zero-force"
    )
    friction: Annotated[float, number("", least=0.0)] = 0.0
    tangential_ratio: Annotated[float | None, number("", above=0.0, most=1.0)] = None
    poisson_ratio: Annotated[float | None, number("", least=0.0, most=0.5)] = None
    lubrication: StrictBool = True
    lubrication_roughness: Annotated[float, number("", above=0.0, most=0.1)] = 1e-3
    overlap_limit: Annotated[float, number("", above=0.0, most=0.5)] = 0.2
    substeps: Annotated[int | None, whole(1, 100_000)] = None

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, raw: Any) -> Any:
        if not isinstance(raw, dict):
            return raw
        filled = dict(raw)
        if "poisson_ratio" not in raw:
            filled.setdefault("tangential_ratio", _TANGENTIAL_RATIO)
        if "max_overlap" in raw and "impact_speed" in raw:
            filled.setdefault("restitution", _RESTITUTION)
        return filled

    @model_validator(mode="after")
    def _is_one_way(self) -> Contact:
        if self.tangential_ratio is not None and self.poisson_ratio is not None:
            raise RuleError(
                'must have at most one of "tangential_ratio" and "poisson_ratio"', "both are given"
            )
        given = [name for name in _PARAMETERS if getattr(self, name) is not None]
        if frozenset(given) not in _WAYS:
            found = f"given are {listed(given)}" if given else "none is given"
            raise RuleError(
                "must have contact_steps and restitution, stiffness and damping, stiffness and restitution, "
                "or max_overlap and impact_speed",
                found,
                _cure(frozenset(given)),
            )
        if self.max_overlap is not None and self.max_overlap >= self.overlap_limit:
            raise RuleError(
                f"must be below overlap_limit = {self.overlap_limit:g}",
                "the designed impact would stop the run",
                value=self.max_overlap,
                at=("max_overlap",),
            )
        return self

    @property
    def way(self) -> Way:
        """Which parameters are given; the others follow from them for each pair of bodies."""
        return _WAYS[frozenset(name for name in _PARAMETERS if getattr(self, name) is not None)]


def _cure(given: frozenset[str]) -> str:
    for way in _WAYS:
        if given < way and given:
            return f"Add {' and '.join(sorted(way - given))}, or choose another pair."
    for way in _WAYS:
        if way < given:
            return f"Leave out {' and '.join(sorted(given - way))}, or choose another pair."
    return "Name one such pair."

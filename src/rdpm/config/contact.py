"""How bodies touch: the law and one of four ways to give its parameters."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import StrictBool, model_validator

from rdpm.config.declared import Choice, LeftOut, Quantity, Whole
from rdpm.config.fields import Model
from rdpm.config.rule import RuleError, listed
from rdpm.conventions import OVERLAP_WARNING

__all__ = ["DEFAULT_CONTACT", "Contact"]

DEFAULT_CONTACT = {"contact_steps": 8.0, "restitution": 0.9}

_RESTITUTION = 0.9  # of most hard spheres within 10 %, where only the overlap is designed
_TANGENTIAL_RATIO = 2 / 7  # a homogeneous sphere then has equal normal and tangential contact periods

Ending = Literal["zero-force", "zero-overlap"]
Way = Literal["contact-steps", "stiffness-damping", "stiffness-restitution", "max-overlap", "impulses"]
ModelName = Literal["soft-sphere", "hard-sphere"]

_WAYS: dict[frozenset[str], Way] = {
    frozenset({"contact_steps", "restitution"}): "contact-steps",
    frozenset({"stiffness", "damping"}): "stiffness-damping",
    frozenset({"stiffness", "restitution"}): "stiffness-restitution",
    frozenset({"max_overlap", "impact_speed", "restitution"}): "max-overlap",
}
#: Keys of some models alone; all others have all models.
_KEYS: dict[str, tuple[ModelName, ...]] = {
    **dict.fromkeys(
        ("contact_steps", "stiffness", "damping", "max_overlap", "impact_speed", "ending", "tangential_ratio",
         "poisson_ratio", "overlap_warning", "substeps"),
        ("soft-sphere",),
    ),
    **dict.fromkeys(("tangential_restitution", "rest_speed", "most_events"), ("hard-sphere",)),
}  # fmt: skip
_PARAMETERS = ("contact_steps", "restitution", "stiffness", "damping", "max_overlap", "impact_speed")


class Contact(Model):
    """Contacts between bodies, and of bodies with walls.

    Attributes
    ----------
    model
        How bodies collide. A soft sphere is a linear spring and dashpot; a hard sphere rebounds at once, by an impulse,
        without overlap. Keys that belong to the other model are refused.
    contact_steps
        Duration of every contact in fluid steps; with `restitution`.
    restitution
        Dry normal coefficient of restitution.
    stiffness
        Normal stiffness of all pairs; with `damping` or `restitution`.
    damping
        Normal damping of all pairs; with `stiffness`.
    max_overlap
        Largest overlap over the smaller diameter, reached at `impact_speed`.
    impact_speed
        Normal relative speed at touch, for `max_overlap`.
    ending
        Where a contact ends: at zero force (LIGGGHTS' `limitForce`), or at zero overlap, where the force is briefly
        attractive.
    friction
        Coulomb's coefficient.
    tangential_ratio
        Tangential over normal stiffness.
    poisson_ratio
        Gives the tangential ratio; instead of `tangential_ratio`.
    lubrication
        Whether the lubrication that the grid does not resolve is added; with a fluid only.
    lubrication_roughness
        Gap over radius below which the lubrication force no longer grows.
    overlap_warning
        Overlap over the smaller diameter above which a design or a run warns: deeper contacts disturb the flow.
    overlap_limit
        Overlap over the smaller diameter at which a run stops.
    substeps
        Contact steps in a fluid step.
    tangential_restitution
        Of a hard sphere's contact that sticks: tangential speed of the surfaces after over before.
    rest_speed
        Normal relative speed below which hard spheres do not rebound: the pair stays in contact.
    most_events
        Collisions of a pair of hard spheres in a step, after which it stays in contact until the step ends.
    """

    model: Annotated[ModelName, Choice(get_args(ModelName), later=("hertz", "repulsive"))] = "soft-sphere"
    contact_steps: Annotated[float | None, Quantity("", ge=4.0, le=1000.0)] = None
    restitution: Annotated[
        float | None, Quantity("", gt=0.0, le=1.0), LeftOut(f"{_RESTITUTION:g} beside `max_overlap`; of hard spheres")
    ] = None
    stiffness: Annotated[float | None, Quantity("N/m", gt=0.0)] = None
    damping: Annotated[float | None, Quantity("N s/m", ge=0.0)] = None
    max_overlap: Annotated[float | None, Quantity("", gt=0.0, le=0.5)] = None
    impact_speed: Annotated[float | None, Quantity("m/s", gt=0.0)] = None
    ending: Annotated[Ending, Choice(get_args(Ending))] = "zero-force"
    friction: Annotated[float, Quantity("", ge=0.0)] = 0.0
    tangential_ratio: Annotated[
        float | None, Quantity("", gt=0.0, le=1.0), LeftOut("2/7 without `poisson_ratio`")
    ] = None
    poisson_ratio: Annotated[float | None, Quantity("", ge=0.0, le=0.5)] = None
    lubrication: Annotated[StrictBool, LeftOut("true with a fluid")] = True
    lubrication_roughness: Annotated[float, Quantity("", gt=0.0, le=0.1)] = 1e-3
    overlap_warning: Annotated[float, Quantity("", gt=0.0, le=0.05)] = OVERLAP_WARNING
    overlap_limit: Annotated[float, Quantity("", gt=0.0, le=0.5)] = 0.2
    substeps: Annotated[int | None, Whole(1, 100_000), LeftOut("chosen from the contact time")] = None
    tangential_restitution: Annotated[float, Quantity("", ge=0.0, le=1.0)] = 0.0
    rest_speed: Annotated[
        float | None, Quantity("m/s", ge=0.0), LeftOut("a rebound below it rises by less than 1e-5 diameters")
    ] = None
    most_events: Annotated[int, Whole(1, 100_000)] = 100

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, raw: Any) -> Any:
        if not isinstance(raw, dict):
            return raw
        filled = dict(raw)
        if raw.get("model") == "hard-sphere":
            filled.setdefault("restitution", _RESTITUTION)
            return filled
        if raw.get("poisson_ratio") is None and raw.get("tangential_ratio") is None:
            filled["tangential_ratio"] = _TANGENTIAL_RATIO
        if "max_overlap" in raw and "impact_speed" in raw:
            filled.setdefault("restitution", _RESTITUTION)
        return filled

    @model_validator(mode="after")
    def _is_one_way(self) -> Contact:
        for name, models in _KEYS.items():
            # What equals its default is not told apart from what is left out: a case that was written loads again.
            if self.model not in models and getattr(self, name) != type(self).model_fields[name].default:
                raise RuleError(
                    f'must be left out of a contact of model = "{self.model}"',
                    f"it belongs to {listed(models)}",
                    f"Leave it out, or set contact.model = \"{models[0]}\".",
                    value=getattr(self, name),
                    at=(name,),
                )
        if self.model == "hard-sphere":
            return self
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
        if self.model == "hard-sphere":
            return "impulses"
        return _WAYS[frozenset(name for name in _PARAMETERS if getattr(self, name) is not None)]


def _cure(given: frozenset[str]) -> str:
    for way in _WAYS:
        if given < way and given:
            return f"Add {' and '.join(sorted(way - given))}, or choose another pair."
    for way in _WAYS:
        if way < given:
            return f"Leave out {' and '.join(sorted(given - way))}, or choose another pair."
    return "Name one such pair."

"""How bodies touch: the model, its keys, and the ways to give its parameters."""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import StrictBool, model_validator

from rdpm.config.declared import Choice, LeftOut, Quantity, Whole
from rdpm.config.fields import Model
from rdpm.config.rule import RuleError, listed
from rdpm.conventions import OVERLAP_WARNING

__all__ = ["DEEPEST_DESIGN", "DEFAULT_CONTACT", "Contact", "keys_of_other_models"]

DEEPEST_DESIGN = 0.05  # a spring that gives more is hardly meant: per cent for a fraction
DEFAULT_CONTACT = {"contact_steps": 8.0, "restitution": 0.9}

_RESTITUTION = 0.9  # of most hard spheres within 10 %, where only the overlap is designed
_LEAST_ADAPTIVE = 0.05
_TANGENTIAL_RATIO = 2 / 7  # a homogeneous sphere then has equal normal and tangential contact periods

Ending = Literal["zero-force", "zero-overlap"]
Name = Literal["soft-sphere", "hertz", "hard-sphere", "repulsive"]
Way = Literal[
    "contact-steps", "stiffness-damping", "stiffness-restitution", "max-overlap", "material", "impulses", "repulsion"
]

# Models that a key belongs to; those left out here belong to all.
_MODELS_OF: dict[str, tuple[Name, ...]] = {
    "contact_steps": ("soft-sphere",),
    "restitution": ("soft-sphere", "hertz", "hard-sphere"),
    "stiffness": ("soft-sphere",),
    "damping": ("soft-sphere",),
    "max_overlap": ("soft-sphere",),
    "impact_speed": ("soft-sphere", "hertz"),
    "ending": ("soft-sphere", "hertz"),
    "friction": ("soft-sphere", "hertz", "hard-sphere"),
    "tangential_ratio": ("soft-sphere",),
    "poisson_ratio": ("soft-sphere", "hertz"),
    "youngs_modulus": ("hertz",),
    "adaptive_collision_time": ("soft-sphere",),
    "rolling_friction": ("soft-sphere", "hertz"),
    "twisting_friction": ("soft-sphere", "hertz"),
    "cohesion": ("soft-sphere", "hertz"),
    "cohesion_range": ("soft-sphere", "hertz"),
    "substeps": ("soft-sphere", "hertz", "repulsive"),
    "fluid_force_in_impact": ("soft-sphere", "hertz"),
    "tangential_restitution": ("hard-sphere",),
    "rest_speed": ("hard-sphere",),
    "most_events": ("hard-sphere",),
    "repulsion_range": ("repulsive",),
    "repulsion_stiffness": ("repulsive",),
}
# Keys that a model cannot do without, and why.
_NEEDED: dict[Name, tuple[tuple[str, str, str], ...]] = {
    "hertz": (
        ("youngs_modulus", "it makes the stiffness", 'such as "10 MPa"'),
        ("poisson_ratio", "it makes the stiffness", "such as 0.3"),
        ("restitution", "it makes the damping", "such as 0.9"),
    ),
    "repulsive": (
        ("repulsion_stiffness", "it is the force at touch", "such as what rdpm design --model repulsive gives"),
    ),
}
_OTHER_WAYS: dict[Name, Way] = {"hertz": "material", "hard-sphere": "impulses", "repulsive": "repulsion"}

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
    model
        How surfaces act on each other, bodies and walls alike. `soft-sphere`: a linear spring and dashpot; `hertz`:
        elastic solids, damped; `hard-sphere`: an impulse at the touch, without overlap; `repulsive`: a short-range
        force that keeps surfaces apart, without friction.
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
        Normal relative speed at touch: for `max_overlap`; of a Hertz contact, the one that the time step resolves.
    adaptive_collision_time
        Of a soft sphere with `contact_steps`: whether its spring is that of a Hertz contact, force over overlap to the
        power 3/2, with a stiffness that follows from the speed of each impact.
    ending
        Where a contact ends: at zero force (LIGGGHTS' `limitForce`), or at zero overlap, where the force is briefly
        attractive.
    friction
        Coulomb's coefficient.
    tangential_ratio
        Tangential over normal stiffness.
    poisson_ratio
        Of a soft sphere, gives the tangential ratio, instead of `tangential_ratio`; of a Hertz contact, with
        `youngs_modulus`.
    youngs_modulus
        Of bodies and walls; Hertz contacts with a softer one last longer and take longer time steps.
    rolling_friction
        Largest torque against rolling over normal force times reduced radius.
    twisting_friction
        Largest torque against twisting, about the normal, over normal force times reduced radius.
    cohesion
        Work of adhesion of two surfaces w; they attract each other with 3/2 pi w times the reduced radius.
    cohesion_range
        Gap below which they do; with `cohesion`.
    repulsion_range
        Gap below which the repulsive force acts.
    repulsion_stiffness
        Repulsive force at touch: stiffness (1 - gap/range)^2.
    lubrication
        Whether the lubrication that the grid does not resolve is added; with a fluid only.
    lubrication_roughness
        Gap over radius below which the lubrication force no longer grows.
    lubrication_in_separation
        Whether lubrication also holds back surfaces that part; false where the liquid breaks instead of pulling.
    lubrication_tangential
        Whether lubrication also acts against slip and roll of close surfaces, besides their approach.
    fluid_force_in_impact
        Whether the fluid acts on a body during an impact; false: weight, contact and lubrication alone do. A contact
        that bears a load, or began at a Stokes number below 5, is none.
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

    model: Annotated[Name, Choice(get_args(Name))] = "soft-sphere"
    contact_steps: Annotated[float | None, Quantity("", ge=4.0, le=1000.0)] = None
    restitution: Annotated[
        float | None,
        Quantity("", gt=0.0, le=1.0),
        LeftOut(f"{_RESTITUTION:g} beside `max_overlap`, and of hard spheres"),
    ] = None
    stiffness: Annotated[float | None, Quantity("N/m", gt=0.0)] = None
    damping: Annotated[float | None, Quantity("N s/m", ge=0.0)] = None
    max_overlap: Annotated[float | None, Quantity("", gt=0.0, le=0.5)] = None
    impact_speed: Annotated[float | None, Quantity("m/s", gt=0.0)] = None
    adaptive_collision_time: StrictBool = False
    ending: Annotated[Ending, Choice(get_args(Ending))] = "zero-force"
    friction: Annotated[float, Quantity("", ge=0.0)] = 0.0
    tangential_ratio: Annotated[float | None, Quantity("", gt=0.0, le=1.0), LeftOut("2/7 without `poisson_ratio`")] = (
        None
    )
    poisson_ratio: Annotated[float | None, Quantity("", ge=0.0, le=0.5)] = None
    youngs_modulus: Annotated[float | None, Quantity("Pa", gt=0.0)] = None
    rolling_friction: Annotated[float, Quantity("", ge=0.0, le=1.0)] = 0.0
    twisting_friction: Annotated[float, Quantity("", ge=0.0, le=1.0)] = 0.0
    cohesion: Annotated[float, Quantity("J/m^2", ge=0.0)] = 0.0
    cohesion_range: Annotated[float | None, Quantity("m", gt=0.0)] = None
    repulsion_range: Annotated[
        float | None, Quantity("m", gt=0.0), LeftOut("two cells of the grid; needed in a dry case")
    ] = None
    repulsion_stiffness: Annotated[float | None, Quantity("N", gt=0.0)] = None
    lubrication: Annotated[StrictBool, LeftOut("true with a fluid")] = True
    lubrication_roughness: Annotated[float, Quantity("", gt=0.0, le=0.1)] = 1e-3
    lubrication_in_separation: StrictBool = True
    lubrication_tangential: StrictBool = True
    fluid_force_in_impact: StrictBool = True
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
        if raw.get("model", "soft-sphere") != "soft-sphere":
            return filled
        if raw.get("poisson_ratio") is None and raw.get("tangential_ratio") is None:
            filled["tangential_ratio"] = _TANGENTIAL_RATIO
        if "max_overlap" in raw and "impact_speed" in raw:
            filled.setdefault("restitution", _RESTITUTION)
        return filled

    @model_validator(mode="after")
    def _is_of_its_model(self) -> Contact:
        for key, models in _MODELS_OF.items():
            value = getattr(self, key)
            if self.model in models or value == type(self).model_fields[key].default:
                continue
            raise RuleError(
                f"belongs to model = {' or '.join(_quoted(models))}",
                f'this contact has model = "{self.model}"',
                f'Leave it out, or set contact.model = "{models[0]}".',
                value=value,
                at=(key,),
            )
        for key, reason, example in _NEEDED.get(self.model, ()):
            if getattr(self, key) is None:
                raise RuleError(f'is missing for model = "{self.model}"', reason, f"Give it, {example}.", at=(key,))
        self._is_extended_well()
        return self._one_way() if self.model == "soft-sphere" else self

    @property
    def is_extended(self) -> bool:
        """Whether rolling friction, twisting friction or cohesion is added to the model."""
        return self.rolling_friction > 0.0 or self.twisting_friction > 0.0 or self.cohesion > 0.0

    def _is_extended_well(self) -> None:
        if self.cohesion > 0.0 and self.cohesion_range is None:
            raise RuleError("is missing with cohesion", "the energy that parts two surfaces is force times range",
                            'Give it, such as "1 um".', at=("cohesion_range",))  # fmt: skip
        if self.cohesion == 0.0 and self.cohesion_range is not None:
            raise RuleError("is meant for cohesion", "no cohesion is given", "Give cohesion, or leave it out.",
                            value=self.cohesion_range, at=("cohesion_range",))  # fmt: skip
        if self.is_extended and self.adaptive_collision_time:
            raise RuleError("must be false with rolling_friction, twisting_friction or cohesion",
                            "they are added to the linear spring or to a Hertz contact",
                            "Leave it out, or leave them out.", value=True,
                            at=("adaptive_collision_time",))  # fmt: skip

    def _one_way(self) -> Contact:
        if self.tangential_ratio is not None and self.poisson_ratio is not None:
            raise RuleError('must have at most one of "tangential_ratio" and "poisson_ratio"', "both are given")
        given = [name for name in _PARAMETERS if getattr(self, name) is not None]
        if frozenset(given) not in _WAYS:
            found = f"given are {listed(given)}" if given else "none is given"
            raise RuleError(
                "must have contact_steps and restitution, stiffness and damping, stiffness and restitution, "
                "or max_overlap and impact_speed",
                found,
                _cure(frozenset(given)),
            )
        if self.max_overlap is not None and self.max_overlap > DEEPEST_DESIGN:
            raise RuleError(
                f"must be at most {DEEPEST_DESIGN:g}, a fraction of the diameter",
                "a contact that deep is no sphere's",
                f'For {self.max_overlap:g} % write {0.01 * self.max_overlap:g}, or "{self.max_overlap:g} %".',
                value=self.max_overlap,
                at=("max_overlap",),
            )
        if self.adaptive_collision_time and frozenset(given) != {"contact_steps", "restitution"}:
            raise RuleError(
                "must be false without contact_steps",
                f"given are {listed(given)}, and the model follows from the contact's duration",
                "Give contact_steps and restitution.",
                value=True,
                at=("adaptive_collision_time",),
            )
        if self.adaptive_collision_time and (self.restitution or 0.0) < _LEAST_ADAPTIVE:
            raise RuleError(
                f"must be at least {_LEAST_ADAPTIVE:g} with adaptive_collision_time",
                "below, its damping leaves hardly a rebound",
                value=self.restitution,
                at=("restitution",),
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
        if self.model in _OTHER_WAYS:
            return _OTHER_WAYS[self.model]
        return _WAYS[frozenset(name for name in _PARAMETERS if getattr(self, name) is not None)]


def keys_of_other_models(model: str) -> set[str]:
    """Keys of a contact that a model does not know.

    Examples
    --------
    >>> "stiffness" in keys_of_other_models("hard-sphere"), "restitution" in keys_of_other_models("hard-sphere")
    (True, False)
    """
    return {key for key, models in _MODELS_OF.items() if model not in models}


def _quoted(names: tuple[str, ...]) -> list[str]:
    return [f'"{name}"' for name in names]


def _cure(given: frozenset[str]) -> str:
    for way in _WAYS:
        if given < way and given:
            return f"Add {' and '.join(sorted(way - given))}, or choose another pair."
    for way in _WAYS:
        if way < given:
            return f"Leave out {' and '.join(sorted(given - way))}, or choose another pair."
    return "Name one such pair."

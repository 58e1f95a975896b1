"""Materials and fluids to choose from; each with where its numbers stand."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FLUIDS", "MATERIALS", "Fluid", "Material"]

_CALLISTER = "Callister and Rethwisch, Materials Science and Engineering, appendix B"
_TEN_CATE = "ten Cate et al., Phys. Fluids 14 (2002) 4012"


@dataclass(frozen=True)
class Material:
    """Of a sphere: density [kg/m^3], Young's modulus [Pa], Poisson's ratio [-]; of polymers they vary by some 20 %."""

    density: float
    youngs_modulus: float
    poisson_ratio: float
    source: str


@dataclass(frozen=True)
class Fluid:
    """Density [kg/m^3] and dynamic viscosity [Pa s], at 20 degrees Celsius where nothing else is said."""

    density: float
    viscosity: float
    source: str


MATERIALS = {
    "soda-lime glass": Material(2500.0, 69e9, 0.23, _CALLISTER),
    "carbon steel": Material(7850.0, 207e9, 0.30, _CALLISTER),
    "stainless steel": Material(8000.0, 193e9, 0.30, _CALLISTER),
    "PMMA": Material(1190.0, 2.7e9, 0.38, f"{_CALLISTER}: 2.24 to 3.24 GPa"),
    "nylon 6,6": Material(1140.0, 2.7e9, 0.39, f"{_CALLISTER}: 1.58 to 3.80 GPa"),
}

FLUIDS = {
    "water": Fluid(998.2, 1.002e-3, "IAPWS"),
    "glycerol": Fluid(1261.0, 1.41, "Segur and Oberstar, Ind. Eng. Chem. 43 (1951) 2117"),
    "silicone oil (E1)": Fluid(970.0, 0.373, _TEN_CATE),
    "silicone oil (E3)": Fluid(962.0, 0.113, _TEN_CATE),
    "silicone oil (E4)": Fluid(960.0, 0.058, _TEN_CATE),
    "air": Fluid(1.204, 1.82e-5, "White, Fluid Mechanics, appendix A: at one atmosphere"),
}

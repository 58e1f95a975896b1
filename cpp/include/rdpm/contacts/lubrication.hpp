// Squeeze film between two surfaces: the part of the normal resistance that the grid does not see.
#pragma once
#include <algorithm>
#include <cmath>

namespace rdpm::contacts {

// lambda(gap) - lambda(gap_cut) with lambda = inverse/gap + log*ln(1/gap) [N s/m]; zero beyond gap_cut, held
// below gap_floor (the roughness), so that it is defined through contact.
inline double lubrication_resistance(double gap, double inverse, double log, double gap_floor,
                                     double gap_cut) {
    const double g = std::max(gap, gap_floor);
    if (!(g < gap_cut)) return 0;
    return inverse * (1 / g - 1 / gap_cut) + log * std::log(gap_cut / g);
}

}  // namespace rdpm::contacts

// Pushes apart what still overlaps at the end of a step of hard spheres.
#pragma once
#include "rdpm/contacts/hard_sphere.hpp"

namespace rdpm::contacts {

struct Gaps {
    double smallest, largest_overlap;  // largest overlap: of the smaller diameter
    std::int64_t deepest;              // its pair
};

// What round-off and unfinished sweeps left of overlaps is pushed out, in proportion to the inverse masses.
inline Gaps separate(double* x, const double* inverse_mass, const double* radius, const Box& box,
                     const std::int32_t* ids, std::int64_t count) {
    constexpr double allowed = 1e-13;
    constexpr int most_sweeps = 200;
    Gaps gaps{};
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        gaps = {kNever, 0, -1};
        for (std::int64_t k = 0; k < count; ++k) {
            const std::int64_t i = ids[2 * k], j = ids[2 * k + 1];
            const Geometry g = j < 0 ? wall_geometry(box, x + 3 * i, radius[i], static_cast<int>(-1 - j))
                                     : sphere_geometry(box, x + 3 * i, x + 3 * j, radius[i], radius[j]);
            gaps.smallest = std::min(gaps.smallest, -g.overlap);
            const double smaller = 2 * (j < 0 ? radius[i] : std::min(radius[i], radius[j]));
            if (g.overlap > gaps.largest_overlap * smaller) {
                gaps.largest_overlap = g.overlap / smaller;
                gaps.deepest = k;
            }
            if (g.overlap <= allowed * smaller) continue;
            const double mass_j = j < 0 ? 0 : inverse_mass[j];
            const double shift = g.overlap / (inverse_mass[i] + mass_j);
            for (int d = 0; d < 3; ++d) {
                x[3 * i + d] -= shift * inverse_mass[i] * g.n[d];
                if (j >= 0) x[3 * j + d] += shift * mass_j * g.n[d];
            }
        }
        if (gaps.largest_overlap <= allowed) break;
    }
    return gaps;
}

}  // namespace rdpm::contacts

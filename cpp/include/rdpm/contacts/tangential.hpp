// Tangential spring, dashpot and Coulomb limit over one sub-step.
#pragma once
#include <algorithm>
#include <cmath>

#include "rdpm/contacts/pair.hpp"

namespace rdpm::contacts {

struct TangentialSpring {
    double k_t, eta_t, mu;

    // xi: elongation, carried to the end of the sub-step; impulse is written.
    void impulse(double* xi, const double* n, const double* slip, double inverse_mass, double duration,
                 double normal, double* impulse) const {
        // The spring turns with the pair: back into the tangent plane, its length kept.
        const double along = dot(xi, n), length = std::sqrt(dot(xi, xi));
        double plane[3], mid[3];
        for (int d = 0; d < 3; ++d) plane[d] = xi[d] - along * n[d];
        const double flat = std::sqrt(dot(plane, plane));
        const double keep = flat > 0 ? length / flat : 0;
        for (int d = 0; d < 3; ++d) {
            mid[d] = keep * plane[d] + 0.5 * duration * slip[d];
            impulse[d] =
                duration * (k_t * mid[d] + eta_t * slip[d]) / (1 + 0.5 * duration * eta_t * inverse_mass);
        }
        const double stick = std::sqrt(dot(impulse, impulse)), limit = mu * std::max(normal, 0.0);
        if (stick <= limit) {
            for (int d = 0; d < 3; ++d)
                xi[d] = mid[d] + 0.5 * duration * (slip[d] - impulse[d] * inverse_mass);
            return;
        }
        // Sliding: the spring keeps what the limit leaves it, and never more than it had.
        double speed = 0;
        for (int d = 0; d < 3; ++d) {
            const double unit = impulse[d] / stick;
            impulse[d] = limit * unit;
            speed += unit * (slip[d] - impulse[d] * inverse_mass);
            xi[d] = unit;
        }
        const double room = k_t > 0 ? std::max(0.0, limit / duration - eta_t * speed) / k_t : 0;
        const double kept = std::min(room, std::sqrt(dot(mid, mid)));
        for (int d = 0; d < 3; ++d) xi[d] *= kept;
    }
};

}  // namespace rdpm::contacts

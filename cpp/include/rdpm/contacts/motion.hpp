// Bodies between and after their contacts: free flight, rotation, the way back into a periodic box.
#pragma once
#include "rdpm/contacts/pair.hpp"

namespace rdpm::contacts {

// Turn a unit quaternion (w, x, y, z) by a rotation vector given in box axes.
inline void rotate_orientation(double* q, const double* rotation) {
    const double angle = std::sqrt(dot(rotation, rotation));
    if (angle == 0) return;
    const double s = std::sin(0.5 * angle) / angle, c = std::cos(0.5 * angle);
    const double p[3] = {s * rotation[0], s * rotation[1], s * rotation[2]};
    const double r[4] = {c * q[0] - p[0] * q[1] - p[1] * q[2] - p[2] * q[3],
                         c * q[1] + p[0] * q[0] + p[1] * q[3] - p[2] * q[2],
                         c * q[2] + p[1] * q[0] + p[2] * q[1] - p[0] * q[3],
                         c * q[3] + p[2] * q[0] + p[0] * q[2] - p[1] * q[1]};
    const double norm = 1 / std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int d = 0; d < 4; ++d) q[d] = norm * r[d];
}

// Ends the step of one body: orientation turned, position back into the box.
inline void settle(const Box& box, double* x, double* orientation, std::int64_t* crossings,
                   const double* rotation) {
    rotate_orientation(orientation, rotation);
    for (int d = 0; d < 3; ++d) {
        double times = std::floor(x[d] * box.inverse_period[d]);
        if (times == 0 || !std::isfinite(times)) continue;
        x[d] -= times * box.period[d];
        // Round-off beside the seam: less than an ulp below it is on it, and nothing was crossed.
        if (x[d] >= box.period[d]) {
            x[d] = 0;
            times += 1;
        }
        if (x[d] < 0) x[d] = 0;
        crossings[d] += static_cast<std::int64_t>(times);
    }
}

// The flight of a body that nothing touches, constant acceleration: what the sub-steps add up to without
// contacts.
inline void fly(double* x, double* v, double* w, double* rotation, const double* force, const double* torque,
                double inverse_mass, double inverse_moment, double dt) {
    for (int d = 0; d < 3; ++d) {
        const double dv = dt * force[d] * inverse_mass, dw = dt * torque[d] * inverse_moment;
        x[d] += dt * (v[d] + 0.5 * dv);
        rotation[d] = dt * (w[d] + 0.5 * dw);
        v[d] += dv;
        w[d] += dw;
    }
}

}  // namespace rdpm::contacts

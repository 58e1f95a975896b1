// Torques of a contact beside its tangential force, over one sub-step.
#pragma once
#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/substep_task.hpp"

namespace rdpm::contacts {

// Angular impulse of a pair against its relative rotation, applied to both bodies: equal and opposite, so
// that angular momentum is kept. Returns its work.
template <RotationLaw Law, class Partners>
double resist_rotation(const BodyBlock& b, const Partners& p, const double* n,
                       const typename Law::Parameters& law, const Window& w, double h, double normal) {
    const double inverse_moment = p.inverse_moment_i + p.inverse_moment_j;
    if (inverse_moment == 0) return 0;
    double turn[3], impulse[3];
    const double *wi = b.angular_velocity_of(p.i), *dw = b.angular_gain_of(p.i);
    for (int d = 0; d < 3; ++d) turn[d] = wi[d] - 0.5 * dw[d] - (p.wj[d] - 0.5 * p.dw_j[d]);
    Law::angular_impulse(law, w, n, turn, inverse_moment, h, normal, impulse);
    for (int d = 0; d < 3; ++d) {
        b.angular_velocity_of(p.i)[d] -= impulse[d] * p.inverse_moment_i;
        b.angular_impulse_of(p.i)[d] -= impulse[d];
        if (p.j < 0) continue;
        b.angular_velocity_of(p.j)[d] += impulse[d] * p.inverse_moment_j;
        b.angular_impulse_of(p.j)[d] += impulse[d];
    }
    return 0.5 * inverse_moment * dot(impulse, impulse) - dot(impulse, turn);
}

}  // namespace rdpm::contacts

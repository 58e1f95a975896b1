// Linear spring-dashpot between two surfaces, over one sub-step: a law that knows only its pair.
// u is the rate of overlap (> 0: approaching), h the sub-step; impulses act on i against the normal.
#pragma once
#include "rdpm/contacts/pair.hpp"

namespace rdpm::contacts {

// Fractions of the sub-step between which the force acts, and the mean overlap between them.
struct Window {
    double from, to, overlap;
    double share() const { return to - from; }
};

// Entry and exit are located on the straight line overlap_mid + u (t - h/2).
// zero_force: the force acts while k_n overlap + eta_n u > 0; else until the overlap is zero, attraction
// allowed.
inline Window contact_window(const PairLaw& law, bool zero_force, double phase, double overlap_mid, double u,
                             double h) {
    const double first = overlap_mid - 0.5 * u * h, last = overlap_mid + 0.5 * u * h;
    Window w{0, 0, 0};
    if (first <= 0 && last <= 0) return w;
    double from = 0, to = 1;
    if (u > 0) {
        if (first < 0) from = -first / (u * h);
    } else if (zero_force) {
        const double force = law.k_n * first + law.eta_n * u;
        if (force <= 0) return w;
        if (force + law.k_n * u * h < 0) to = -force / (law.k_n * u * h);
    } else {
        // What has ended does not pull again: round-off may leave a trace of overlap.
        if (phase != kTouching && law.k_n * first + law.eta_n * u <= 0) return w;
        if (last < 0) to = -first / (u * h);
    }
    return {from, to, first + 0.5 * u * h * (from + to)};
}

struct NormalImpulse {
    double contact, lubrication;
};

// The dashpot is taken at the mean velocity (implicit midpoint), the film at the velocity after the impulse:
// stable whatever lambda h / m. u holds all of the sub-step's outer acceleration, u_mid half of it, so that a
// body at rest under its weight has exactly its static overlap and one that sinks through a film exactly the
// speed F/lambda.
inline NormalImpulse normal_impulse(const PairLaw& law, const Window& w, bool zero_force, double lambda,
                                    double inverse_mass, double u, double u_mid, double h) {
    const double hw = h * w.share();
    const double film = h * lambda * inverse_mass;
    const double spring = hw * law.k_n * w.overlap;
    const double all =
        (spring + hw * law.eta_n * u_mid + h * lambda * u) / (1 + 0.5 * hw * law.eta_n * inverse_mass + film);
    double contact = spring + hw * law.eta_n * (u_mid - 0.5 * all * inverse_mass);
    if (hw == 0 || (zero_force && contact < 0)) contact = 0;
    return {contact, h * lambda * (u - contact * inverse_mass) / (1 + film)};
}

// Tangential spring, dashpot and Coulomb limit. v is the surfaces' relative velocity in the tangent plane; xi
// is carried to the end of the sub-step. Returns whether the surfaces slide.
inline bool tangential_impulse(const PairLaw& law, const double* n, const double* v, double inverse_mass,
                               double hw, double normal, double* xi, double* impulse) {
    // The spring turns with the pair: back into the tangent plane, its length kept.
    const double along = dot(xi, n), length = std::sqrt(dot(xi, xi));
    double plane[3], mid[3];
    for (int d = 0; d < 3; ++d) plane[d] = xi[d] - along * n[d];
    const double flat = std::sqrt(dot(plane, plane));
    const double keep = flat > 0 ? length / flat : 0;
    for (int d = 0; d < 3; ++d) {
        mid[d] = keep * plane[d] + 0.5 * hw * v[d];
        impulse[d] = hw * (law.k_t * mid[d] + law.eta_t * v[d]) / (1 + 0.5 * hw * law.eta_t * inverse_mass);
    }
    const double asked = std::sqrt(dot(impulse, impulse)), limit = law.mu * std::max(normal, 0.0);
    if (asked <= limit) {
        for (int d = 0; d < 3; ++d) xi[d] = mid[d] + 0.5 * hw * (v[d] - impulse[d] * inverse_mass);
        return false;
    }
    // Sliding: the spring keeps what the limit leaves it, and never more than it had.
    double slip = 0;
    for (int d = 0; d < 3; ++d) {
        const double unit = impulse[d] / asked;
        impulse[d] = limit * unit;
        slip += unit * (v[d] - impulse[d] * inverse_mass);
        xi[d] = unit;
    }
    const double room = law.k_t > 0 ? std::max(0.0, limit / hw - law.eta_t * slip) / law.k_t : 0;
    const double reach = std::min(room, std::sqrt(dot(mid, mid)));
    for (int d = 0; d < 3; ++d) xi[d] *= reach;
    return true;
}

}  // namespace rdpm::contacts

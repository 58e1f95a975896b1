// Adaptive collision time model (Kempe and Froehlich 2012), over one sub-step.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"
#include "rdpm/contacts/soft_sphere.hpp"

namespace rdpm::contacts {

// docs/theory/adaptive.md: force k overlap^(3/2) + d rate, equation (1); k follows from the speed of the
// impact, equation (4), and is kept until the contact ends.
struct AdaptiveCollisionTime {
    struct Parameters {
        double mass, time;  // reduced mass; t_* of equation (2)
        double d, least_speed;
        double ratio, eta_t, mu;   // tangential over normal stiffness
        double k;                  // of the impact under way
        std::int64_t may_attract;  // 1: a contact ends at zero overlap; 0: at zero force
    };
    struct History {
        double k;
        double xi[3];      // elongation of the tangential spring
        double stiffness;  // that it was stretched with
    };
    static constexpr std::array parameter_fields{
        RDPM_FIELD(Parameters, mass),       RDPM_FIELD(Parameters, time),
        RDPM_FIELD(Parameters, d),          RDPM_FIELD(Parameters, least_speed),
        RDPM_FIELD(Parameters, ratio),      RDPM_FIELD(Parameters, eta_t),
        RDPM_FIELD(Parameters, mu),         RDPM_FIELD(Parameters, k),
        RDPM_FIELD(Parameters, may_attract)};
    static constexpr std::array history_fields{RDPM_FIELD(History, k), RDPM_FIELD(History, xi),
                                               RDPM_FIELD(History, stiffness)};

    // The row with the stiffness of this impact, equation (4).
    static Parameters at_impact(const Parameters& p, History& history, const Approach& a) {
        if (!a.is_touching)
            history.k = p.mass / std::sqrt(std::max(a.rate, p.least_speed) * std::pow(p.time, 5));
        Parameters result = p;
        result.k = history.k;
        return result;
    }

    // Entry and exit are located on the straight line overlap + rate (t - h/2). A contact begins with an
    // approach: what has ended does not push again.
    static Window window(const Parameters& p, const Approach& a) {
        const double u = a.rate, h = a.h;
        const double first = a.overlap - 0.5 * u * h, last = a.overlap + 0.5 * u * h;
        const double end = u < 0 && !p.may_attract ? std::pow(-p.d * u / p.k, 2.0 / 3) : 0;
        Window w{0, 0, 0};
        if ((first <= end && last <= end) || (u <= 0 && !a.is_touching)) return w;
        const double from = first < 0 ? -first / (u * h) : 0;
        const double to = u < 0 && last < end ? (end - first) / (u * h) : 1;
        return {from, to, first + 0.5 * u * h * (from + to)};
    }

    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        const double duration = h * w.share();
        return {duration * p.k * w.overlap * std::sqrt(w.overlap), duration * p.d, p.may_attract != 0};
    }

    static bool has_friction(const Parameters& p) { return p.mu > 0; }

    // The soft sphere's spring, dashpot and Coulomb limit; as in a Hertz contact a growing overlap keeps the
    // force, a shrinking one the elongation.
    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        const double k_t = p.ratio * 1.5 * p.k * std::sqrt(w.overlap);
        const SoftSphere::Parameters spring{0, 0, k_t, p.eta_t, p.mu, 0};
        SoftSphere::History kept{{history.xi[0], history.xi[1], history.xi[2]}};
        if (k_t > history.stiffness)
            for (double& x : kept.xi) x *= history.stiffness / k_t;
        SoftSphere::tangential_impulse(spring, kept, w, n, slip, inverse_mass, h, normal, impulse);
        for (int d = 0; d < 3; ++d) history.xi[d] = kept.xi[d];
        history.stiffness = k_t;
    }
};

}  // namespace rdpm::contacts

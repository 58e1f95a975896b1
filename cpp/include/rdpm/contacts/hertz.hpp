// Hertz-Mindlin contact with the damping of Tsuji, Tanaka and Ishida (1992), over one sub-step.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"
#include "rdpm/contacts/soft_sphere.hpp"

namespace rdpm::contacts {

// docs/theory/hertz.md: force k overlap^(3/2) + eta overlap^(1/4) rate, equation (1); tangential stiffness
// k_t overlap^(1/2) and damping eta_t overlap^(1/4), equations (8) and (9).
struct Hertz {
    struct Parameters {
        double k, eta, k_t, eta_t, mu;
        std::int64_t may_attract;  // 1: a contact ends at zero overlap; 0: at zero force
    };
    struct History {
        double xi[3];      // elongation of the tangential spring
        double stiffness;  // that it was stretched with
    };
    static constexpr std::array parameter_fields{
        RDPM_FIELD(Parameters, k),     RDPM_FIELD(Parameters, eta), RDPM_FIELD(Parameters, k_t),
        RDPM_FIELD(Parameters, eta_t), RDPM_FIELD(Parameters, mu),  RDPM_FIELD(Parameters, may_attract)};
    static constexpr std::array history_fields{RDPM_FIELD(History, xi), RDPM_FIELD(History, stiffness)};

    // Overlap at which the force of a parting pair vanishes: k overlap^(5/4) = -eta rate.
    static double end_overlap(const Parameters& p, double rate) {
        return rate < 0 && !p.may_attract ? std::pow(-p.eta * rate / p.k, 0.8) : 0;
    }

    // Entry and exit are located on the straight line overlap + rate (t - h/2).
    static Window window(const Parameters& p, const Approach& a) {
        const double u = a.rate, h = a.h;
        const double first = a.overlap - 0.5 * u * h, last = a.overlap + 0.5 * u * h;
        const double end = end_overlap(p, u);
        Window w{0, 0, 0};
        if (first <= end && last <= end) return w;
        // What has ended does not pull again: round-off may leave a trace of overlap.
        if (u < 0 && p.may_attract && !a.is_touching && p.k * std::pow(first, 1.25) + p.eta * u <= 0)
            return w;
        double from = 0, to = 1;
        if (first < 0) from = -first / (u * h);
        if (u < 0 && last < end) to = (end - first) / (u * h);
        return {from, to, first + 0.5 * u * h * (from + to)};
    }

    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        const double duration = h * w.share(), root = std::sqrt(w.overlap);
        return {duration * p.k * w.overlap * root, duration * p.eta * std::sqrt(root), p.may_attract != 0};
    }

    static bool has_friction(const Parameters& p) { return p.mu > 0; }

    // The soft sphere's spring, dashpot and Coulomb limit with the stiffness of this overlap. A growing
    // contact keeps the force, a shrinking one the elongation: neither adds energy.
    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        const double root = std::sqrt(w.overlap);
        const SoftSphere::Parameters spring{0, 0, p.k_t * root, p.eta_t * std::sqrt(root), p.mu, 0};
        SoftSphere::History kept{{history.xi[0], history.xi[1], history.xi[2]}};
        if (spring.k_t > history.stiffness)
            for (double& x : kept.xi) x *= history.stiffness / spring.k_t;
        SoftSphere::tangential_impulse(spring, kept, w, n, slip, inverse_mass, h, normal, impulse);
        for (int d = 0; d < 3; ++d) history.xi[d] = kept.xi[d];
        history.stiffness = spring.k_t;
    }
};

}  // namespace rdpm::contacts

// Linear spring-dashpot between two surfaces, over one sub-step.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"
#include "rdpm/contacts/tangential.hpp"

namespace rdpm::contacts {

struct SoftSphere {
    struct Parameters {
        double k_n, eta_n, k_t, eta_t, mu;
        std::int64_t may_attract;  // 1: a contact ends at zero overlap; 0: at zero force
    };
    struct History {
        double xi[3];  // elongation of the tangential spring
    };
    static constexpr std::array parameter_fields{
        RDPM_FIELD(Parameters, k_n),   RDPM_FIELD(Parameters, eta_n), RDPM_FIELD(Parameters, k_t),
        RDPM_FIELD(Parameters, eta_t), RDPM_FIELD(Parameters, mu),    RDPM_FIELD(Parameters, may_attract)};
    static constexpr std::array history_fields{RDPM_FIELD(History, xi)};

    // Entry and exit are located on the straight line overlap + rate (t - h/2). At zero force: the force acts
    // while k_n overlap + eta_n rate > 0; else until the overlap is zero, attraction allowed.
    static Window window(const Parameters& p, const Approach& a) {
        const double u = a.rate, h = a.h;
        const double first = a.overlap - 0.5 * u * h, last = a.overlap + 0.5 * u * h;
        Window w{0, 0, 0};
        if (first <= 0 && last <= 0) return w;
        double from = 0, to = 1;
        if (u > 0) {
            if (first < 0) from = -first / (u * h);
        } else if (!p.may_attract) {
            const double force = p.k_n * first + p.eta_n * u;
            if (force <= 0) return w;
            if (force + p.k_n * u * h < 0) to = -force / (p.k_n * u * h);
        } else {
            // What has ended does not pull again: round-off may leave a trace of overlap.
            if (!a.is_touching && p.k_n * first + p.eta_n * u <= 0) return w;
            if (last < 0) to = -first / (u * h);
        }
        return {from, to, first + 0.5 * u * h * (from + to)};
    }

    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        const double duration = h * w.share();
        return {duration * p.k_n * w.overlap, duration * p.eta_n, p.may_attract != 0};
    }

    static bool has_friction(const Parameters& p) { return p.mu > 0; }

    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        const TangentialSpring spring{p.k_t, p.eta_t, p.mu};
        spring.impulse(history.xi, n, slip, inverse_mass, h * w.share(), normal, impulse);
    }
};

}  // namespace rdpm::contacts

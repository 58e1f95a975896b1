// Linear spring-dashpot between two surfaces, over one sub-step.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"

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

    // Tangential spring, dashpot and Coulomb limit; the spring is carried to the end of the sub-step.
    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        const double duration = h * w.share();
        double* xi = history.xi;
        // The spring turns with the pair: back into the tangent plane, its length kept.
        const double along = dot(xi, n), length = dot(xi, xi);
        double plane[3], mid[3];
        for (int d = 0; d < 3; ++d) plane[d] = xi[d] - along * n[d];
        const double flat = dot(plane, plane);
        const double keep = flat > 0 ? std::sqrt(length / flat) : 0;
        const double weight = duration / (1 + 0.5 * duration * p.eta_t * inverse_mass);
        for (int d = 0; d < 3; ++d) {
            mid[d] = keep * plane[d] + 0.5 * duration * slip[d];
            impulse[d] = weight * (p.k_t * mid[d] + p.eta_t * slip[d]);
        }
        const double stick = std::sqrt(dot(impulse, impulse)), limit = p.mu * std::max(normal, 0.0);
        if (stick <= limit) {
            for (int d = 0; d < 3; ++d)
                xi[d] = mid[d] + 0.5 * duration * (slip[d] - impulse[d] * inverse_mass);
            return;
        }
        // Sliding: the spring keeps what the limit leaves it, and never more than it had.
        const double inverse_stick = 1 / stick;
        double speed = 0;
        for (int d = 0; d < 3; ++d) {
            const double unit = impulse[d] * inverse_stick;
            impulse[d] = limit * unit;
            speed += unit * (slip[d] - impulse[d] * inverse_mass);
            xi[d] = unit;
        }
        const double room = p.k_t > 0 ? std::max(0.0, limit / duration - p.eta_t * speed) / p.k_t : 0;
        const double kept = std::min(room, std::sqrt(dot(mid, mid)));
        for (int d = 0; d < 3; ++d) xi[d] *= kept;
    }
};

}  // namespace rdpm::contacts

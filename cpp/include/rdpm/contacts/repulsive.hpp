// Short-range repulsive force of Glowinski, Pan, Hesla, Joseph and Periaux (2001), over one sub-step.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"

namespace rdpm::contacts {

// docs/theory/repulsive.md, equation (1): stiffness ((range + overlap) / range)^2 for gaps below the range.
struct Repulsive {
    struct Parameters {
        double stiffness, range;  // force at touch; gap from which it acts
    };
    struct History {};
    static constexpr std::array parameter_fields{RDPM_FIELD(Parameters, stiffness),
                                                 RDPM_FIELD(Parameters, range)};
    static constexpr std::array<Field, 0> history_fields{};
    static constexpr bool acts_at_distance = true;

    static Window window(const Parameters& p, const Approach& a) {
        Approach shifted = a;
        shifted.overlap += p.range;
        Window w = overlap_window(shifted);
        w.overlap -= p.range;
        return w;
    }

    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        const double depth = (p.range + w.overlap) / p.range;
        return {h * w.share() * p.stiffness * depth * depth, 0, false};
    }
};

}  // namespace rdpm::contacts

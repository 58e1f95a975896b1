// A contact law of tests only: a constant force as long as the surfaces overlap.
#include "rdpm/contacts/substeps.hpp"

using namespace rdpm::contacts;

struct ConstantForce {
    struct Parameters {
        double force;
    };
    struct History {};
    static constexpr std::array parameter_fields{RDPM_FIELD(Parameters, force)};
    static constexpr std::array<Field, 0> history_fields{};

    // The overlap's straight line crosses zero at most once: there the force begins or ends.
    static Window window(const Parameters&, const Approach& a) {
        const double first = a.overlap - 0.5 * a.rate * a.h, last = a.overlap + 0.5 * a.rate * a.h;
        if (first <= 0 && last <= 0) return {0, 0, 0};
        const double from = first < 0 ? -first / (a.rate * a.h) : 0,
                     to = last < 0 ? -first / (a.rate * a.h) : 1;
        return {from, to, first + 0.5 * a.rate * a.h * (from + to)};
    }

    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        return {h * w.share() * p.force, 0, false};
    }
};

extern "C" const Kernel constant_force = kernel_of<ConstantForce>();

// What may be added to a law of overlapping surfaces: rolling friction, twisting friction, cohesion.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"

namespace rdpm::contacts {

// docs/theory/extended.md. A torque of at most `length` times the normal force, against the rotation of one
// body on the other about axes in the tangent plane, equation (1).
struct RollingFriction {
    double length;
    static void rate(const double* n, const double* turn, double* result) {
        const double along = dot(turn, n);
        for (int d = 0; d < 3; ++d) result[d] = turn[d] - along * n[d];
    }
};

// The same about the normal, equation (2).
struct TwistingFriction {
    double length;
    static void rate(const double* n, const double* turn, double* result) {
        const double along = dot(turn, n);
        for (int d = 0; d < 3; ++d) result[d] = along * n[d];
    }
};

// What the limit allows, and never more than stops the rotation: it takes energy, and none is stored.
template <class Friction>
void add_resistance(const Friction& friction, const double* n, const double* turn, double inverse_moment,
                    double normal, double* impulse) {
    double rate[3];
    Friction::rate(n, turn, rate);
    const double stop = std::sqrt(dot(rate, rate)) / inverse_moment,
                 limit = friction.length * std::max(normal, 0.0);
    if (stop == 0) return;
    const double share = std::min(1.0, limit / stop) / inverse_moment;
    for (int d = 0; d < 3; ++d) impulse[d] += share * rate[d];
}

// Square well: a constant attraction between surfaces nearer than `range`, and in contact, equation (3).
struct Cohesion {
    double pull_off, range;
    Window window(const Approach& a) const {
        Approach shifted = a;
        shifted.overlap += range;
        Window w = overlap_window(shifted);
        w.overlap -= range;
        return w;
    }
};

template <std::size_t N, class... More>
constexpr std::array<Field, N + sizeof...(More)> extended_fields(const std::array<Field, N>& first,
                                                                 const More&... more) {
    std::array<Field, N + sizeof...(More)> result{};
    std::size_t at = 0;
    for (const Field& one : first) result[at++] = one;
    ((result[at++] = more), ...);
    return result;
}

// A law with rolling and twisting friction.
template <TangentialLaw Law>
struct Resisting {
    struct Parameters {
        typename Law::Parameters law;
        double rolling, twisting;  // lengths
    };
    using History = typename Law::History;
    static constexpr auto parameter_fields = extended_fields(
        Law::parameter_fields, RDPM_FIELD(Parameters, rolling), RDPM_FIELD(Parameters, twisting));
    static constexpr auto history_fields = Law::history_fields;

    static Window window(const Parameters& p, const Approach& a) { return Law::window(p.law, a); }
    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        return Law::normal_impulse(p.law, w, h);
    }
    static bool has_friction(const Parameters& p) { return Law::has_friction(p.law); }
    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        Law::tangential_impulse(p.law, history, w, n, slip, inverse_mass, h, normal, impulse);
    }
    static void angular_impulse(const Parameters& p, const Window&, const double* n, const double* turn,
                                double inverse_moment, double, double normal, double* impulse) {
        for (int d = 0; d < 3; ++d) impulse[d] = 0;
        add_resistance(RollingFriction{p.rolling}, n, turn, inverse_moment, normal, impulse);
        add_resistance(TwistingFriction{p.twisting}, n, turn, inverse_moment, normal, impulse);
    }
};

// That with cohesion. The well's window holds the contact's, which is kept in the row of the sub-step;
// friction counts the attraction as a load (Derjaguin).
template <RotationLaw Law>
struct Cohesive {
    struct Parameters {
        typename Law::Parameters law;
        double pull_off, range;
        double from, to, overlap;  // of the contact in this sub-step
    };
    using History = typename Law::History;
    static constexpr auto parameter_fields = extended_fields(
        Law::parameter_fields, RDPM_FIELD(Parameters, pull_off), RDPM_FIELD(Parameters, range),
        RDPM_FIELD(Parameters, from), RDPM_FIELD(Parameters, to), RDPM_FIELD(Parameters, overlap));
    static constexpr auto history_fields = Law::history_fields;
    static constexpr bool acts_at_distance = true;

    static Parameters at_impact(const Parameters& p, History&, const Approach& a) {
        const Window w = Law::window(p.law, a);
        Parameters result = p;
        result.from = w.from;
        result.to = w.to;
        result.overlap = w.overlap;
        return result;
    }
    static Window contact(const Parameters& p) { return {p.from, p.to, p.overlap}; }
    static double load(const Parameters& p, const Window& w, double h) { return h * w.share() * p.pull_off; }

    static Window window(const Parameters& p, const Approach& a) {
        return Cohesion{p.pull_off, p.range}.window(a);
    }
    static NormalImpulse normal_impulse(const Parameters& p, const Window& w, double h) {
        const NormalImpulse own = Law::normal_impulse(p.law, contact(p), h);
        return {own.elastic - load(p, w, h), own.damping, true};
    }
    static bool has_friction(const Parameters& p) { return Law::has_friction(p.law); }
    static void tangential_impulse(const Parameters& p, History& history, const Window& w, const double* n,
                                   const double* slip, double inverse_mass, double h, double normal,
                                   double* impulse) {
        if (contact(p).share() > 0)
            Law::tangential_impulse(p.law, history, contact(p), n, slip, inverse_mass, h,
                                    normal + load(p, w, h), impulse);
    }
    static void angular_impulse(const Parameters& p, const Window& w, const double* n, const double* turn,
                                double inverse_moment, double h, double normal, double* impulse) {
        const bool touches = contact(p).share() > 0;
        Law::angular_impulse(p.law, contact(p), n, turn, inverse_moment, h,
                             touches ? normal + load(p, w, h) : 0, impulse);
    }
};

}  // namespace rdpm::contacts

// What a contact law is to the driver: a struct that knows only its pair.
#pragma once
#include <concepts>

#include "rdpm/contacts/pair.hpp"

namespace rdpm::contacts {

// The pair in one sub-step, before its impulse. `rate` is the mean rate of overlap (> 0: approaching), and
// `overlap` the value in the middle.
struct Approach {
    double overlap, rate, h;
    bool is_touching;  // a contact is under way
};

// Fractions of the sub-step between which the force acts, and the mean overlap between them. A window that
// ends before the sub-step does ends the contact.
struct Window {
    double from, to, overlap;
    double share() const { return to - from; }
};

// Fractions between which the surfaces overlap, on the straight line overlap + rate (t - h/2).
inline Window overlap_window(const Approach& a) {
    const double first = a.overlap - 0.5 * a.rate * a.h, last = a.overlap + 0.5 * a.rate * a.h;
    if (first <= 0 && last <= 0) return {0, 0, 0};
    const double from = first < 0 ? -first / (a.rate * a.h) : 0, to = last < 0 ? -first / (a.rate * a.h) : 1;
    return {from, to, first + 0.5 * a.rate * a.h * (from + to)};
}

// Normal impulse of a sub-step, linear in the mean rate of overlap: elastic + damping * rate, on i against
// the normal. The driver solves it together with lubrication.
struct NormalImpulse {
    double elastic, damping;
    bool may_attract;
};

// `Parameters` is a row a pair, `History` what a pair in contact remembers beside the driver's ContactState;
// both are structs of doubles and 64-bit integers, listed in `parameter_fields` and `history_fields`. The
// driver sets a history to zero when its contact ends. A law whose force acts before the surfaces touch says
// so by a member `acts_at_distance`: its window then is no contact, the overlap of the surfaces is.
template <class Law>
concept ContactLaw = requires(const typename Law::Parameters& p, const Approach& a, const Window& w) {
    typename Law::History;
    { Law::window(p, a) } -> std::same_as<Window>;
    { Law::normal_impulse(p, w, a.h) } -> std::same_as<NormalImpulse>;
};

// A law with a tangential part has two functions more. `slip`: relative velocity of the surfaces in the
// tangent plane; `inverse_mass` relates it to a tangential impulse; `impulse` is written.
template <class Law>
concept TangentialLaw =
    ContactLaw<Law> &&
    requires(const typename Law::Parameters& p, typename Law::History& history, const Window& w,
             const double* n, const double* slip, double x, double* impulse) {
        { Law::has_friction(p) } -> std::same_as<bool>;
        Law::tangential_impulse(p, history, w, n, slip, /*inverse_mass*/ x, /*h*/ x, /*normal*/ x, impulse);
    };

// A law with torques against relative rotation. `turn`: angular velocity of i against j; `inverse_moment`
// relates it to an angular impulse; `impulse`, on j and against i, is written.
template <class Law>
concept RotationLaw =
    ContactLaw<Law> && requires(const typename Law::Parameters& p, const Window& w, const double* n,
                                const double* turn, double x, double* impulse) {
        Law::angular_impulse(p, w, n, turn, /*inverse_moment*/ x, /*h*/ x, /*normal*/ x, impulse);
    };

// A law whose parameters follow from the impact: `at_impact` gives the row that the other functions get, and
// may remember of it in the history.
template <class Law>
concept ImpactLaw = ContactLaw<Law> && requires(const typename Law::Parameters& p,
                                                typename Law::History& history, const Approach& a) {
    { Law::at_impact(p, history, a) } -> std::same_as<typename Law::Parameters>;
};

// The row of a pair in this sub-step.
template <ContactLaw Law>
decltype(auto) row_of(const typename Law::Parameters& row, [[maybe_unused]] typename Law::History& history,
                      [[maybe_unused]] const Approach& approach) {
    if constexpr (ImpactLaw<Law>)
        return Law::at_impact(row, history, approach);
    else
        return (row);
}

// A law whose force acts before the surfaces touch. Without that member a pair whose surfaces do not overlap
// in a sub-step has no window in it, and is not asked.
template <class Law>
concept DistantLaw = ContactLaw<Law> && requires { requires Law::acts_at_distance; };

}  // namespace rdpm::contacts

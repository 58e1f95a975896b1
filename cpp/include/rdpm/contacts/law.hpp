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

// Normal impulse of a sub-step, linear in the mean rate of overlap: elastic + damping * rate, on i against
// the normal. The driver solves it together with lubrication.
struct NormalImpulse {
    double elastic, damping;
    bool may_attract;
};

// `Parameters` is a row a pair, `History` what a pair in contact remembers beside the driver's ContactState;
// both are structs of doubles and 64-bit integers, listed in `parameter_fields` and `history_fields`. The
// driver sets a history to zero when its contact ends.
template <class Law>
concept ContactLaw = requires(const typename Law::Parameters& p, const Approach& a, const Window& w) {
    typename Law::History;
    { Law::window(p, a) } -> std::same_as<Window>;
    { Law::normal_impulse(p, w, a.h) } -> std::same_as<NormalImpulse>;
};

// A law with a tangential part has two functions more. `slip`: relative velocity of the surfaces in the
// tangent plane; `inverse_mass` relates it to a tangential impulse; `duration`: time that the force acts;
// `impulse` is written.
template <class Law>
concept TangentialLaw = ContactLaw<Law> && requires(const typename Law::Parameters& p,
                                                    typename Law::History& history, const double* n,
                                                    const double* slip, double x, double* impulse) {
    { Law::has_friction(p) } -> std::same_as<bool>;
    Law::tangential_impulse(p, history, n, slip, /*inverse_mass*/ x, /*duration*/ x, /*normal*/ x, impulse);
};

}  // namespace rdpm::contacts

// Bodies and pairs over the sub-steps of one step: drift, kick, drift; the pairs in fixed order, each impulse
// at once.
#pragma once
#include <limits>

#include "rdpm/contacts/pair.hpp"
#include "rdpm/contacts/soft_sphere.hpp"

namespace rdpm::contacts {

struct BodyArrays {
    double *x, *v, *w, *turn;   // (N, 3); turn: rotation vector since the step began
    const double *kick, *spin;  // (N, 3): what force and torque add in one sub-step
    const double *inverse_mass, *inverse_moment, *radius;  // (N,); zero inverses hold a prescribed motion
    double *impulse, *angular_impulse, *contact_impulse;   // (N, 3), added to
};

// One finished contact (contacts/episodes.py names the same columns).
struct Finished {
    double pair, start, end, max_overlap, impact_speed, rebound_speed, work;
};

struct Progress {
    std::int64_t next, finished, failed;  // failed: the pair past the overlap limit, or -1
    double min_gap;
    double max_overlap;  // [-], of the smaller diameter
};

struct SubstepPlan {
    double time, h, overlap_limit;
    bool zero_force;
    std::int64_t first, last, capacity;
};

// A pair's partners as the law sees them; a wall has no mass, spin or acceleration of its own.
struct Partners {
    std::int64_t i, j;
    double inverse_mass_i, inverse_mass_j, inverse_moment_i, inverse_moment_j, smaller_diameter;
    const double *vj, *wj, *kick_j, *spin_j;
};

inline Partners partners_of(const BodyArrays& b, const Box& box, std::int64_t i, std::int64_t j) {
    static constexpr double none[3] = {0, 0, 0};
    Partners p{i,    j,   b.inverse_mass[i], 0, b.inverse_moment[i], 0, 2 * b.radius[i], nullptr, none,
               none, none};
    if (j < 0) {
        p.vj = box.wall_velocity + 3 * (-1 - j);
    } else {
        p.inverse_mass_j = b.inverse_mass[j];
        p.inverse_moment_j = b.inverse_moment[j];
        p.smaller_diameter = 2 * std::min(b.radius[i], b.radius[j]);
        p.vj = b.v + 3 * j;
        p.wj = b.w + 3 * j;
        p.kick_j = b.kick + 3 * j;
        p.spin_j = b.spin + 3 * j;
    }
    return p;
}

// Tangential velocity of the surfaces against each other at the contact point, with half of this sub-step's
// kick; u_mid is the normal part.
inline void slip_velocity(const BodyArrays& b, const Partners& p, const Geometry& g, double u_mid,
                          double* slip) {
    const double *vi = b.v + 3 * p.i, *wi = b.w + 3 * p.i, *ki = b.kick + 3 * p.i, *si = b.spin + 3 * p.i;
    double roll[3];
    for (int d = 0; d < 3; ++d)
        roll[d] = g.lever_i * (wi[d] - 0.5 * si[d]) + g.lever_j * (p.wj[d] - 0.5 * p.spin_j[d]);
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        slip[d] = vi[d] - p.vj[d] - 0.5 * (ki[d] - p.kick_j[d]) - u_mid * g.n[d] + roll[e] * g.n[f] -
                  roll[f] * g.n[e];
    }
}

inline void apply(const BodyArrays& b, const Partners& p, const Geometry& g, const NormalImpulse& normal,
                  const double* tangential) {
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        const double contact = -normal.contact * g.n[d] - tangential[d];
        const double all = contact - normal.lubrication * g.n[d];
        const double twist = -(g.n[e] * tangential[f] - g.n[f] * tangential[e]);
        const std::int64_t at_i = 3 * p.i + d, at_j = 3 * p.j + d;
        b.v[at_i] += all * p.inverse_mass_i;
        b.w[at_i] += g.lever_i * twist * p.inverse_moment_i;
        b.impulse[at_i] += all;
        b.angular_impulse[at_i] += g.lever_i * twist;
        b.contact_impulse[at_i] += contact;
        if (p.j < 0) continue;
        b.v[at_j] -= all * p.inverse_mass_j;
        b.w[at_j] += g.lever_j * twist * p.inverse_moment_j;
        b.impulse[at_j] -= all;
        b.angular_impulse[at_j] += g.lever_j * twist;
        b.contact_impulse[at_j] -= contact;
    }
}

// What the pair remembers of this sub-step's contact. u_start, u_end: rate of overlap at the sub-step's ends.
inline void remember(PairState& s, const Window& w, double t, double h, double u_start, double u_end) {
    if (w.share() > 0) {
        if (s.phase == kApart) {
            s = PairState{{s.xi[0], s.xi[1], s.xi[2]}, kTouching, t + w.from * h, 0, 0, 0, 0, 0, 0};
            s.impact_speed = u_start;
        }
        s.phase = w.to < 1 ? kEnded : kTouching;
        s.end = t + w.to * h;
        s.rebound_speed = -u_end;
    } else if (s.phase == kTouching) {
        s.phase = kEnded;
    }
    if (s.phase != kTouching) s.xi[0] = s.xi[1] = s.xi[2] = 0;
}

// One pair, one sub-step; returns whether its contact is over (the surfaces have parted).
inline bool visit_pair(const BodyArrays& b, const Box& box, const Partners& p, const PairLaw& law,
                       PairState& s, const SubstepPlan& plan, double t, Progress& progress) {
    const double h = plan.h;
    const Geometry g = p.j < 0
                           ? wall_geometry(box, b.x + 3 * p.i, b.radius[p.i], static_cast<int>(-1 - p.j))
                           : sphere_geometry(box, b.x + 3 * p.i, b.x + 3 * p.j, b.radius[p.i], b.radius[p.j]);
    progress.min_gap = std::min(progress.min_gap, -g.overlap);
    double u = 0, acceleration = 0;  // spins have no part along the normal
    for (int d = 0; d < 3; ++d) {
        u += (b.v[3 * p.i + d] - p.vj[d]) * g.n[d];
        acceleration += (b.kick[3 * p.i + d] - p.kick_j[d]) * g.n[d];
    }
    const double u_mid = u - 0.5 * acceleration;
    const double lambda = law.film.mean_resistance(-g.overlap, 0.5 * h * u_mid);
    const Window w = contact_window(law, plan.zero_force, s.phase, g.overlap, u_mid, h);
    if (w.share() == 0 && lambda == 0 && s.phase == kApart) return false;

    const double inverse_mass = p.inverse_mass_i + p.inverse_mass_j;
    const NormalImpulse normal = normal_impulse(law, w, plan.zero_force, lambda, inverse_mass, u, u_mid, h);
    const double change = (normal.contact + normal.lubrication) * inverse_mass;
    double work = -normal.contact * (u_mid - 0.5 * change);
    double tangential[3] = {0, 0, 0};
    if (law.mu > 0 && w.share() > 0) {
        const double inverse_tangential = inverse_mass + g.lever_i * g.lever_i * p.inverse_moment_i +
                                          g.lever_j * g.lever_j * p.inverse_moment_j;
        double slip[3];
        slip_velocity(b, p, g, u_mid, slip);
        tangential_impulse(law, g.n, slip, inverse_tangential, h * w.share(), normal.contact, s.xi,
                           tangential);
        work -= dot(tangential, slip) - 0.5 * inverse_tangential * dot(tangential, tangential);
    }
    apply(b, p, g, normal, tangential);

    remember(s, w, t, h, u_mid + (w.from - 0.5) * acceleration, u - change - (1 - w.to) * acceleration);
    if (s.phase == kApart) return false;
    s.work += work;
    const double end = g.overlap + 0.5 * h * (u - change);
    s.overlap = end;
    s.max_overlap = std::max({s.max_overlap, g.overlap / p.smaller_diameter, end / p.smaller_diameter});
    progress.max_overlap = std::max(progress.max_overlap, s.max_overlap);
    return s.phase == kEnded && end <= 0;
}

inline void drift(const BodyArrays& b, std::int64_t id, double time) {
    for (std::int64_t c = 3 * id; c < 3 * id + 3; ++c) {
        b.x[c] += time * b.v[c];
        b.turn[c] += time * b.w[c];
    }
}

// Runs until the last sub-step, until `done` might overflow, or until a pair passes the overlap limit. Odd
// sub-steps visit the pairs backwards: what the order does then cancels to second order.
inline Progress run_substeps(const BodyArrays& b, const Box& box, const std::int32_t* active,
                             std::int64_t actives, const std::int32_t* pairs, const PairLaw* laws,
                             PairState* states, std::int64_t n_pairs, Finished* done,
                             const SubstepPlan& plan) {
    Progress progress{plan.first, 0, -1, std::numeric_limits<double>::infinity(), 0};
    for (; progress.next < plan.last && progress.failed < 0; ++progress.next) {
        if (plan.capacity - progress.finished < n_pairs) break;
        const double t = plan.time + static_cast<double>(progress.next) * plan.h;
        for (std::int64_t k = 0; k < actives; ++k) {
            drift(b, active[k], 0.5 * plan.h);
            for (std::int64_t c = 3L * active[k]; c < 3L * active[k] + 3; ++c) {
                b.v[c] += b.kick[c];
                b.w[c] += b.spin[c];
            }
        }
        for (std::int64_t k = 0; k < n_pairs; ++k) {
            const std::int64_t pair = progress.next % 2 ? n_pairs - 1 - k : k;
            PairState& s = states[pair];
            const Partners p = partners_of(b, box, pairs[2 * pair], pairs[2 * pair + 1]);
            if (visit_pair(b, box, p, laws[pair], s, plan, t, progress)) {
                done[progress.finished++] = {
                    static_cast<double>(pair), s.start, s.end, s.max_overlap, s.impact_speed,
                    s.rebound_speed,           s.work};
                s = PairState{};
            }
            if (s.overlap > plan.overlap_limit * p.smaller_diameter) progress.failed = pair;
        }
        for (std::int64_t k = 0; k < actives; ++k) drift(b, active[k], 0.5 * plan.h);
    }
    return progress;
}

// Turn a unit quaternion (w, x, y, z) by a rotation vector given in box axes.
inline void rotate_orientation(double* q, const double* turn) {
    const double angle = std::sqrt(dot(turn, turn));
    if (angle == 0) return;
    const double s = std::sin(0.5 * angle) / angle, c = std::cos(0.5 * angle);
    const double p[3] = {s * turn[0], s * turn[1], s * turn[2]};
    const double r[4] = {c * q[0] - p[0] * q[1] - p[1] * q[2] - p[2] * q[3],
                         c * q[1] + p[0] * q[0] + p[1] * q[3] - p[2] * q[2],
                         c * q[2] + p[1] * q[0] + p[2] * q[1] - p[0] * q[3],
                         c * q[3] + p[2] * q[0] + p[0] * q[2] - p[1] * q[1]};
    const double norm = 1 / std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int d = 0; d < 4; ++d) q[d] = norm * r[d];
}

// Ends the step of one body: orientation turned, position back into the box.
inline void settle(const Box& box, double* x, double* orientation, std::int64_t* crossings,
                   const double* turn) {
    rotate_orientation(orientation, turn);
    for (int d = 0; d < 3; ++d) {
        const double times = std::floor(x[d] * box.inverse_period[d]);
        if (times == 0 || !std::isfinite(times)) continue;
        x[d] -= times * box.period[d];
        if (x[d] >= box.period[d] || x[d] < 0) x[d] = 0;  // round-off beside the seam
        crossings[d] += static_cast<std::int64_t>(times);
    }
}

// The flight of a body that nothing touches, constant acceleration: what the sub-steps add up to without
// contacts.
inline void fly(double* x, double* v, double* w, double* turn, const double* force, const double* torque,
                double inverse_mass, double inverse_moment, double dt) {
    for (int d = 0; d < 3; ++d) {
        const double kick = dt * force[d] * inverse_mass, spin = dt * torque[d] * inverse_moment;
        x[d] += dt * (v[d] + 0.5 * kick);
        turn[d] = dt * (w[d] + 0.5 * spin);
        v[d] += kick;
        w[d] += spin;
    }
}

}  // namespace rdpm::contacts

// The driver over a contact law: bodies and pairs over the sub-steps of one step. Drift, velocity increments,
// drift; the pairs in fixed order, each impulse at once.
#pragma once
#include <array>
#include <limits>
#include <type_traits>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"
#include "rdpm/contacts/lubrication.hpp"

namespace rdpm::contacts {

// Ended: the force has vanished, the surfaces still overlap.
enum Phase : std::int64_t { kApart = 0, kTouching = 1, kEnded = 2 };

// What the driver remembers of a contact, whatever its law.
struct ContactState {
    std::int64_t phase;
    double start, end, impact_speed, rebound_speed, max_overlap, overlap, work;
};
inline constexpr std::array state_fields{
    RDPM_FIELD(ContactState, phase),         RDPM_FIELD(ContactState, start),
    RDPM_FIELD(ContactState, end),           RDPM_FIELD(ContactState, impact_speed),
    RDPM_FIELD(ContactState, rebound_speed), RDPM_FIELD(ContactState, max_overlap),
    RDPM_FIELD(ContactState, overlap),       RDPM_FIELD(ContactState, work)};

// One finished contact.
struct Finished {
    std::int64_t pair;
    double start, end, max_overlap, impact_speed, rebound_speed, work;
};
inline constexpr std::array finished_fields{
    RDPM_FIELD(Finished, pair),         RDPM_FIELD(Finished, start),
    RDPM_FIELD(Finished, end),          RDPM_FIELD(Finished, max_overlap),
    RDPM_FIELD(Finished, impact_speed), RDPM_FIELD(Finished, rebound_speed),
    RDPM_FIELD(Finished, work)};

struct BodyArrays {
    double *x, *v, *w, *rotation;  // (N, 3); rotation vector since the step began
    const double *dv, *dw;         // (N, 3): increments of a sub-step by the non-contact load
    const double *inverse_mass, *inverse_moment, *radius;  // (N,); zero inverses: a prescribed motion
    double *impulse, *angular_impulse, *contact_impulse;   // (N, 3), added to
};

// Rows of M pairs; `parameters` and `history` are those of the law.
struct PairArrays {
    const std::int32_t* ids;  // (M, 2)
    const void* parameters;
    const LubricationRow* lubrication;  // null without lubrication
    ContactState* state;
    void* history;
    std::int64_t count;
};

struct SubstepTask {
    BodyArrays bodies;
    Box box;
    const std::int32_t* active;  // bodies that have a pair
    std::int64_t actives;
    PairArrays pairs;
    Finished* finished;
    std::int64_t capacity;  // of `finished`
    double time, h, overlap_limit;
    std::int64_t first, last;
};

struct Progress {
    std::int64_t next, finished, failed;  // failed: the pair past the overlap limit, or -1
    double min_gap;
    double max_overlap;  // [-], of the smaller diameter
};

// A pair's partners as the driver sees them; a wall has no mass and no acceleration.
struct Partners {
    std::int64_t i, j;
    double inverse_mass_i, inverse_mass_j, inverse_moment_i, inverse_moment_j, smaller_diameter;
    const double *vj, *wj, *dv_j, *dw_j;
};

inline Partners partners_of(const BodyArrays& b, const Box& box, std::int64_t i, std::int64_t j) {
    static constexpr double none[3] = {0, 0, 0};
    Partners p{i,    j,   b.inverse_mass[i], 0, b.inverse_moment[i], 0, 2 * b.radius[i], nullptr, none,
               none, none};
    if (j < 0) {
        const int wall = static_cast<int>(-1 - j);
        p.vj = wall_velocity(box, wall);
        if (wall >= kFirstInner) p.wj = box.walls[wall - kFirstInner].angular_velocity;
    } else {
        p.inverse_mass_j = b.inverse_mass[j];
        p.inverse_moment_j = b.inverse_moment[j];
        p.smaller_diameter = 2 * std::min(b.radius[i], b.radius[j]);
        p.vj = b.v + 3 * j;
        p.wj = b.w + 3 * j;
        p.dv_j = b.dv + 3 * j;
        p.dw_j = b.dw + 3 * j;
    }
    return p;
}

// Normal impulses on i, against the normal.
struct Impulses {
    double contact, lubrication;
};

// The law's part is taken at the mean rate (implicit midpoint), lubrication at the rate after the impulse:
// stable whatever lambda h / m. u holds all of the sub-step's outer acceleration, u_mid half of it, so that a
// body at rest under its weight has exactly its static overlap and one that sinks through a narrow gap
// exactly the speed F/lambda.
inline Impulses solve_normal(const NormalImpulse& law, bool acts, double lambda, double inverse_mass,
                             double u, double u_mid, double h) {
    const double viscous = h * lambda * inverse_mass;
    const double all = (law.elastic + law.damping * u_mid + h * lambda * u) /
                       (1 + 0.5 * law.damping * inverse_mass + viscous);
    double contact = law.elastic + law.damping * (u_mid - 0.5 * all * inverse_mass);
    if (!acts || (!law.may_attract && contact < 0)) contact = 0;
    return {contact, h * lambda * (u - contact * inverse_mass) / (1 + viscous)};
}

// Tangential velocity of the surfaces against each other at the contact point, with half of this sub-step's
// increments; u_mid is the normal part.
inline void slip_velocity(const BodyArrays& b, const Partners& p, const Geometry& g, double u_mid,
                          double* slip) {
    const double *vi = b.v + 3 * p.i, *wi = b.w + 3 * p.i, *dv = b.dv + 3 * p.i, *dw = b.dw + 3 * p.i;
    double roll[3];
    for (int d = 0; d < 3; ++d)
        roll[d] = g.lever_i * (wi[d] - 0.5 * dw[d]) + g.lever_j * (p.wj[d] - 0.5 * p.dw_j[d]);
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        slip[d] = vi[d] - p.vj[d] - 0.5 * (dv[d] - p.dv_j[d]) - u_mid * g.n[d] + roll[e] * g.n[f] -
                  roll[f] * g.n[e];
    }
}

inline void apply(const BodyArrays& b, const Partners& p, const Geometry& g, const Impulses& normal,
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

// The contact's record after this sub-step. u_start, u_end: rate of overlap at the sub-step's ends.
inline void record(ContactState& s, const Window& w, double t, double h, double u_start, double u_end) {
    if (w.share() > 0) {
        if (s.phase == kApart) s = ContactState{kTouching, t + w.from * h, 0, u_start, 0, 0, 0, 0};
        s.phase = w.to < 1 ? kEnded : kTouching;
        s.end = t + w.to * h;
        s.rebound_speed = -u_end;
    } else if (s.phase == kTouching) {
        s.phase = kEnded;
    }
}

// One pair, one sub-step; returns whether its contact is over (the surfaces have parted).
template <ContactLaw Law>
bool visit_pair(const SubstepTask& task, const Partners& p, const typename Law::Parameters& row,
                const LubricationRow* lubrication, ContactState& s, typename Law::History& history, double t,
                Progress& progress) {
    const BodyArrays& b = task.bodies;
    const double h = task.h;
    const Geometry g =
        p.j < 0 ? wall_geometry(task.box, b.x + 3 * p.i, b.radius[p.i], static_cast<int>(-1 - p.j))
                : sphere_geometry(task.box, b.x + 3 * p.i, b.x + 3 * p.j, b.radius[p.i], b.radius[p.j]);
    progress.min_gap = std::min(progress.min_gap, -g.overlap);
    double u = 0, acceleration = 0;  // rotation has no part along the normal
    for (int d = 0; d < 3; ++d) {
        u += (b.v[3 * p.i + d] - p.vj[d]) * g.n[d];
        acceleration += (b.dv[3 * p.i + d] - p.dv_j[d]) * g.n[d];
    }
    const double u_mid = u - 0.5 * acceleration;
    const double lambda = lubrication ? lubrication->mean_resistance(-g.overlap, 0.5 * h * u_mid) : 0;
    const Approach approach{g.overlap, u_mid, h, s.phase == kTouching};
    const auto& law = row_of<Law>(row, history, approach);
    const Window w = Law::window(law, approach);
    if (w.share() == 0 && lambda == 0 && s.phase == kApart) return false;

    const double inverse_mass = p.inverse_mass_i + p.inverse_mass_j;
    const Impulses normal =
        solve_normal(Law::normal_impulse(law, w, h), w.share() != 0, lambda, inverse_mass, u, u_mid, h);
    const double change = (normal.contact + normal.lubrication) * inverse_mass;
    double work = -normal.contact * (u_mid - 0.5 * change);
    double tangential[3] = {0, 0, 0};
    if constexpr (TangentialLaw<Law>) {
        if (Law::has_friction(law) && w.share() > 0) {
            const double inverse_tangential = inverse_mass + g.lever_i * g.lever_i * p.inverse_moment_i +
                                              g.lever_j * g.lever_j * p.inverse_moment_j;
            double slip[3];
            slip_velocity(b, p, g, u_mid, slip);
            Law::tangential_impulse(law, history, w, g.n, slip, inverse_tangential, h, normal.contact,
                                    tangential);
            work -= dot(tangential, slip) - 0.5 * inverse_tangential * dot(tangential, tangential);
        }
    }
    apply(b, p, g, normal, tangential);

    Window touch = w;
    if constexpr (DistantLaw<Law>) touch = overlap_window({g.overlap, u_mid, h, false});
    record(s, touch, t, h, u_mid + (touch.from - 0.5) * acceleration,
           u - change - (1 - touch.to) * acceleration);
    if (s.phase != kTouching) history = typename Law::History{};
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
        b.rotation[c] += time * b.w[c];
    }
}

// Runs until the last sub-step, until `finished` might overflow, or until a pair passes the overlap limit.
// Odd sub-steps visit the pairs backwards: what the order does then cancels to second order.
template <ContactLaw Law>
Progress run_substeps(const SubstepTask& task) {
    const BodyArrays& b = task.bodies;
    const PairArrays& pairs = task.pairs;
    const auto* laws = static_cast<const typename Law::Parameters*>(pairs.parameters);
    auto* histories = static_cast<typename Law::History*>(pairs.history);
    typename Law::History nothing{};
    Progress progress{task.first, 0, -1, std::numeric_limits<double>::infinity(), 0};
    for (; progress.next < task.last && progress.failed < 0; ++progress.next) {
        if (task.capacity - progress.finished < pairs.count) break;
        const double t = task.time + static_cast<double>(progress.next) * task.h;
        for (std::int64_t k = 0; k < task.actives; ++k) {
            drift(b, task.active[k], 0.5 * task.h);
            for (std::int64_t c = 3L * task.active[k]; c < 3L * task.active[k] + 3; ++c) {
                b.v[c] += b.dv[c];
                b.w[c] += b.dw[c];
            }
        }
        for (std::int64_t k = 0; k < pairs.count; ++k) {
            const std::int64_t pair = progress.next % 2 ? pairs.count - 1 - k : k;
            ContactState& s = pairs.state[pair];
            typename Law::History* history = &nothing;
            if constexpr (!std::is_empty_v<typename Law::History>) history = histories + pair;
            const LubricationRow* lubrication = pairs.lubrication ? pairs.lubrication + pair : nullptr;
            const Partners p = partners_of(b, task.box, pairs.ids[2 * pair], pairs.ids[2 * pair + 1]);
            if (visit_pair<Law>(task, p, laws[pair], lubrication, s, *history, t, progress)) {
                task.finished[progress.finished++] = {pair,           s.start,         s.end, s.max_overlap,
                                                      s.impact_speed, s.rebound_speed, s.work};
                s = ContactState{};
            }
            if (s.overlap > task.overlap_limit * p.smaller_diameter) progress.failed = pair;
        }
        for (std::int64_t k = 0; k < task.actives; ++k) drift(b, task.active[k], 0.5 * task.h);
    }
    return progress;
}

// A compiled driver and the rows of its law. Also another shared object may hold one: the first member tells
// whether it was compiled against the same headers.
struct Kernel {
    std::size_t task_size;
    Progress (*run)(const SubstepTask&);
    Layout parameters, history;
};

template <ContactLaw Law>
constexpr Kernel kernel_of() {
    return {sizeof(SubstepTask), &run_substeps<Law>,
            layout_of<typename Law::Parameters>(Law::parameter_fields),
            layout_of<typename Law::History>(Law::history_fields)};
}

}  // namespace rdpm::contacts

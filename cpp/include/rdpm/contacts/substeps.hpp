// The driver over a contact law: bodies and pairs over the sub-steps of one step. Drift, velocity increments,
// drift; the pairs band by band in fixed order, each impulse at once.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

#include "rdpm/contacts/rotation.hpp"
#include "rdpm/contacts/substep_task.hpp"
#include "rdpm/contacts/tangential_lubrication.hpp"

namespace rdpm::contacts {

// A pair's partners as the driver sees them; a wall has no mass and no acceleration.
struct Partners {
    std::int64_t i, j;
    double inverse_mass_i, inverse_mass_j, inverse_moment_i, inverse_moment_j, smaller_diameter;
    const double *vj, *wj, *dv_j, *dw_j;
};

template <class Bodies>
Partners partners_of(const Bodies& b, const Box& box, std::int64_t i, std::int64_t j) {
    static constexpr double none[3] = {0, 0, 0};
    Partners p{
        i,    j,   b.inverse_mass_of(i), 0, b.inverse_moment_of(i), 0, 2 * b.radius_of(i), nullptr, none,
        none, none};
    if (j < 0) {
        const int wall = static_cast<int>(-1 - j);
        p.vj = wall_velocity(box, wall);
        if (wall >= kFirstInner) p.wj = box.walls[wall - kFirstInner].angular_velocity;
    } else {
        p.inverse_mass_j = b.inverse_mass_of(j);
        p.inverse_moment_j = b.inverse_moment_of(j);
        p.smaller_diameter = 2 * std::min(b.radius_of(i), b.radius_of(j));
        p.vj = b.velocity_of(j);
        p.wj = b.angular_velocity_of(j);
        p.dv_j = b.gain_of(j);
        p.dw_j = b.angular_gain_of(j);
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

inline double inverse_tangential_mass(const Partners& p, const Geometry& g, double inverse_mass) {
    const bool is_reversed = p.j >= 0 && points_up(g.n);
    const double one = g.lever_i * g.lever_i, other = g.lever_j * g.lever_j;
    const double first = multiply_add(is_reversed ? other : one,
                                      is_reversed ? p.inverse_moment_j : p.inverse_moment_i, inverse_mass);
    return multiply_add(is_reversed ? one : other, is_reversed ? p.inverse_moment_i : p.inverse_moment_j,
                        first);
}

// Tangential velocity of the surfaces against each other at the contact point, with half of this sub-step's
// increments; u_mid is the normal part.
inline void slip_velocity(const BodyBlock& b, const Partners& p, const Geometry& g, double u_mid,
                          double* slip) {
    const double *vi = b.velocity_of(p.i), *wi = b.angular_velocity_of(p.i), *dv = b.gain_of(p.i),
                 *dw = b.angular_gain_of(p.i);
    double roll[3];
    const bool is_reversed = p.j >= 0 && points_up(g.n);
    const double first = is_reversed ? g.lever_j : g.lever_i, last = is_reversed ? g.lever_i : g.lever_j;
    for (int d = 0; d < 3; ++d) {
        const double one = wi[d] - 0.5 * dw[d], other = p.wj[d] - 0.5 * p.dw_j[d];
        roll[d] = multiply_add(first, is_reversed ? other : one, last * (is_reversed ? one : other));
    }
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        slip[d] = vi[d] - p.vj[d] - 0.5 * (dv[d] - p.dv_j[d]) - u_mid * g.n[d] + roll[e] * g.n[f] -
                  roll[f] * g.n[e];
    }
}

template <class Bodies>
void apply(const Bodies& b, const Partners& p, const Geometry& g, const Impulses& normal,
           const double* tangential) {
    double contact[3], all[3], twist[3];
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        contact[d] = -normal.contact * g.n[d] - tangential[d];
        all[d] = contact[d] - normal.lubrication * g.n[d];
        twist[d] = -(g.n[e] * tangential[f] - g.n[f] * tangential[e]);
    }
    const auto add = [&](std::int64_t id, double sign, double inverse_mass, double inverse_moment,
                         double lever) {
        double *v = b.velocity_of(id), *w = b.angular_velocity_of(id), *impulse = b.impulse_of(id);
        double *angular = b.angular_impulse_of(id), *by_contact = b.contact_impulse_of(id);
        for (int d = 0; d < 3; ++d) {
            v[d] += sign * all[d] * inverse_mass;
            w[d] += lever * twist[d] * inverse_moment;
            impulse[d] += sign * all[d];
            angular[d] += lever * twist[d];
            by_contact[d] += sign * contact[d];
        }
    };
    add(p.i, 1, p.inverse_mass_i, p.inverse_moment_i, g.lever_i);
    if (p.j >= 0) add(p.j, -1, p.inverse_mass_j, p.inverse_moment_j, g.lever_j);
}

// Slip and roll of a pair, before what acts along its normal. Not inlined: a pair without lubrication is then
// compiled to the same arithmetic as if there were none.
[[gnu::noinline]] inline void lubricate_slip_and_roll(const SubstepTask& task, const std::int32_t* id,
                                                      const LubricationRow& row) {
    const BodyBlock& b = task.bodies;
    const Partners p = partners_of(b, task.box, id[0], id[1]);
    const double *xi = b.position_of(p.i), ai = b.radius_of(p.i);
    const Geometry g = p.j < 0 ? wall_geometry(task.box, xi, ai, static_cast<int>(-1 - p.j))
                               : sphere_geometry(task.box, xi, b.position_of(p.j), ai, b.radius_of(p.j));
    lubricate_tangentially(b, task.box, p, g, row, task.h, task.turned);
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
    const BodyBlock& b = task.bodies;
    const double h = task.h;
    const Geometry g =
        p.j < 0 ? wall_geometry(task.box, b.position_of(p.i), b.radius_of(p.i), static_cast<int>(-1 - p.j))
                : sphere_geometry(task.box, b.position_of(p.i), b.position_of(p.j), b.radius_of(p.i),
                                  b.radius_of(p.j));
    progress.min_gap = std::min(progress.min_gap, -g.overlap);
    double u = 0, acceleration = 0;  // rotation has no part along the normal
    const double *vi = b.velocity_of(p.i), *dv_i = b.gain_of(p.i);
    for (int d = 0; d < 3; ++d) {
        u += (vi[d] - p.vj[d]) * g.n[d];
        acceleration += (dv_i[d] - p.dv_j[d]) * g.n[d];
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
            const double inverse_tangential = inverse_tangential_mass(p, g, inverse_mass);
            double slip[3];
            slip_velocity(b, p, g, u_mid, slip);
            Law::tangential_impulse(law, history, w, g.n, slip, inverse_tangential, h, normal.contact,
                                    tangential);
            work -= dot(tangential, slip) - 0.5 * inverse_tangential * dot(tangential, tangential);
        }
    }
    apply(b, p, g, normal, tangential);
    if constexpr (RotationLaw<Law>)
        if (w.share() > 0) work += resist_rotation<Law>(b, p, g.n, law, w, h, normal.contact);

    Window touch = w;
    if constexpr (DistantLaw<Law>) touch = overlap_window({g.overlap, u_mid, h, false});
    record(s, touch, t, h, u_mid + (touch.from - 0.5) * acceleration,
           u - change - (1 - touch.to) * acceleration);
    if (s.phase != kTouching) history = typename Law::History{};
    if (s.phase == kApart) return false;
    s.work += work;
    const double end = g.overlap + 0.5 * h * (u - change);
    s.overlap = end;
    s.max_overlap = std::max(s.max_overlap, std::max(g.overlap, end) / p.smaller_diameter);
    progress.max_overlap = std::max(progress.max_overlap, s.max_overlap);
    return s.phase == kEnded && end <= 0;
}

// Sub-steps, this one first, in which a pair stays apart; 0 where it may touch in this one: gap < h |rate| /
// 2, told without a root or a quotient, a little on the safe side. `smallest`: lowered to the gap.
inline std::int32_t clear_substeps(const SubstepTask& task, const std::int32_t* id, double& smallest) {
    const BodyRow &one = task.bodies.rows[id[0]], &other = task.bodies.rows[id[1]];
    double r[3];
    nearest_image(task.box, one.x, other.x, r);
    const double square = dot(r, r), sum = one.radius + other.radius;
    double approach = 0;
    for (int d = 0; d < 3; ++d) approach += r[d] * (one.v[d] - other.v[d]);
    const double room = (square - (1 + 1e-12) * sum * sum) * sum;
    if (!(room > 0 && room >= task.h * (std::abs(approach) * sum + 0.5 * task.acceleration * square)))
        return 0;
    const double gap = std::sqrt(square) - sum;
    smallest = std::min(smallest, gap);
    if (task.pairs.count < kFewPairs) return 1;
    return static_cast<std::int32_t>(std::clamp(gap * task.inverse_closing, 1.0, 1e6));
}

// What the threads share. `failed`: sub-step and pair, as the key of the earliest one, the last of its pairs.
struct Shared {
    std::int64_t finished, failed;
    bool goes_on;
};
inline constexpr std::int64_t kNoFailure = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t kLowHalf = 0xffffffff;

// Pairs of the band that are looked at in this sub-step, in their order.
inline std::int64_t list_due(const SubstepTask& task, const Band& band, std::int64_t substep) {
    std::int32_t* due = task.due + band.from;
    std::int64_t count = 0;
    for (std::int32_t at = band.from; at < band.to; ++at) {
        due[count] = at;
        count += task.wake[at] <= substep;
    }
    return count;
}

// Returns whether no pair has passed the overlap limit.
template <ContactLaw Law>
bool visit_band(const SubstepTask& task, const Band& band, std::int64_t substep, Progress& mine,
                Shared& shared) {
    bool is_sound = true;
    const PairArrays& pairs = task.pairs;
    const auto* laws = static_cast<const typename Law::Parameters*>(pairs.parameters);
    auto* histories = static_cast<typename Law::History*>(pairs.history);
    typename Law::History nothing{};
    const double t = task.time + static_cast<double>(substep) * task.h;
    const bool is_backwards = substep % 2 != 0;
    const std::int64_t count = list_due(task, band, substep);
    const std::int32_t* due = task.due + band.from;
    for (std::int64_t n = 0; n < count; ++n) {
        const std::int32_t at = due[is_backwards ? count - 1 - n : n];
        const std::int32_t* id = pairs.ids + 2 * at;
        if constexpr (!DistantLaw<Law>)
            if (!pairs.lubrication && task.wake[at] != kUnderWay && id[1] >= 0)
                if (const std::int32_t clear = clear_substeps(task, id, mine.min_gap); clear > 0) {
                    task.wake[at] = static_cast<std::int32_t>(substep) + clear;
                    continue;
                }
        const std::int64_t row = task.rows[at];
        ContactState& s = pairs.state[row];
        typename Law::History* history = &nothing;
        if constexpr (!std::is_empty_v<typename Law::History>) history = histories + row;
        const LubricationRow* lubrication = pairs.lubrication ? pairs.lubrication + row : nullptr;
        const Partners p = partners_of(task.bodies, task.box, id[0], id[1]);
        if (lubrication) lubricate_slip_and_roll(task, id, *lubrication);
        if (visit_pair<Law>(task, p, laws[task.kinds[row]], lubrication, s, *history, t, mine)) {
            std::int64_t place;
#pragma omp atomic capture
            place = shared.finished++;
            task.finished[place] = {substep << 32 | row, s.start,         s.end, s.max_overlap,
                                    s.impact_speed,      s.rebound_speed, s.work};
            s = ContactState{};
        }
        task.wake[at] = s.phase == kApart ? 0 : kUnderWay;
        if (s.overlap > task.overlap_limit * p.smaller_diameter) {
#pragma omp critical(rdpm_overlap)
            shared.failed = std::min(shared.failed, substep << 32 | (kLowHalf - row));
            is_sound = false;
        }
    }
    return is_sound;
}

// Half a sub-step of drift, or two halves, between which nothing changes the velocities. Then the increments.
inline void drift(const SubstepTask& task, std::int64_t first, std::int64_t last, bool is_twice,
                  bool has_increments) {
    const double half = 0.5 * task.h;
    for (std::int64_t i = first; i < last; ++i) {
        BodyRow& b = task.bodies.rows[i];
        for (int d = 0; d < 3; ++d) {
            double x = b.x[d] + half * b.v[d], rotation = b.rotation[d] + half * b.w[d];
            if (is_twice) {
                x += half * b.v[d];
                rotation += half * b.w[d];
            }
            b.x[d] = x;
            b.rotation[d] = rotation;
            if (has_increments) {
                b.v[d] += b.dv[d];
                b.w[d] += b.dw[d];
            }
        }
    }
}

// Calls visit(band, drifts) for every group of a colour, by any thread; drifts(...) moves its bodies.
template <class Visit>
void for_each_group(const SubstepTask& task, bool is_odd, Visit&& visit) {
    const Groups& groups = task.groups[is_odd];
#pragma omp for schedule(dynamic)
    for (std::int64_t n = 0; n < groups.count; ++n) {
        const Group& group = groups.rows[n];
        visit(group.band, [&](bool is_twice, bool has_increments) {
            drift(task, group.first, group.last, is_twice, has_increments);
            if (n + 1 == groups.count) drift(task, 0, groups.wrapped, is_twice, has_increments);
        });
    }
}

// Finished contacts in the order of their sub-steps, by pair, in odd sub-steps backwards.
inline void sort_finished(Finished* finished, std::int64_t count) {
    const auto key = [](const Finished& f) {
        return (f.pair >> 32) % 2 ? f.pair ^ kLowHalf : f.pair;  // a pair is below 2^31
    };
    std::sort(finished, finished + count,
              [&](const Finished& a, const Finished& b) { return key(a) < key(b); });
    for (std::int64_t n = 0; n < count; ++n) finished[n].pair &= kLowHalf;
}

// Runs until the last sub-step, until `finished` might overflow, or until a pair passes the overlap limit.
// Even bands, then odd ones, each from its first pair; odd sub-steps run all of it backwards: what the order
// does then cancels to second order. Bands of one colour share no body, so any thread may take any of them. A
// sub-step ends with the colour that the next begins with: a group has its part of both and the drift between
// them in one go, while its bodies are in the cache.
template <ContactLaw Law>
Progress run_substeps(const SubstepTask& task) {
    constexpr double none = std::numeric_limits<double>::infinity();
    Progress all{task.first, 0, -1, none, 0};
    if (task.first >= task.last) return all;
    Shared shared{0, kNoFailure, false};
#pragma omp parallel num_threads(task.threads) if (task.threads > 1)
    {
        Progress mine{task.first, 0, -1, none, 0};
        for_each_group(task, mine.next % 2 != 0, [&](const Band& band, auto&& drifts) {
            drifts(false, true);
            visit_band<Law>(task, band, mine.next, mine, shared);
        });
        for (bool goes_on = true; goes_on; ++mine.next) {
            // Room for the end of this sub-step and for all of the next.
#pragma omp single
            shared.goes_on = mine.next + 1 < task.last && shared.failed == kNoFailure &&
                             task.capacity - shared.finished >= 3 * task.pairs.count;
            goes_on = shared.goes_on;
            for_each_group(task, mine.next % 2 == 0, [&](const Band& band, auto&& drifts) {
                const bool is_sound = visit_band<Law>(task, band, mine.next, mine, shared);
                drifts(goes_on, goes_on);
                if (goes_on && is_sound) visit_band<Law>(task, band, mine.next + 1, mine, shared);
            });
        }
#pragma omp critical(rdpm_progress)
        {
            all.next = mine.next;
            all.min_gap = std::min(all.min_gap, mine.min_gap);
            all.max_overlap = std::max(all.max_overlap, mine.max_overlap);
        }
    }
    all.finished = shared.finished;
    sort_finished(task.finished, all.finished);
    if (shared.failed != kNoFailure) {
        all.failed = kLowHalf - (shared.failed & kLowHalf);
        all.next = (shared.failed >> 32) + 1;
    }
    return all;
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

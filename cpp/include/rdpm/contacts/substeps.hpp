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

// a b + c, rounded once where the machine can: the compiler is not left to choose which product it fuses.
inline double multiply_add(double a, double b, double c) {
#ifdef FP_FAST_FMA
    return std::fma(a, b, c);
#else
    return a * b + c;
#endif
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
inline void slip_velocity(const BodyArrays& b, const Partners& p, const Geometry& g, double u_mid,
                          double* slip) {
    const double *vi = b.v + 3 * p.i, *wi = b.w + 3 * p.i, *dv = b.dv + 3 * p.i, *dw = b.dw + 3 * p.i;
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

// Slip and roll of a pair, before what acts along its normal. Not inlined: a pair without lubrication is then
// compiled to the same arithmetic as if there were none.
[[gnu::noinline]] inline void lubricate_slip_and_roll(const SubstepTask& task, const std::int32_t* id,
                                                      const LubricationRow& row) {
    const BodyArrays& b = task.bodies;
    const Partners p = partners_of(b, task.box, id[0], id[1]);
    const double *xi = b.x + 3 * p.i, ai = b.radius[p.i];
    const Geometry g = p.j < 0 ? wall_geometry(task.box, xi, ai, static_cast<int>(-1 - p.j))
                               : sphere_geometry(task.box, xi, b.x + 3 * p.j, ai, b.radius[p.j]);
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
    s.max_overlap = std::max({s.max_overlap, g.overlap / p.smaller_diameter, end / p.smaller_diameter});
    progress.max_overlap = std::max(progress.max_overlap, s.max_overlap);
    return s.phase == kEnded && end <= 0;
}

// Sub-steps, this one first, in which a pair stays apart; 0 where it may touch in this one: gap < h |rate| /
// 2, told without a root or a quotient, a little on the safe side. `smallest`: gap that is to be known where
// one is smaller.
inline std::int32_t clear_substeps(const SubstepTask& task, const std::int32_t* id, double& smallest) {
    const BodyArrays& b = task.bodies;
    const std::int64_t i = id[0], j = id[1];
    double r[3];
    nearest_image(task.box, b.x + 3 * i, b.x + 3 * j, r);
    const double square = dot(r, r), sum = b.radius[i] + b.radius[j], reach = sum + smallest;
    if (!(square > (1 + 1e-12) * sum * sum)) return 0;
    double approach = 0;
    for (int d = 0; d < 3; ++d) approach += r[d] * (b.v[3 * i + d] - b.v[3 * j + d]);
    const double room = (square - (1 + 1e-12) * sum * sum) * sum;
    if (!(room >= task.h * (std::abs(approach) * sum + 0.5 * task.acceleration * square))) return 0;
    const bool is_smaller = reach > 0 && square < (1 + 1e-12) * reach * reach;
    if (!is_smaller && task.pairs.count < kFewPairs) return 1;
    const double gap = std::sqrt(square) - sum, step = task.h * task.closing;
    if (is_smaller) smallest = std::min(smallest, gap);
    return task.pairs.count < kFewPairs || !(gap >= step)
               ? 1
               : static_cast<std::int32_t>(std::min(gap / step, 1e6));
}

// What the threads of a sub-step share.
struct Shared {
    std::int64_t finished, failed;
};

template <ContactLaw Law>
void visit_band(const SubstepTask& task, const Band& band, std::int64_t substep, Progress& mine,
                Shared& shared) {
    const PairArrays& pairs = task.pairs;
    const auto* laws = static_cast<const typename Law::Parameters*>(pairs.parameters);
    auto* histories = static_cast<typename Law::History*>(pairs.history);
    typename Law::History nothing{};
    const double t = task.time + static_cast<double>(substep) * task.h;
    const bool is_backwards = substep % 2 != 0;
    for (std::int64_t n = 0; n < band.to - band.from; ++n) {
        const std::int64_t at = is_backwards ? band.to - 1 - n : band.from + n;
        const std::int32_t* id = pairs.ids + 2 * at;
        if (task.wake[at] > substep) continue;
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
            task.finished[place] = {row,   s.start, s.end, s.max_overlap, s.impact_speed, s.rebound_speed,
                                    s.work};
            s = ContactState{};
        }
        task.wake[at] = s.phase == kApart ? 0 : kUnderWay;
        if (s.overlap > task.overlap_limit * p.smaller_diameter) {
#pragma omp critical(rdpm_overlap)
            shared.failed = std::max(shared.failed, row);
        }
    }
}

// Half a sub-step of drift twice, or once; between them nothing changes the velocities. Then the increments.
inline void drift(const SubstepTask& task, bool is_twice, bool has_increments) {
    const BodyArrays& b = task.bodies;
    const double half = 0.5 * task.h;
#pragma omp for schedule(static)
    for (std::int64_t c = 0; c < 3 * task.body_count; ++c) {
        double x = b.x[c] + half * b.v[c], rotation = b.rotation[c] + half * b.w[c];
        if (is_twice) {
            x += half * b.v[c];
            rotation += half * b.w[c];
        }
        b.x[c] = x;
        b.rotation[c] = rotation;
        if (has_increments) {
            b.v[c] += b.dv[c];
            b.w[c] += b.dw[c];
        }
    }
}

// Runs until the last sub-step, until `finished` might overflow, or until a pair passes the overlap limit.
// Even bands, then odd ones, each from its first pair; odd sub-steps run all of it backwards: what the order
// does then cancels to second order. Bands of one colour share no body, so any thread may take any of them.
template <ContactLaw Law>
Progress run_substeps(const SubstepTask& task) {
    constexpr double none = std::numeric_limits<double>::infinity();
    Progress all{task.first, 0, -1, none, 0};
    Shared shared{0, -1};
#pragma omp parallel num_threads(task.threads) if (task.threads > 1)
    {
        Progress mine{task.first, 0, -1, none, 0};
        while (mine.next < task.last && shared.failed < 0 &&
               task.capacity - shared.finished >= task.pairs.count) {
            const std::int64_t before = shared.finished;
            drift(task, mine.next > task.first, true);
            for (int pass = 0; pass < 2; ++pass) {
                const bool is_odd = (pass + mine.next) % 2 != 0;
                const Band* bands = task.bands + (is_odd ? task.band_counts[0] : 0);
#pragma omp for schedule(dynamic)
                for (std::int64_t n = 0; n < task.band_counts[is_odd]; ++n)
                    visit_band<Law>(task, bands[n], mine.next, mine, shared);
            }
            // In one order on any number of threads.
            const bool is_backwards = mine.next % 2 != 0;
#pragma omp single
            std::sort(task.finished + before, task.finished + shared.finished,
                      [&](const Finished& a, const Finished& b) {
                          return is_backwards ? a.pair > b.pair : a.pair < b.pair;
                      });
            ++mine.next;
        }
        if (mine.next > task.first) drift(task, false, false);
#pragma omp critical(rdpm_progress)
        {
            all.next = mine.next;
            all.min_gap = std::min(all.min_gap, mine.min_gap);
            all.max_overlap = std::max(all.max_overlap, mine.max_overlap);
        }
    }
    all.finished = shared.finished;
    all.failed = shared.failed;
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

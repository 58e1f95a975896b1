// Contacts at rest between collisions of hard spheres: the impulses that stop what closes, and the forces
// that hold what lies still.
#pragma once
#include "rdpm/contacts/events.hpp"

namespace rdpm::contacts {

// Projected Gauss-Seidel over the cluster, equations (8) and (9): no pair closes, none pulls, friction
// within its cone.
inline void EventLoop::solve_impulses() {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double change = 0;
        for (std::int64_t n = 0; n < clustered_; ++n) {
            const std::int64_t at = sweep % 2 ? clustered_ - 1 - n : n;
            change = std::max(change, relax(task_.cluster[at]));
        }
        if (change <= 1e-3 * task_.quiet) return;
    }
}

inline double EventLoop::relax(std::int64_t k) {
    PairWork& w = task_.pair_work[k];
    const Partners p = partners(k);
    const double inverse_mass = p.inverse_mass_i + p.inverse_mass_j;
    const double u = closing(p, w.n);
    const double normal = std::max(0.0, w.normal + u / inverse_mass);
    double tangential[3] = {0, 0, 0};
    if (laws_[k].friction > 0) {
        double s[3];
        slip_at(b_, p, w.n, w.lever_i, w.lever_j, u, s);
        for (int d = 0; d < 3; ++d) tangential[d] = w.tangential[d] + s[d] / w.inverse_tangential;
        const double size = std::sqrt(dot(tangential, tangential)), limit = laws_[k].friction * normal;
        if (size > limit)
            for (double& c : tangential) c *= limit / size;
    }
    double step[3];
    for (int d = 0; d < 3; ++d) step[d] = tangential[d] - w.tangential[d];
    push(p, w, normal - w.normal, step, false);
    const double change = std::abs(normal - w.normal) * inverse_mass;
    w.normal = normal;
    for (int d = 0; d < 3; ++d) w.tangential[d] = tangential[d];
    return std::max(change, w.inverse_tangential * std::sqrt(dot(step, step)));
}

inline void EventLoop::stop_closing() {
    for (std::int64_t at = 0; at < clustered_; ++at) {
        PairWork& w = task_.pair_work[task_.cluster[at]];
        w.normal = w.tangential[0] = w.tangential[1] = w.tangential[2] = 0;
    }
    solve_impulses();
    for (std::int64_t at = 0; at < clustered_; ++at) {
        const std::int64_t k = task_.cluster[at];
        const PairWork& w = task_.pair_work[k];
        push(partners(k), w, w.normal, w.tangential, true);
    }
}

inline void EventLoop::hold() {
    std::int64_t kept = 0;
    for (std::int64_t at = 0; at < clustered_; ++at) {
        const std::int64_t k = task_.cluster[at];
        const Partners p = partners(k);
        const double u = closing(p, task_.pair_work[k].n);
        task_.pairs.state[k].rebound_speed = -u;
        const bool is_open = is_opening(u) || -meet(p).overlap > kRestGap * p.smaller_diameter;
        if (is_open && may_bounce(k))
            release(k);
        else
            task_.cluster[kept++] = static_cast<std::int32_t>(k);
    }
    clustered_ = kept;
    const double left = task_.length - now_;
    for (std::int64_t at = 0; at < bodies_; ++at) {
        BodyWork& work = task_.body_work[task_.cluster_bodies[at]];
        for (int d = 0; d < 3; ++d) {
            const std::int64_t c = 3L * task_.cluster_bodies[at] + d;
            work.force[d] = work.torque[d] = 0;
            work.v[d] = b_.v[c];
            work.w[d] = b_.w[c];
            b_.v[c] += left * b_.dv[c];
            b_.w[c] += left * b_.dw[c];
        }
    }
    for (std::int64_t at = 0; at < clustered_; ++at) {  // as in the step before
        const std::int64_t k = task_.cluster[at];
        PairWork& w = task_.pair_work[k];
        w.normal = left * histories_[k].normal;
        for (int d = 0; d < 3; ++d) w.tangential[d] = left * histories_[k].tangential[d];
        push(partners(k), w, w.normal, w.tangential, false);
    }
    solve_impulses();
    for (std::int64_t at = 0; at < bodies_; ++at)
        for (int d = 0; d < 3; ++d) {
            const std::int64_t id = task_.cluster_bodies[at];
            b_.v[3 * id + d] = task_.body_work[id].v[d];
            b_.w[3 * id + d] = task_.body_work[id].w[d];
        }
    for (std::int64_t at = 0; at < clustered_; ++at) set_force(task_.cluster[at], left);
}

inline void EventLoop::set_force(std::int64_t k, double left) {
    PairWork& w = task_.pair_work[k];
    histories_[k].normal = w.normal / left;
    for (int d = 0; d < 3; ++d) histories_[k].tangential[d] = w.tangential[d] / left;
    const double* t = histories_[k].tangential;
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        w.force[d] = -histories_[k].normal * w.n[d] - t[d];
        w.twist[d] = -(w.n[e] * t[f] - w.n[f] * t[e]);
    }
    add_force(k, partners(k), 1);
    w.is_held = true;
    task_.pairs.state[k].end = task_.start + task_.length;
}

}  // namespace rdpm::contacts

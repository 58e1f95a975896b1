// The driver of hard spheres: collisions in order of time over one interval, contacts at rest as constant
// forces between them.
#pragma once
#include "rdpm/contacts/event_task.hpp"

namespace rdpm::contacts {

// Of the smaller diameter: a contact at rest ends where its gap is wider.
inline constexpr double kRestGap = 1e-7;

// Of the rest speed: one that opens faster ends too.
inline constexpr double kOpening = 0.1;
inline constexpr int kMostSweeps = 50;

class EventLoop {
  public:
    explicit EventLoop(const EventTask& task)
        : task_(task),
          b_(task.bodies),
          laws_(static_cast<const HardSphere::Parameters*>(task.pairs.parameters)),
          histories_(static_cast<HardSphere::History*>(task.pairs.history)),
          schedule_(task.due, task.tree, task.pairs.count) {
        for (std::int64_t k = 0; k < task.actives; ++k) task.body_work[task.active[k]] = BodyWork{};
        std::fill(task.pair_work, task.pair_work + task.pairs.count, PairWork{});
    }

    Events run() {
        const std::int64_t m = task_.pairs.count;
        if (task_.pairs.lubrication && task_.is_new)
            for (std::int64_t k = 0; k < m; ++k) {
                lubricate(k);
                const Partners p = partners(k);
                lubricate_tangentially(b_, task_.box, p, meet(p), task_.pairs.lubrication[k], task_.length,
                                       task_.turned);
            }
        for (std::int64_t k = 0; k < m; ++k) predict(k);
        while (m > 0 && task_.capacity - out_.finished > m + 2) {
            const std::int64_t k = schedule_.first();
            if (!(schedule_.time(k) < task_.length)) {
                now_ = task_.length;
                break;
            }
            now_ = std::max(now_, schedule_.time(k));
            visit(k);
        }
        for (std::int64_t k = 0; k < task_.actives; ++k) advance(task_.active[k]);
        out_.reached = now_;
        return out_;
    }

  private:
    bool is_at_rest(std::int64_t k) const { return task_.pairs.state[k].phase == kTouching; }
    bool is_opening(double u) const { return -u > std::max(task_.quiet, kOpening * task_.rest_speed); }
    bool may_bounce(std::int64_t k) const { return task_.events[k] < task_.most_events; }
    Partners partners(std::int64_t k) const {
        return partners_of(b_, task_.box, task_.pairs.ids[2 * k], task_.pairs.ids[2 * k + 1]);
    }

    // A body's state to the present, on its parabola.
    void advance(std::int64_t id) {
        BodyWork& work = task_.body_work[id];
        const double s = now_ - work.time;
        if (s <= 0) return;
        work.time = now_;
        for (std::int64_t d = 0; d < 3; ++d) {
            const std::int64_t c = 3 * id + d;
            const double dv = s * (b_.dv[c] + work.force[d] * b_.inverse_mass[id]);
            const double dw = s * (b_.dw[c] + work.torque[d] * b_.inverse_moment[id]);
            b_.x[c] += s * (b_.v[c] + 0.5 * dv);
            b_.v[c] += dv;
            b_.rotation[c] += s * (b_.w[c] + 0.5 * dw);
            b_.w[c] += dw;
            b_.impulse[c] += s * work.force[d];
            b_.contact_impulse[c] += s * work.force[d];
            b_.angular_impulse[c] += s * work.torque[d];
        }
    }

    // Both partners at present; the pair's geometry is returned.
    Geometry meet(const Partners& p) {
        advance(p.i);
        if (p.j < 0)
            return wall_geometry(task_.box, b_.x + 3 * p.i, b_.radius[p.i], static_cast<int>(-1 - p.j));
        advance(p.j);
        return sphere_geometry(task_.box, b_.x + 3 * p.i, b_.x + 3 * p.j, b_.radius[p.i], b_.radius[p.j]);
    }

    double closing(const Partners& p, const double* n) const { return closing_speed(b_, p, n); }

    double acceleration(std::int64_t id, int d) const {
        return b_.dv[3 * id + d] + task_.body_work[id].force[d] * b_.inverse_mass[id];
    }

    // When the pair will touch; one at rest is due at once where it has been set in motion.
    void predict(std::int64_t k) {
        const Partners p = partners(k);
        const Geometry g = meet(p);
        const double left = task_.length - now_;
        if (is_at_rest(k)) {
            const double u = closing(p, g.n);
            const bool is_due = !task_.pair_work[k].is_held || u > task_.quiet || is_opening(u);
            schedule_.set(k, is_due ? now_ : kNever);
            return;
        }
        double r[3], u[3], a[3];
        for (int d = 0; d < 3; ++d) {
            u[d] = p.vj[d] - b_.v[3 * p.i + d];
            a[d] = (p.j < 0 ? 0 : acceleration(p.j, d)) - acceleration(p.i, d);
        }
        double wait = kNever;
        if (p.j < 0) {
            wait = time_to_wall(task_.box, static_cast<int>(-1 - p.j), g, u, a, b_.radius[p.i], left);
        } else {
            nearest_image(task_.box, b_.x + 3 * p.i, b_.x + 3 * p.j, r);
            wait = time_to_touch(r, u, a, b_.radius[p.i] + b_.radius[p.j], left);
        }
        schedule_.set(k, wait < left ? now_ + wait : kNever);
    }

    void predict_all_of(std::int64_t id) {
        if (id < 0) return;
        for (std::int32_t at = task_.first[id]; at < task_.first[id + 1]; ++at) predict(task_.incident[at]);
    }

    // Linearly implicit over what is left of the interval, the mean resistance of the path ahead.
    void lubricate(std::int64_t k) {
        if (is_at_rest(k)) return;
        const Partners p = partners(k);
        const Geometry g = meet(p);
        const double h = task_.length - now_, inverse_mass = p.inverse_mass_i + p.inverse_mass_j;
        double a = 0;
        for (int d = 0; d < 3; ++d)
            a += (acceleration(p.i, d) - (p.j < 0 ? 0 : acceleration(p.j, d))) * g.n[d];
        const double u = closing(p, g.n), half_path = 0.5 * h * (u + 0.5 * h * a);
        const double lambda = task_.pairs.lubrication[k].mean_resistance(-g.overlap - half_path, half_path);
        if (lambda == 0) return;
        const double none[3] = {0, 0, 0};
        const double size = h * lambda * (u + h * a) / (1 + h * lambda * inverse_mass);
        apply(b_, p, g, {0, size}, none);
    }

    void visit(std::int64_t k) {
        const Partners p = partners(k);
        const Geometry g = meet(p);
        if (is_at_rest(k)) {
            solve_rest(k);
            return;
        }
        const double u = closing(p, g.n);
        if (u >= task_.rest_speed && u > 0 && may_bounce(k)) {
            collide(k);
            return;
        }
        ++out_.rested;
        if (!may_bounce(k)) ++out_.capped;
        ++task_.events[k];
        const double t = task_.start + now_;
        task_.pairs.state[k] = ContactState{kTouching, t, t, std::max(u, 0.0), 0, 0, 0, 0};
        histories_[k] = HardSphere::History{};
        solve_rest(k);
    }

    void collide(std::int64_t k) {
        release(k);
        const Partners p = partners(k);
        const Geometry g = meet(p);
        const double u = closing(p, g.n), inverse_mass = p.inverse_mass_i + p.inverse_mass_j;
        const double inverse_tangential = inverse_tangential_mass(p, g, inverse_mass);
        double s[3];
        slip_at(b_, p, g.n, g.lever_i, g.lever_j, u, s);
        const CollisionImpulse j = collision_impulse(laws_[k], u, s, inverse_mass, inverse_tangential);
        apply(b_, p, g, {j.normal, 0}, j.tangential);
        const double work = -j.normal * (u - 0.5 * j.normal * inverse_mass) - dot(j.tangential, s) +
                            0.5 * inverse_tangential * dot(j.tangential, j.tangential);
        const double t = task_.start + now_;
        task_.finished[out_.finished++] = {k, t, t, 0, u, -closing(p, g.n), work};
        ++out_.collisions;
        ++task_.events[k];
        if (task_.pairs.lubrication) lubricate(k);
        predict_all_of(p.i);
        predict_all_of(p.j);
    }

    // A contact at rest ends: its force too.
    void release(std::int64_t k) {
        ContactState& s = task_.pairs.state[k];
        if (s.phase == kApart) return;
        const Partners p = partners(k);
        add_force(k, p, -1);
        task_.pair_work[k] = PairWork{};
        task_.finished[out_.finished++] = {
            k, s.start, task_.start + now_, 0, s.impact_speed, s.rebound_speed, s.work};
        s = ContactState{};
        histories_[k] = HardSphere::History{};
        let_go(p.i);
        let_go(p.j);
    }

    // What was at rest against a body is to be solved again.
    void let_go(std::int64_t id) {
        if (id < 0 || b_.inverse_mass[id] == 0) return;
        for (std::int32_t at = task_.first[id]; at < task_.first[id + 1]; ++at)
            task_.pair_work[task_.incident[at]].is_held = false;
    }

    void add_force(std::int64_t k, const Partners& p, double sign) {
        const PairWork& w = task_.pair_work[k];
        for (int d = 0; d < 3; ++d) {
            task_.body_work[p.i].force[d] += sign * w.force[d];
            task_.body_work[p.i].torque[d] += sign * w.lever_i * w.twist[d];
            if (p.j < 0) continue;
            task_.body_work[p.j].force[d] -= sign * w.force[d];
            task_.body_work[p.j].torque[d] += sign * w.lever_j * w.twist[d];
        }
    }

    // All contacts at rest that hang together through bodies that can move, and these bodies.
    void gather(std::int64_t from) {
        clustered_ = bodies_ = 0;
        const auto add_body = [&](std::int64_t id) {
            if (id < 0 || task_.is_body_marked[id] || b_.inverse_mass[id] == 0) return;
            task_.is_body_marked[id] = true;
            task_.cluster_bodies[bodies_++] = static_cast<std::int32_t>(id);
            for (std::int32_t at = task_.first[id]; at < task_.first[id + 1]; ++at) {
                const std::int32_t k = task_.incident[at];
                if (task_.is_marked[k] || !is_at_rest(k)) continue;
                task_.is_marked[k] = true;
                task_.cluster[clustered_++] = k;
            }
        };
        add_body(task_.pairs.ids[2 * from]);
        add_body(task_.pairs.ids[2 * from + 1]);
        for (std::int64_t at = 0; at < clustered_; ++at) {
            add_body(task_.pairs.ids[2 * task_.cluster[at]]);
            add_body(task_.pairs.ids[2 * task_.cluster[at] + 1]);
        }
        for (std::int64_t at = 0; at < clustered_; ++at) task_.is_marked[task_.cluster[at]] = false;
        for (std::int64_t at = 0; at < bodies_; ++at) task_.is_body_marked[task_.cluster_bodies[at]] = false;
    }

    // Contacts at rest around pair k: the fastest that may bounce does; else all stop closing, those that
    // open are released, and the others get the force that keeps them closed until the interval ends.
    void solve_rest(std::int64_t k) {
        gather(k);
        std::int64_t fastest = -1;
        double largest = task_.quiet;
        bool is_closing = false;
        for (std::int64_t at = 0; at < clustered_; ++at) {
            const std::int64_t c = task_.cluster[at];
            const Partners p = partners(c);
            const double u = closing(p, meet(p).n);
            is_closing = is_closing || u > task_.quiet;
            if (u > largest && u >= task_.rest_speed && may_bounce(c)) {
                largest = u;
                fastest = c;
            }
        }
        if (fastest >= 0) {
            collide(fastest);
            predict(k);
            return;
        }
        for (std::int64_t at = 0; at < clustered_; ++at) place(task_.cluster[at]);
        if (is_closing) stop_closing();
        hold();
        for (std::int64_t at = 0; at < clustered_; ++at) schedule_.set(task_.cluster[at], kNever);
        // What else these bodies meet, and what was released.
        for (std::int64_t at = 0; at < bodies_; ++at) {
            const std::int64_t id = task_.cluster_bodies[at];
            for (std::int32_t n = task_.first[id]; n < task_.first[id + 1]; ++n)
                if (!is_at_rest(task_.incident[n])) predict(task_.incident[n]);
        }
    }

    void place(std::int64_t k) {
        const Partners p = partners(k);
        const Geometry g = meet(p);
        PairWork& w = task_.pair_work[k];
        add_force(k, p, -1);
        for (int d = 0; d < 3; ++d) w.n[d] = g.n[d], w.force[d] = w.twist[d] = 0;
        w.lever_i = g.lever_i;
        w.lever_j = g.lever_j;
        w.inverse_tangential = inverse_tangential_mass(p, g, p.inverse_mass_i + p.inverse_mass_j);
    }

    // Velocities of both by impulses of a pair, recorded or not.
    void push(const Partners& p, const PairWork& w, double normal, const double* tangential,
              bool is_recorded) {
        for (int d = 0; d < 3; ++d) {
            const int e = (d + 1) % 3, f = (d + 2) % 3;
            const double all = -normal * w.n[d] - tangential[d];
            const double twist = -(w.n[e] * tangential[f] - w.n[f] * tangential[e]);
            for (int side = 0; side < (p.j < 0 ? 1 : 2); ++side) {
                const std::int64_t c = 3 * (side ? p.j : p.i) + d;
                const double share = side ? -all : all, turn = (side ? w.lever_j : w.lever_i) * twist;
                if (is_recorded) {
                    b_.impulse[c] += share;
                    b_.contact_impulse[c] += share;
                    b_.angular_impulse[c] += turn;
                } else {
                    b_.v[c] += share * (side ? p.inverse_mass_j : p.inverse_mass_i);
                    b_.w[c] += turn * (side ? p.inverse_moment_j : p.inverse_moment_i);
                }
            }
        }
    }

    // In contacts/rest.hpp.
    void solve_impulses();
    double relax(std::int64_t k);
    void stop_closing();
    void hold();
    void set_force(std::int64_t k, double left);

    const EventTask& task_;
    const BodyArrays& b_;
    const HardSphere::Parameters* laws_;
    HardSphere::History* histories_;
    Schedule schedule_;
    double now_ = 0;
    std::int64_t clustered_ = 0, bodies_ = 0;
    Events out_{0, 0, 0, 0, 0};
};

}  // namespace rdpm::contacts

#include "rdpm/contacts/rest.hpp"

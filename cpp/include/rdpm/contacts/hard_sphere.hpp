// Hard spheres: what one pair does at a touch, and when it will touch. docs/theory/hard_sphere.md numbers the
// equations.
#pragma once
#include <array>
#include <limits>

#include "rdpm/contacts/substeps.hpp"

namespace rdpm::contacts {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

struct HardSphere {
    struct Parameters {
        double restitution, tangential_restitution, friction;
    };
    struct History {  // force of a pair at rest, on i against the normal and in the tangent plane
        double normal, tangential[3];
    };
    static constexpr std::array parameter_fields{RDPM_FIELD(Parameters, restitution),
                                                 RDPM_FIELD(Parameters, tangential_restitution),
                                                 RDPM_FIELD(Parameters, friction)};
    static constexpr std::array history_fields{RDPM_FIELD(History, normal), RDPM_FIELD(History, tangential)};
};

// Normal impulse on i against the normal, and the tangential one, equations (2) to (4).
struct CollisionImpulse {
    double normal, tangential[3];
};

inline CollisionImpulse collision_impulse(const HardSphere::Parameters& p, double closing, const double* slip,
                                          double inverse_mass, double inverse_tangential) {
    CollisionImpulse result{(1 + p.restitution) * closing / inverse_mass, {0, 0, 0}};
    const double speed = std::sqrt(dot(slip, slip));
    if (p.friction == 0 || speed == 0) return result;
    const double stick = (1 + p.tangential_restitution) * speed / inverse_tangential;
    const double size = std::min(stick, p.friction * result.normal);
    for (int d = 0; d < 3; ++d) result.tangential[d] = size * slip[d] / speed;
    return result;
}

// First time at which gap + rate t + acceleration t^2 / 2 comes down to zero; never: infinite. A gap that is
// zero and closes is now; one that is zero and opens comes back later.
inline double first_zero(double gap, double rate, double acceleration) {
    if (gap <= 0) {
        if (rate < 0 || (rate == 0 && acceleration < 0)) return 0;
        return acceleration < 0 ? -2 * rate / acceleration : kNever;
    }
    const double square = rate * rate - 2 * acceleration * gap;
    if (square < 0) return kNever;
    const double root = std::sqrt(square);
    if (rate < 0) return 2 * gap / (root - rate);
    return acceleration < 0 ? -(rate + root) / acceleration : kNever;
}

// Time until two spheres at r touch, u and a their relative velocity and acceleration, within `left`. Along
// the normal of any moment the distance is at least its projection, so each parabola's zero is no later than
// the touch: the sum rises to it and never passes it, equation (7).
inline double time_to_touch(const double* r, const double* u, const double* a, double distance, double left) {
    constexpr int most = 100;
    double t = 0;
    for (int k = 0; k < most; ++k) {
        double at[3], speed[3];
        for (int d = 0; d < 3; ++d) {
            at[d] = r[d] + t * (u[d] + 0.5 * t * a[d]);
            speed[d] = u[d] + t * a[d];
        }
        const double length = std::sqrt(dot(at, at)), gap = length - distance;
        if (k > 0 && gap <= 4 * std::numeric_limits<double>::epsilon() * distance) break;
        if (length == 0) break;
        const double step = first_zero(gap, dot(at, speed) / length, dot(at, a) / length);
        if (!(t + step <= left)) return kNever;
        if (t + step == t) break;
        t += step;
    }
    return t;
}

// Time until a sphere touches a wall: one parabola for a plane; a cylinder from outside is a sphere seen
// along the axis. The inside of one has no such bound from below, and is no wall of hard spheres.
inline double time_to_wall(const Box& box, int wall, const Geometry& g, const double* u, const double* a,
                           double radius, double left) {
    if (wall < kFirstInner || box.walls[wall - kFirstInner].shape == kPlane)
        return first_zero(-g.overlap, dot(u, g.n), dot(a, g.n));
    const InnerWall& cylinder = box.walls[wall - kFirstInner];
    const double *axis = cylinder.direction, along_u = dot(u, axis), along_a = dot(a, axis);
    double r[3], across_u[3], across_a[3];
    for (int d = 0; d < 3; ++d) {
        r[d] = (g.lever_i + cylinder.radius) * g.n[d];
        across_u[d] = u[d] - along_u * axis[d];
        across_a[d] = a[d] - along_a * axis[d];
    }
    return time_to_touch(r, across_u, across_a, radius + cylinder.radius, left);
}

// Which of many times is the earliest; of equal ones that of the smallest index. A tournament: winners of
// pairs of leaves above the leaves.
class Schedule {
  public:
    static std::int64_t leaves(std::int64_t count) {
        std::int64_t result = 1;
        while (result < count) result *= 2;
        return result;
    }
    // time: (count,); tree: (2 leaves,).
    Schedule(double* time, std::int32_t* tree, std::int64_t count)
        : time_(time), tree_(tree), count_(count), leaves_(leaves(count)) {
        std::fill(time, time + count, kNever);
        for (std::int64_t k = 0; k < leaves_; ++k)
            tree_[leaves_ + k] = static_cast<std::int32_t>(k < count ? k : -1);
        for (std::int64_t node = leaves_ - 1; node > 0; --node) play(node);
    }
    void set(std::int64_t k, double time) {
        time_[k] = time;
        for (std::int64_t node = (leaves_ + k) / 2; node > 0; node /= 2) play(node);
    }
    std::int64_t first() const { return tree_[1]; }
    double time(std::int64_t k) const { return time_[k]; }

  private:
    void play(std::int64_t node) {
        const std::int32_t a = tree_[2 * node], b = tree_[2 * node + 1];
        tree_[node] = b >= 0 && time_[b] < time_[a] ? b : a;
    }
    double* time_;
    std::int32_t* tree_;
    std::int64_t count_, leaves_;
};

}  // namespace rdpm::contacts

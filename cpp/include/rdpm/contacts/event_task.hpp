// What the driver of hard spheres works on, and what it tells.
#pragma once
#include "rdpm/contacts/hard_sphere.hpp"

namespace rdpm::contacts {

// Room of the driver, from Python.
struct BodyWork {
    double time;                 // of its state, since the interval began
    double force[3], torque[3];  // by contacts at rest, constant until they are solved again
    double v[3], w[3];
};
struct PairWork {
    double n[3], lever_i, lever_j, inverse_tangential;
    double normal, tangential[3];  // impulses while contacts at rest are solved
    double force[3], twist[3];     // on i, of a contact at rest
    bool is_held;                  // its force holds for the present contacts of both
};

struct EventTask {
    BodyArrays bodies;  // dv and dw: accelerations by the non-contact load
    Box box;
    const std::int32_t* active;
    std::int64_t actives;
    PairArrays pairs;
    Finished* finished;
    std::int64_t capacity;
    const std::int32_t *first, *incident;  // pairs of each body: (N + 1,), (2 M,)
    BodyWork* body_work;
    PairWork* pair_work;
    double* due;                                    // (M,)
    std::int32_t *tree, *cluster, *cluster_bodies;  // (2 leaves,), (M,), (N,)
    std::uint8_t *is_marked, *is_body_marked;       // (M,), (N,): false
    std::int64_t* events;                           // (M,) collisions in the step
    double start, length, rest_speed, quiet;
    std::int64_t most_events;
    double* turned;  // (N, 3): angular impulses by lubrication
    bool is_new;     // lubrication acts once an interval
};

struct Events {
    double reached;  // less than the interval's length where `finished` is full
    std::int64_t finished, collisions, rested, capped;
};

// Of the surfaces of a pair, present velocities: along the normal, closing, and in the tangent plane.
inline double closing_speed(const BodyArrays& b, const Partners& p, const double* n) {
    double u = 0;
    for (int d = 0; d < 3; ++d) u += (b.v[3 * p.i + d] - p.vj[d]) * n[d];
    return u;
}
inline void slip_at(const BodyArrays& b, const Partners& p, const double* n, double lever_i, double lever_j,
                    double u, double* s) {
    double roll[3];
    const bool is_reversed = p.j >= 0 && points_up(n);
    const double first = is_reversed ? lever_j : lever_i, last = is_reversed ? lever_i : lever_j;
    for (int d = 0; d < 3; ++d) {
        const double one = b.w[3 * p.i + d], other = p.wj[d];
        roll[d] = multiply_add(first, is_reversed ? other : one, last * (is_reversed ? one : other));
    }
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        s[d] = b.v[3 * p.i + d] - p.vj[d] - u * n[d] + roll[e] * n[f] - roll[f] * n[e];
    }
}

}  // namespace rdpm::contacts
